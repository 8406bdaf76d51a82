#include "sim_hal/robot/random_pose.h"

#include <cmath>

namespace surefoot::sim {
namespace {

constexpr double kTwoPi = 6.28318530717958647693;

}  // namespace

// Shoemake, Uniform random rotations, Graphics Gems III, 1992.
Matrix3 random_rotation(Random& random) {
  const double share = random.uniform();
  const double a = kTwoPi * random.uniform();
  const double b = kTwoPi * random.uniform();
  const double low = std::sqrt(1.0 - share);
  const double high = std::sqrt(share);
  const Eigen::Quaterniond q(high * std::cos(b), low * std::sin(a), low * std::cos(a),
                             high * std::sin(b));
  return q.toRotationMatrix();
}

std::array<robot::LegVector, robot::kLegs> random_legs(const robot::RobotModel& model,
                                                       Random& random) {
  std::array<robot::LegVector, robot::kLegs> legs;
  for (robot::LegVector& leg : legs) {
    for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
      const robot::Actuator& actuator = model.actuators[i];
      leg[static_cast<Eigen::Index>(i)] = random.uniform(actuator.min_rad, actuator.max_rad);
    }
  }
  return legs;
}

}  // namespace surefoot::sim
