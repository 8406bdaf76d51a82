// The path of a foot through the air, in O: straight up first, then over, then down.
//
// Height and way are separate quintic blends of the swing's progress s (zero velocity and
// acceleration at their ends): the foot rises to the apex during s in [0, 0.4], moves over during
// [0.15, 0.9] and comes down during [0.5, 1], so that it clears an edge close to either end.
#pragma once

#include "core/mapping/map_window.h"
#include "core/math/linear.h"
#include "core/robot/robot_model.h"

namespace surefoot::control {

struct SwingPath {
  Vector3 lift_off_O_m = Vector3::Zero();
  Vector3 landing_O_m = Vector3::Zero();
  double apex_O_m = 0;  // z
};

struct SwingPoint {
  Vector3 position_O_m = Vector3::Zero();
  Vector3 velocity_O_m_s = Vector3::Zero();
  Vector3 acceleration_O_m_s2 = Vector3::Zero();
};

// z at which the foot clears both ends and the highest ground that the map knows between them,
// within a foot's diameter of the way. window: null when mapping is off.
double apex_O_m(const SwingPath& path, const mapping::MapWindow* window,
                const robot::RobotModel& model, double clearance_m, double map_offset_m);

// progress in [0, 1], clamped.
SwingPoint evaluate(const SwingPath& path, double progress, double duration_s);

}  // namespace surefoot::control
