// Opening, gradient map and their treatment of unknown cells against OpenCV, bit by bit.
#include <cstdint>
#include <memory>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "core/base/random.h"
#include "core/mapping/traversability_filter.h"
#include "tests/support/opencv_filter.h"

namespace surefoot::mapping {
namespace {

constexpr std::int32_t kSide = 100;
using oracle::ellipse;
using oracle::kNothing;
using Filter = TraversabilityFilter<kSide>;

constexpr TraversabilityLimits kLimits{.max_slope = 0.5,
                                       .max_raise_m = 0.02,
                                       .max_drop_m = 0.02,
                                       .max_unknown = 3,
                                       .max_step_m = 0.12,
                                       .max_jump_m = 0.27};

// Heights up to half a span around a middle: what is kept in steps, far from O's origin too, and
// what is not.
struct Ground {
  double middle_m;
  double half_span_m;
  bool in_steps;
};
constexpr Ground kGrounds[] = {{0.0, 0.499, true},  {87.3, 0.499, true},  {-99.4, 0.4, true},
                               {0.0, 0.501, false}, {0.0, 2.0, false},    {-31.0, 20.0, false},
                               {110.0, 0.3, false}, {-115.0, 0.3, false}, {3.0, 0.0, true}};

// Heights on the filter's grid; every cell is unknown with the given chance in percent.
cv::Mat random_heights(std::uint64_t seed, std::uint32_t unknown_percent,
                       const Ground& ground = {0.0, 2.0, false}) {
  Random random(seed);
  cv::Mat heights(kSide, kSide, CV_32F);
  for (std::int32_t y = 0; y < kSide; ++y) {
    for (std::int32_t x = 0; x < kSide; ++x) {
      const double offset_m = random.uniform(-ground.half_span_m, ground.half_span_m);
      const float height = on_filter_grid(static_cast<float>(ground.middle_m + offset_m));
      const bool unknown = random.below(100) < unknown_percent;
      heights.at<float>(y, x) = unknown ? kNothing : height;
    }
  }
  return heights;
}

void set(Filter& filter, const cv::Mat& heights, std::int32_t x, std::int32_t y) {
  const float height = heights.at<float>(y, x);
  if (height == kNothing) {
    filter.clear(x, y);
  } else {
    filter.set(x, y, height);
  }
}

std::unique_ptr<Filter> filtered(const cv::Mat& heights) {
  auto filter = std::make_unique<Filter>();
  filter->reset(kLimits, 0.015);
  for (std::int32_t y = 0; y < kSide; ++y) {
    for (std::int32_t x = 0; x < kSide; ++x) set(*filter, heights, x, y);
  }
  filter->update({0, kSide, 0, kSide});
  return filter;
}

TEST(FilterAgainstOpenCv, TheKernelIsEquationFour) {
  const cv::Mat kernel = ellipse();
  const char* rows[] = {"00100", "11111", "11111", "11111", "00100"};
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 5; ++x) EXPECT_EQ(kernel.at<std::uint8_t>(y, x), rows[y][x] - '0');
  }
}

TEST(FilterAgainstOpenCv, OpeningAndGradientOfKnownHeightsToTheBorder) {
  for (const Ground& ground : kGrounds) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const cv::Mat heights = random_heights(seed, 0, ground);
      const auto filter = filtered(heights);
      ASSERT_EQ(filter->uses_steps(), ground.in_steps) << ground.middle_m;
      cv::Mat opened;
      cv::morphologyEx(heights, opened, cv::MORPH_OPEN, ellipse());
      const cv::Mat gradient = oracle::filter(heights).gradient;
      for (std::int32_t y = 0; y < kSide; ++y) {
        for (std::int32_t x = 0; x < kSide; ++x) {
          ASSERT_EQ(filter->opened_m(x, y), opened.at<float>(y, x)) << x << ' ' << y;
          ASSERT_EQ(filter->gradient_m(x, y), gradient.at<float>(y, x)) << x << ' ' << y;
        }
      }
    }
  }
}

// An unknown cell is to the filter what a cell outside of the image is to OpenCV: no part of any
// minimum (there: the largest number) nor of any maximum (there: the least).
TEST(FilterAgainstOpenCv, UnknownCellsAreAsCellsOutsideOfTheImage) {
  for (const Ground& ground : kGrounds) {
    int nowhere = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const cv::Mat heights =
          random_heights(seed, static_cast<std::uint32_t>(4 * seed + 15), ground);
      const auto filter = filtered(heights);
      const auto [opened, gradient] = oracle::filter(heights);
      const cv::Mat found = opened > -kNothing;
      cv::Mat all_around;  // Sobel has all nine
      cv::erode(found, all_around, cv::Mat());
      for (std::int32_t y = 0; y < kSide; ++y) {
        for (std::int32_t x = 0; x < kSide; ++x) {
          const float mine = filter->opened_m(x, y);
          if (found.at<std::uint8_t>(y, x) == 0) {
            ++nowhere;
            ASSERT_LT(mine, -kLargestHeight_m);
            continue;
          }
          ASSERT_EQ(mine, opened.at<float>(y, x)) << x << ' ' << y;
          if (all_around.at<std::uint8_t>(y, x) == 0) continue;
          ASSERT_EQ(filter->gradient_m(x, y), gradient.at<float>(y, x)) << x << ' ' << y;
        }
      }
    }
    EXPECT_GT(nowhere, 100);
  }
}

void expect_same(const Filter& a, const Filter& b) {
  for (std::int32_t y = 0; y < kSide; ++y) {
    for (std::int32_t x = 0; x < kSide; ++x) {
      ASSERT_EQ(a.opened_m(x, y), b.opened_m(x, y));
      ASSERT_EQ(a.traversability(x, y), b.traversability(x, y)) << x << ' ' << y;
      ASSERT_EQ(a.margin_cells(x, y), b.margin_cells(x, y)) << x << ' ' << y;
    }
  }
}

// Changing a few cells and updating what they reach gives the bits of filtering all anew, also
// where the ground comes to fit in steps, or no longer does, or fits with another base.
TEST(FilterAgainstOpenCv, PartialUpdatesLeaveNoTrace) {
  Random random(3);
  const auto place_below = [&random](std::uint32_t n) {
    return static_cast<std::int32_t>(random.below(n));
  };
  constexpr Ground kTurns[] = {{0, 0.3, true}, {0, 0.3, true}, {0.1, 0.35, true}, {0, 2, false}};
  const auto partly = filtered(random_heights(100, 20));
  cv::Mat heights = random_heights(100, 20);
  int in_steps = 0;
  for (std::uint64_t round = 1; round <= 120; ++round) {
    const cv::Mat other = random_heights(100 + round, 20, kTurns[round / 3 % 4]);
    const bool all = round % 6 == 0;
    const std::int32_t x_begin = all ? 0 : place_below(kSide);
    const std::int32_t y_begin = all ? 0 : place_below(kSide);
    const auto extent = [&](std::int32_t begin) {
      const std::int32_t rest = kSide - begin;
      return all ? rest : 1 + place_below(static_cast<std::uint32_t>(rest));
    };
    const std::int32_t x_end = x_begin + extent(x_begin);
    const std::int32_t y_end = y_begin + extent(y_begin);
    for (std::int32_t y = y_begin; y < y_end; ++y) {
      for (std::int32_t x = x_begin; x < x_end; ++x) {
        heights.at<float>(y, x) = other.at<float>(y, x);
        set(*partly, heights, x, y);
      }
    }
    partly->update({x_begin, x_end, y_begin, y_end});
    const auto anew = filtered(heights);
    ASSERT_EQ(partly->uses_steps(), anew->uses_steps());
    in_steps += partly->uses_steps() ? 1 : 0;
    expect_same(*partly, *anew);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(in_steps, 20);
  EXPECT_LT(in_steps, 100);
}

// Blocks, so that all classes come up.
void add_blocks(cv::Mat& heights, std::uint64_t seed) {
  Random random(seed);
  for (int block = 0; block < 12; ++block) {
    const auto x = static_cast<int>(random.below(kSide - 20));
    const auto y = static_cast<int>(random.below(kSide - 20));
    const auto rise_m = static_cast<float>(random.uniform(0.0, 0.2));
    heights(cv::Rect(x, y, 16, 16)) += static_cast<double>(on_filter_grid(rise_m));
  }
}

// Ground that fits in steps gives the classes it has beside one cell so low that it does not: what
// that cell reaches is left out.
TEST(FilterAgainstOpenCv, StepsAndMetresGiveTheSameClasses) {
  int seen[5] = {};
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    // With noise, so that limits are met closely.
    cv::Mat heights = random_heights(seed, static_cast<std::uint32_t>(seed % 10), {0, 0.02, true});
    add_blocks(heights, seed);
    const auto in_steps = filtered(heights);
    ASSERT_TRUE(in_steps->uses_steps());
    heights.at<float>(kSide - 1, kSide - 1) = -5.0F;
    const auto in_metres = filtered(heights);
    ASSERT_FALSE(in_metres->uses_steps());
    constexpr std::int32_t kUnreached = kSide - 1 - kFilterReach_cells;
    for (std::int32_t y = 0; y < kUnreached; ++y) {
      for (std::int32_t x = 0; x < kUnreached; ++x) {
        ASSERT_EQ(in_steps->traversability(x, y), in_metres->traversability(x, y)) << x << ' ' << y;
        ASSERT_EQ(in_steps->margin_cells(x, y), in_metres->margin_cells(x, y)) << x << ' ' << y;
        ++seen[static_cast<int>(in_steps->traversability(x, y))];
      }
    }
  }
  for (const int count : seen) EXPECT_GT(count, 100);
}

}  // namespace
}  // namespace surefoot::mapping
