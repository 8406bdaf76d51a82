// The height filter on laser-scanned ground with its real gaps, against OpenCV.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "core/mapping/traversability_filter.h"
#include "sim_hal/world/height_map_file.h"
#include "tests/support/opencv_filter.h"

namespace surefoot::real_data {
namespace {

constexpr std::int32_t kSide = 288;
using Filter = mapping::TraversabilityFilter<kSide>;

// Mini-Cheetah's, as in docs/running.md; classes are not compared here.
constexpr mapping::TraversabilityLimits kLimits{.max_slope = 0.5,
                                                .max_raise_m = 0.02,
                                                .max_drop_m = 0.02,
                                                .max_unknown = 3,
                                                .max_step_m = 0.12,
                                                .max_jump_m = 0.27};

cv::Mat heights_of(const sim::RawHeightMap& raw) {
  cv::Mat heights(kSide, kSide, CV_32F, cv::Scalar(oracle::kNothing));
  for (std::size_t row = 0; row < raw.rows; ++row) {
    for (std::size_t column = 0; column < raw.columns; ++column) {
      const std::size_t i = raw.index(row, column);
      if (raw.known[i] == 0) continue;
      heights.at<float>(static_cast<int>(row), static_cast<int>(column)) =
          mapping::on_filter_grid(static_cast<float>(raw.z_m[i]));
    }
  }
  return heights;
}

TEST(RealGround, TheFilterHasOpenCvsBitsOnEveryScan) {
  for (const char* name : {"otira_rocks_a_2cm.asc", "forest_marv_lowest_5cm.asc"}) {
    const std::string file = SUREFOOT_SHARED_DATA "/terrain/" + std::string(name);
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
    const sim::RawHeightMap raw = sim::read_height_map(file);
    ASSERT_LE(std::max(raw.rows, raw.columns), static_cast<std::size_t>(kSide));
    const cv::Mat heights = heights_of(raw);
    const auto filter = std::make_unique<Filter>();
    filter->reset(kLimits, raw.cell_m);
    for (std::int32_t y = 0; y < kSide; ++y) {
      for (std::int32_t x = 0; x < kSide; ++x) {
        if (heights.at<float>(y, x) != oracle::kNothing) {
          filter->set(x, y, heights.at<float>(y, x));
        }
      }
    }
    filter->update({0, kSide, 0, kSide});
    const auto [opened, gradient] = oracle::filter(heights);
    cv::Mat all_around;  // Sobel has all nine
    cv::erode(opened > -oracle::kNothing, all_around, cv::Mat());
    int compared = 0;
    for (std::int32_t y = 0; y < kSide; ++y) {
      for (std::int32_t x = 0; x < kSide; ++x) {
        if (opened.at<float>(y, x) == -oracle::kNothing) continue;
        ASSERT_EQ(filter->opened_m(x, y), opened.at<float>(y, x)) << name << x << ' ' << y;
        if (all_around.at<std::uint8_t>(y, x) == 0) continue;
        ASSERT_EQ(filter->gradient_m(x, y), gradient.at<float>(y, x));
        ++compared;
      }
    }
    EXPECT_GT(compared, 10000) << name;
  }
}

}  // namespace
}  // namespace surefoot::real_data
