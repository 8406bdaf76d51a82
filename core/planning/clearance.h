// How deep a robot that stands like that would be in the ground: trunk and legs against the terrain
// map. Frames: O, metres. Cost: nine look-ups for the trunk, three a leg.
#pragma once

#include "core/robot/kinematics.h"
#include "core/robot/robot_model.h"
#include "core/terrain/terrain_map.h"

namespace surefoot::planning {

// The ground with what is to be added to its heights.
struct PlanningGround {
  const terrain::TerrainMap* map = nullptr;  // null: nothing is known, nothing is touched
  double offset_m = 0;
};

// Of the trunk's underside (nine points): the deepest below the map's heights, below 0 where it is
// clear of them. Places without height are passed over; nowhere a height: kClear_m. A trunk that is
// higher by x is less deep by x.
inline constexpr double kClear_m = -1e3;
double trunk_depth_m(const robot::RobotModel& model, const PlanningGround& ground,
                     const Matrix3& R_OB, const Vector3& p_OB_m);

// The same of one leg: knee and the middles of thigh and shank, their radii included.
double leg_depth_m(const robot::RobotModel& model, const PlanningGround& ground,
                   const Matrix3& R_OB, const Vector3& p_OB_m, std::size_t leg,
                   const robot::LegVector& q_rad);

}  // namespace surefoot::planning
