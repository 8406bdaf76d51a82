// What of the robot must stay clear of what stands on the ground: a capsule in plan, from the hind
// hips to the front ones, as wide as the feet stand with straight hips.
#pragma once

#include <cmath>

#include "core/robot/robot_model.h"
#include "sim_hal/world/solid_index.h"
#include "sim_hal/world/walkers.h"

namespace surefoot::sim {

struct Footprint {
  explicit Footprint(const robot::RobotModel& robot)
      : half_length_m(robot.abad_x_m),
        half_width_m(robot.abad_y_m + robot.hip_offset_m + std::fabs(robot.knee_offset_m) +
                     robot.foot_radius_m) {}

  // Nearest of those nearer than reach_m.
  Clearance clearance(const Vector3& p_WB_m, const Matrix3& R_WB, const SolidIndex& solids,
                      const Walkers& walkers, double reach_m) const {
    const Vector3 along = half_length_m * R_WB.col(0);
    const Vector2 a_m(p_WB_m.x() - along.x(), p_WB_m.y() - along.y());
    const Vector2 b_m(p_WB_m.x() + along.x(), p_WB_m.y() + along.y());
    Clearance least = solids.clearance(a_m, b_m, half_width_m, reach_m);
    for (const Solid& walker : walkers.solids()) {
      Vector2 away;
      const double distance = plan_distance_m(walker, a_m, b_m, away) - half_width_m;
      if (distance < least.distance_m) least = {distance, away};
    }
    return least;
  }

  double half_length_m;
  double half_width_m;
};

}  // namespace surefoot::sim
