// Draws for a robot that is thrown on the ground.
#pragma once

#include <array>

#include "core/base/random.h"
#include "core/math/linear.h"
#include "core/robot/kinematics.h"

namespace surefoot::sim {

// Uniform over all rotations.
Matrix3 random_rotation(Random& random);

// Each joint uniform between its stops.
std::array<robot::LegVector, robot::kLegs> random_legs(const robot::RobotModel& model,
                                                       Random& random);

}  // namespace surefoot::sim
