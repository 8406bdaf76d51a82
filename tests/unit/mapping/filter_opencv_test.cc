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

// Heights on the filter's grid; every cell is unknown with the given chance in percent.
cv::Mat random_heights(std::uint64_t seed, std::uint32_t unknown_percent) {
  Random random(seed);
  cv::Mat heights(kSide, kSide, CV_32F);
  for (std::int32_t y = 0; y < kSide; ++y) {
    for (std::int32_t x = 0; x < kSide; ++x) {
      const float height = on_filter_grid(static_cast<float>(random.uniform(-2.0, 2.0)));
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
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const cv::Mat heights = random_heights(seed, 0);
    const auto filter = filtered(heights);
    cv::Mat opened;
    cv::morphologyEx(heights, opened, cv::MORPH_OPEN, ellipse());
    const cv::Mat gradient = oracle::filter(heights).gradient;
    for (std::int32_t y = 0; y < kSide; ++y) {
      for (std::int32_t x = 0; x < kSide; ++x) {
        ASSERT_EQ(filter->opened().row(y)[x], opened.at<float>(y, x)) << x << ' ' << y;
        ASSERT_EQ(filter->gradient_map().row(y)[x], gradient.at<float>(y, x)) << x << ' ' << y;
      }
    }
  }
}

// An unknown cell is to the filter what a cell outside of the image is to OpenCV: no part of any
// minimum (there: the largest number) nor of any maximum (there: the least).
TEST(FilterAgainstOpenCv, UnknownCellsAreAsCellsOutsideOfTheImage) {
  int nowhere = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const cv::Mat heights = random_heights(seed, static_cast<std::uint32_t>(2 * seed + 15));
    const auto filter = filtered(heights);
    const auto [opened, gradient] = oracle::filter(heights);
    const cv::Mat found = opened > -kNothing;
    cv::Mat all_around;  // Sobel has all nine
    cv::erode(found, all_around, cv::Mat());
    for (std::int32_t y = 0; y < kSide; ++y) {
      for (std::int32_t x = 0; x < kSide; ++x) {
        const float mine = filter->opened().row(y)[x];
        if (found.at<std::uint8_t>(y, x) == 0) {
          ++nowhere;
          ASSERT_LT(mine, -kLargestHeight_m);
          continue;
        }
        ASSERT_EQ(mine, opened.at<float>(y, x)) << x << ' ' << y;
        if (all_around.at<std::uint8_t>(y, x) == 0) continue;
        ASSERT_EQ(filter->gradient_map().row(y)[x], gradient.at<float>(y, x)) << x << ' ' << y;
      }
    }
  }
  EXPECT_GT(nowhere, 100);
}

// Changing a few cells and updating what they reach gives the bits of filtering all anew.
TEST(FilterAgainstOpenCv, PartialUpdatesLeaveNoTrace) {
  Random random(3);
  const auto below = [&random](std::uint32_t n) {
    return static_cast<std::int32_t>(random.below(n));
  };
  const auto partly = filtered(random_heights(100, 20));
  cv::Mat heights = random_heights(100, 20);
  for (std::uint64_t round = 1; round <= 60; ++round) {
    const cv::Mat other = random_heights(100 + round, 20);
    const std::int32_t x_begin = below(kSide);
    const std::int32_t x_end = x_begin + 1 + below(static_cast<std::uint32_t>(kSide - x_begin));
    const std::int32_t y_begin = below(kSide);
    const std::int32_t y_end = y_begin + 1 + below(static_cast<std::uint32_t>(kSide - y_begin));
    for (std::int32_t y = y_begin; y < y_end; ++y) {
      for (std::int32_t x = x_begin; x < x_end; ++x) {
        heights.at<float>(y, x) = other.at<float>(y, x);
        set(*partly, heights, x, y);
      }
    }
    partly->update({x_begin, x_end, y_begin, y_end});
    const auto anew = filtered(heights);
    for (std::int32_t y = 0; y < kSide; ++y) {
      for (std::int32_t x = 0; x < kSide; ++x) {
        ASSERT_EQ(partly->opened().row(y)[x], anew->opened().row(y)[x]);
        ASSERT_EQ(partly->gradient_map().row(y)[x], anew->gradient_map().row(y)[x]);
        ASSERT_EQ(partly->traversability(x, y), anew->traversability(x, y));
        ASSERT_EQ(partly->margin_cells(x, y), anew->margin_cells(x, y));
      }
    }
  }
}

}  // namespace
}  // namespace surefoot::mapping
