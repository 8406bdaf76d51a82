// Windows of the map for tests of obstacles.
#pragma once

#include "core/mapping/map_window.h"
#include "core/obstacles/config.h"

namespace surefoot::obstacles::test {

inline constexpr double kCell_m = 0.015;
inline constexpr std::int32_t kSide = mapping::kWindowSide;

// Level, seen ground around O's origin.
inline void make_level(mapping::MapWindow& window) {
  window.cell_size_m = kCell_m;
  window.first = {-kSide / 2, -kSide / 2};
  mapping::WindowCell ground;
  ground.state = mapping::CellState::kMeasured;
  ground.traversability = mapping::Traversability::kSteppable;
  window.cells.fill(ground);
}

inline mapping::WindowCell& cell(mapping::MapWindow& window, std::int32_t x, std::int32_t y) {
  return window.cells[static_cast<std::size_t>(y * kSide + x)];
}

inline ObstacleConfig config() {
  ObstacleConfig config;
  config.min_cells = 3;
  config.field_radius_m = 0.04;
  config.forget_windows = 3;
  config.margin_m = 0.02;
  config.reach_m = 0.35;
  config.push_m_s = 0.15;
  config.swirl = 1.5;
  config.approach_gain_1_s = 1.5;
  config.max_forward_m_s = 0.4;
  config.max_back_m_s = 0.1;
  config.max_sideways_m_s = 0.3;
  return config;
}

}  // namespace surefoot::obstacles::test
