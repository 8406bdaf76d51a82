// How deep a robot that stands like that would be in the ground: trunk and legs against the terrain
// map. Frames: O, metres. Cost: 27 look-ups; deepest_contact_m() four solutions of a leg besides.
#pragma once

#include "core/planning/stance.h"
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

// Of all of them, 0: none is in the ground. Legs that do not reach their feet count as stretched.
double deepest_contact_m(const robot::RobotModel& model, const PlanningGround& ground,
                         const Matrix3& R_OB, const Vector3& p_OB_m, const Feet& feet_O_m);

}  // namespace surefoot::planning
