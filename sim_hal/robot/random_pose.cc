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
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
      const robot::JointRange range = model.joint_range(robot::joint_index(leg, i));
      legs[leg][static_cast<Eigen::Index>(i)] = random.uniform(range.min_rad, range.max_rad);
    }
  }
  return legs;
}

}  // namespace surefoot::sim
