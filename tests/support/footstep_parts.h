// A LittleDog's search for footsteps (config/robots/littledog.yaml) and ground to step on.
#pragma once

#include <functional>
#include <memory>

#include "core/planning/footsteps.h"
#include "core/robot/kinematics.h"
#include "tests/support/little_dog.h"

namespace surefoot::tests {

inline planning::FootstepConfig footstep_config() {
  planning::FootstepConfig c;
  c.steps = 4;
  c.radius_cells = 5;
  c.beam = 16;
  c.max_cost = 0.7;
  c.max_step_m = 0.06;
  c.reach_margin_m = 0.004;
  c.stop_margin_rad = 0.03;
  c.avoid_m = 0.012;
  c.max_lowering_m = 0.03;
  c.max_raising_m = 0.018;
  c.min_inradius_m = 0.022;
  c.terrain_weight_m = 0.05;
  c.spread_weight = 1.0;
  c.edge_reach_m = 0.02;
  c.wall_weight = 0.3;
  c.drop_weight = 0.7;
  c.collision_weight = 1.0;
  c.deviation_scale_m = 0.05;
  c.rise_weight = 0.2;
  c.wanted_inradius_m = 0.035;
  c.inradius_weight = 1.0;
  c.shift_weight = 0.3;
  c.missing_step_m = 0.1;
  return c;
}

inline planning::StanceShape footstep_shape() { return {0.13, 0.7, 0.01, 0.02}; }

// The feet below their hips, on ground at height 0, the middle of them at (x, y).
inline planning::Feet standing_feet(const robot::RobotModel& model, double x_O_m = 0,
                                    double y_O_m = 0, double yaw_rad = 0) {
  const planning::Hips hips =
      planning::stance_hips_O_m(model, footstep_shape().lateral_offset_m, yaw_rad);
  planning::Feet feet;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    feet[leg] = Vector3(hips[leg][0] + x_O_m, hips[leg][1] + y_O_m, model.foot_radius_m);
  }
  return feet;
}

struct GroundCell {
  bool known = true;
  double height_m = 0;
  double cost = 0;
  double spread_m = 0;  // above 0: filled
};

// One square metre, its corner at cell `first`; cells of 1 cm by their indices.
inline std::unique_ptr<terrain::TerrainMap> terrain_of(
    const std::function<GroundCell(mapping::CellIndex)>& ground,
    mapping::CellIndex first = {-40, -50}) {
  auto map = std::make_unique<terrain::TerrainMap>();
  map->ground.stamp = milliseconds(1);
  map->ground.cell_size_m = 0.01;
  map->ground.first = first;
  for (std::size_t i = 0; i < map->ground.cells.size(); ++i) {
    const auto column = static_cast<std::int32_t>(i % mapping::kWindowSide);
    const auto row = static_cast<std::int32_t>(i / mapping::kWindowSide);
    const GroundCell given = ground(first + mapping::CellIndex{column, row});
    if (!given.known) continue;
    mapping::WindowCell& cell = map->ground.cells[i];
    const bool filled = given.spread_m > 0;
    cell.state = filled ? mapping::CellState::kBounded : mapping::CellState::kMeasured;
    cell.bridged = filled;
    cell.height_m = static_cast<float>(given.height_m);
    cell.traversability = mapping::Traversability::kSteppable;
    cell.margin_cells = 2;
    map->cost[i] = static_cast<float>(given.cost);
    map->spread_m[i] = static_cast<float>(given.spread_m);
  }
  map->raise_crests();
  return map;
}

inline std::unique_ptr<terrain::TerrainMap> flat_terrain() {
  return terrain_of([](mapping::CellIndex) { return GroundCell{}; });
}

}  // namespace surefoot::tests
