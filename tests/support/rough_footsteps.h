// Rough ground for the search for footsteps and a robot that stands somewhere on it.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "core/base/random.h"
#include "tests/support/footstep_parts.h"
#include "tests/support/terrain_parts.h"

namespace surefoot::tests {

// Blocks and waves; cost by the relief of the 3 x 3, some rectangles filled, some unknown.
inline std::unique_ptr<terrain::TerrainMap> rough_terrain(std::uint64_t seed) {
  const std::vector<float> heights = rough_heights(seed, 100, 100);
  Random random(seed, 7);
  std::vector<GroundCell> cells(heights.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int column = static_cast<int>(i) % 100;
    const int row = static_cast<int>(i) / 100;
    float low = heights[i];
    float high = heights[i];
    for (int y = std::max(0, row - 1); y <= std::min(99, row + 1); ++y) {
      for (int x = std::max(0, column - 1); x <= std::min(99, column + 1); ++x) {
        low = std::min(low, heights[static_cast<std::size_t>(100 * y + x)]);
        high = std::max(high, heights[static_cast<std::size_t>(100 * y + x)]);
      }
    }
    cells[i].height_m = static_cast<double>(heights[i]);
    cells[i].cost = std::min(1.0, static_cast<double>(high - low) / 0.05);
  }
  for (int k = 0; k < 60; ++k) {
    const auto left = static_cast<int>(random.below(95));
    const auto low = static_cast<int>(random.below(95));
    const bool known = k % 3 != 0;
    const double spread_m = random.uniform(0.002, 0.02);
    for (int i = 0; i < 25; ++i) {
      GroundCell& cell = cells[static_cast<std::size_t>(100 * (low + i / 5) + left + i % 5)];
      cell.known = known;
      cell.spread_m = spread_m;
    }
  }
  return terrain_of([&](mapping::CellIndex i) {
    return cells[static_cast<std::size_t>(100 * (i.iy + 50) + i.ix + 40)];
  });
}

// Standing on rough ground, walking somewhere.
inline planning::FootstepProblem rough_problem(std::uint64_t seed, const robot::RobotModel& model,
                                               const terrain::TerrainMap& map) {
  Random random(seed, 8);
  planning::FootstepProblem problem;
  problem.turn = random.below(4);
  problem.yaw_rad = random.uniform(-0.6, 0.6);
  const double length_m = random.uniform(0.04, 0.12);
  problem.stride_O_m =
      planning::from_heading(problem.yaw_rad, length_m, random.uniform(-0.02, 0.02));
  problem.feet_O_m = standing_feet(model, 0.0, 0.0, problem.yaw_rad);
  for (Vector3& foot : problem.feet_O_m) {
    foot[0] += random.uniform(-0.02, 0.02);
    foot[1] += random.uniform(-0.01, 0.01);
    const Result<double> ground = map.ground.height_at(foot[0], foot[1]);
    if (ground.ok()) foot[2] += ground.value();
  }
  return problem;
}

}  // namespace surefoot::tests
