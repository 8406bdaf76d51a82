// A terrain task with a small model, and windows for it to complete.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/autonomy/terrain_task.h"
#include "core/base/assert.h"
#include "core/mapping/map_window.h"
#include "tests/support/terrain_parts.h"

namespace surefoot::tests {

inline constexpr double kTerrainCell_m = 0.01;

inline autonomy::TerrainConfig terrain_task_config() {
  autonomy::TerrainConfig config;
  config.present = true;
  config.fill = autonomy::FillUse::kOn;
  config.fill_work = 5000;
  config.cost_rows = 10;
  config.synthesis = some_fill();
  config.synthesis.weight_deviation = 0.4;
  config.cost.radius_cells = {1, 2, 4};
  for (terrain::FeatureCost* feature : {&config.cost.slope, &config.cost.height_difference,
                                        &config.cost.deviation, &config.cost.roughness}) {
    feature->scale.fill(0.05);
    feature->weight.fill(1.0);
  }
  terrain::TerrainModel& model = config.model;
  model.cell_m = kTerrainCell_m;
  const std::vector<float> heights = rough_heights(77, 100, 40);
  SUREFOOT_ASSERT(ok(model.rows.resize(40)));
  for (std::size_t i = 0; i < heights.size(); ++i) {
    model.rows[i / 100].heights_m[i % 100] = static_cast<double>(heights[i]);
  }
  model.prior_constant = -0.01;
  return config;
}

// A scene of the terrain tests as a window.
inline std::unique_ptr<mapping::MapWindow> terrain_window(std::uint64_t seed,
                                                          double cell_m = kTerrainCell_m) {
  constexpr std::int32_t kSide = mapping::kWindowSide;
  const auto grid = std::make_unique<terrain::TerrainGrid>();
  make_scene(seed, kSide, kSide, cell_m, *grid);
  auto window = std::make_unique<mapping::MapWindow>();
  window->cell_size_m = cell_m;
  window->first = grid->first;
  window->frames = seed;
  for (std::size_t i = 0; i < window->cells.size(); ++i) {
    mapping::WindowCell& cell = window->cells[i];
    cell.height_m = grid->value_m[i];
    if (grid->knowledge[i] == terrain::Knowledge::kMeasured) {
      cell.state = mapping::CellState::kMeasured;
    } else if (grid->knowledge[i] == terrain::Knowledge::kBounded) {
      cell.state = mapping::CellState::kBounded;
    }
  }
  return window;
}

}  // namespace surefoot::tests
