#include "apps/surefoot-lab/terrain/simple_fills.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <opencv2/photo.hpp>

namespace surefoot::apps {
namespace {

using terrain::Knowledge;
using terrain::TerrainGrid;

constexpr double kInpaintRadius_cells = 3;
constexpr int kSweeps = 10;
constexpr float kHold = 1;

Heights measured_heights(const TerrainGrid& grid) {
  return {grid.value_m.begin(), grid.value_m.begin() + grid.size()};
}

void cut_at_ceilings(const TerrainGrid& grid, Heights& heights) {
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (grid.knowledge[i] == Knowledge::kBounded) {
      heights[i] = std::min(heights[i], grid.value_m[i]);
    }
  }
}

}  // namespace

Heights fill_with_ceilings(const TerrainGrid& grid) { return measured_heights(grid); }

Heights fill_with_constant(const TerrainGrid& grid, float height_m) {
  Heights heights = measured_heights(grid);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (grid.knowledge[i] == Knowledge::kBounded) heights[i] = height_m;
  }
  return heights;
}

Heights fill_by_inpainting(const TerrainGrid& grid) {
  Heights heights = measured_heights(grid);
  float low = 1e9f;
  float high = -1e9f;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (grid.knowledge[i] != Knowledge::kMeasured) continue;
    low = std::min(low, heights[i]);
    high = std::max(high, heights[i]);
  }
  if (low > high) return heights;
  const float scale = high > low ? 255.0f / (high - low) : 0.0f;
  cv::Mat picture(grid.rows, grid.columns, CV_8U, cv::Scalar(0));
  cv::Mat mask(grid.rows, grid.columns, CV_8U, cv::Scalar(0));
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (grid.knowledge[i] == Knowledge::kMeasured) {
      picture.data[i] = static_cast<std::uint8_t>(std::lround((heights[i] - low) * scale));
    } else {
      mask.data[i] = 255;
    }
  }
  cv::Mat painted;
  cv::inpaint(picture, mask, painted, kInpaintRadius_cells, cv::INPAINT_NS);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (grid.knowledge[i] != Knowledge::kBounded) continue;
    heights[i] = scale > 0 ? low + static_cast<float>(painted.data[i]) / scale : low;
  }
  cut_at_ceilings(grid, heights);
  return heights;
}

Heights fill_with_minimum(const TerrainGrid& grid) {
  Heights heights = measured_heights(grid);
  std::vector<std::uint8_t> known(heights.size());
  for (std::size_t i = 0; i < known.size(); ++i) {
    known[i] = grid.knowledge[i] == Knowledge::kMeasured ? 1 : 0;
  }
  // A ring a round; no hole is wider than the grid.
  for (std::int32_t round = 0; round < grid.columns + grid.rows; ++round) {
    std::vector<std::pair<std::size_t, float>> ring;
    for (std::int32_t row = 0; row < grid.rows; ++row) {
      for (std::int32_t column = 0; column < grid.columns; ++column) {
        const std::size_t i = grid.index(column, row);
        if (known[i] != 0) continue;
        float lowest = 1e9f;
        for (std::int32_t k = 0; k < 9; ++k) {
          const std::int32_t c = column + k % 3 - 1;
          const std::int32_t r = row + k / 3 - 1;
          if (grid.contains(c, r) && known[grid.index(c, r)] != 0) {
            lowest = std::min(lowest, heights[grid.index(c, r)]);
          }
        }
        if (lowest < 1e9f) ring.emplace_back(i, lowest);
      }
    }
    if (ring.empty()) break;
    for (const auto& [i, height] : ring) {
      heights[i] = height;
      known[i] = 1;
    }
  }
  cut_at_ceilings(grid, heights);
  return heights;
}

Heights fill_with_smoothed_minimum(const TerrainGrid& grid) {
  Heights heights = fill_with_minimum(grid);
  const Heights held = heights;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::int32_t row = 0; row < grid.rows; ++row) {
      for (std::int32_t column = 0; column < grid.columns; ++column) {
        const std::size_t i = grid.index(column, row);
        if (grid.knowledge[i] != Knowledge::kBounded) continue;
        float count = kHold;
        float sum = kHold * held[i];
        for (const auto& [c, r] : {std::array{column - 1, row}, std::array{column + 1, row},
                                   std::array{column, row - 1}, std::array{column, row + 1}}) {
          if (!grid.contains(c, r)) continue;
          const std::size_t k = grid.index(c, r);
          if (grid.knowledge[k] == Knowledge::kUnknown) continue;
          count += 1;
          sum += heights[k];
        }
        heights[i] = std::min(sum / count, grid.value_m[i]);
      }
    }
  }
  return heights;
}

}  // namespace surefoot::apps
