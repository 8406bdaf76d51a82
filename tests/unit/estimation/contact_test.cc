// Ground forces and contacts against a robot whose motion and foot forces are prescribed: the joint
// torques that it takes come from the dynamics with the full state, trunk velocity included.
#include "core/estimation/contact.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/rotations.h"
#include "core/math/gravity.h"
#include "tests/support/mini_cheetah.h"

namespace surefoot::estimation {
namespace {

constexpr double kTick_s = 0.002;

ContactConfig contact_config() {
  ContactConfig config;
  config.observer_gain_1_s = 200;
  config.touchdown_force_N = 12;
  config.surprise_force_N = 35;
  config.expected_height_m = 0.015;
  config.lift_off_force_N = 3;
  config.max_touchdown_speed_m_s = 0.15;
  config.earliest_swing_phase = 0.5;
  config.confirm_ticks = 2;
  return config;
}

using GaitPhases = std::array<GaitPhase, robot::kLegs>;
using Forces = std::array<Vector3, robot::kLegs>;

// Trunk thrown and turning, joints swinging at up to 15 rad/s: by closed formulas, so that rates
// and accelerations are exact.
struct Swinging {
  explicit Swinging(double speed) : rate_1_s(speed) { dynamics.reset(model); }

  robot::MotionState state(double t) const {
    robot::MotionState s;
    const double yaw = 0.4 * std::sin(3 * t);
    s.R_OB = geometry::from_roll_pitch_yaw(0.0, 0.0, yaw);
    s.velocity[2] = 1.2 * std::cos(3 * t);
    const Vector3 v_OB(2.0, 0.3 * std::sin(4 * t), 0.2 * std::cos(5 * t));
    s.velocity.segment<3>(3) = s.R_OB.transpose() * v_OB;
    for (int i = 0; i < 12; ++i) {
      const double phase = rate_1_s * t + 0.7 * i;
      s.q_rad[i] = (i % 3 == 0 ? 0.0 : i % 3 == 1 ? -0.8 : 1.6) + 0.6 * std::sin(phase);
      s.velocity[6 + i] = 0.6 * rate_1_s * std::cos(phase);
    }
    return s;
  }

  // One tick: what the drives and the IMU report when the ground gives `forces`.
  void feed(ContactEstimator& estimator, double t, const Forces& forces, const GaitPhases& gait) {
    const robot::MotionState s = state(t);
    robot::GeneralisedVector acceleration;
    acceleration << 0, 0, -3.6 * std::sin(3 * t), Vector3::Zero(), robot::JointVector::Zero();
    const Vector3 a_OB(0.0, 1.2 * std::cos(4 * t), -std::sin(5 * t));
    const Vector3 w = s.velocity.head<3>();
    const Vector3 v_B = s.velocity.segment<3>(3);
    acceleration.segment<3>(3) = s.R_OB.transpose() * a_OB - w.cross(v_B);
    for (int i = 0; i < 12; ++i) {
      acceleration[6 + i] = -0.6 * rate_1_s * rate_1_s * std::sin(rate_1_s * t + 0.7 * i);
    }
    dynamics.update(s);
    robot::JointVector torque = dynamics.inverse_dynamics(acceleration).tail<12>();
    std::array<FootMotion, robot::kLegs> motion;
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      const robot::PointMotion foot = dynamics.foot(leg, Vector3::Zero());
      torque.segment<3>(robot::velocity_row(leg) - 6) -=
          foot.jacobian_B.transpose() * (s.R_OB.transpose() * forces[leg]);
      motion[leg].jacobian_B = foot.jacobian_B;
    }
    std::array<actuation::JointState, robot::kJoints> joints{};
    for (std::size_t i = 0; i < robot::kJoints; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      joints[i].position_rad = s.q_rad[row];
      joints[i].velocity_rad_s = s.velocity[6 + row];
      joints[i].torque_Nm =
          torque[row] + model.actuators[i % 3].viscous_friction_Nm_s * s.velocity[6 + row];
    }
    const Vector3 up(0.0, 0.0, kGravity_m_s2);
    estimator.update(joints, gait, motion, {s.R_OB, w, s.R_OB.transpose() * (a_OB + up)});
  }

  double rate_1_s;
  robot::RobotModel model = robot::full_mini_cheetah();
  robot::Dynamics dynamics;
};

// A fast swing in the air, 15 rad/s in every joint: rotors and links take up to 15 N m, the ground
// gives nothing. What is left is the half tick by which differenced speeds are late.
TEST(Contact, ASwingInTheAirLeavesNoForce) {
  Swinging robot(25.0);
  ContactEstimator estimator;
  estimator.reset(contact_config(), robot.model, kTick_s);
  GaitPhases gait;
  gait.fill({false, 0.9, 0.0});
  double worst_N = 0;
  for (int k = 0; k < 1000; ++k) {
    robot.feed(estimator, k * kTick_s,
               Forces{Vector3::Zero(), Vector3::Zero(), Vector3::Zero(), Vector3::Zero()}, gait);
    for (const FootContact& foot : estimator.feet()) {
      if (k > 20) worst_N = std::max(worst_N, foot.force_O_N.norm());
      EXPECT_FALSE(foot.in_contact);
    }
  }
  EXPECT_LT(worst_N, 9.0);
}

TEST(Contact, FindsTheForceOfEachFoot) {
  Swinging robot(2.0);
  ContactEstimator estimator;
  estimator.reset(contact_config(), robot.model, kTick_s);
  const Forces forces{Vector3(5, -3, 40), Vector3(-8, 2, 20), Vector3(0, 0, 60), Vector3(3, 6, 30)};
  for (int k = 0; k < 200; ++k) robot.feed(estimator, k * kTick_s, forces, GaitPhases{});
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    EXPECT_LT((estimator.feet()[leg].force_O_N - forces[leg]).norm(), 0.5) << leg;
    EXPECT_TRUE(estimator.feet()[leg].in_contact);
  }
}

// The same 20 N are a touchdown near the expected ground, too little far above it, and nothing
// early in a swing.
TEST(Contact, ATouchdownNeedsMoreForceWhereNoGroundIsExpected) {
  Swinging robot(1.0);
  ContactEstimator estimator;
  estimator.reset(contact_config(), robot.model, kTick_s);
  GaitPhases gait;
  gait[0] = {false, 0.8, 0.005};
  gait[1] = {false, 0.8, 0.080};
  gait[2] = {false, 0.3, 0.005};
  gait[3] = {true, 0.0, 0.0};
  Forces forces;
  forces.fill(Vector3(0, 0, 20));
  for (int k = 0; k < 50; ++k) robot.feed(estimator, k * kTick_s, forces, gait);
  EXPECT_TRUE(estimator.feet()[0].in_contact);
  EXPECT_FALSE(estimator.feet()[1].in_contact);
  EXPECT_FALSE(estimator.feet()[2].in_contact);
  EXPECT_TRUE(estimator.feet()[3].in_contact);
  forces.fill(Vector3(0, 0, 60));
  for (int k = 50; k < 100; ++k) robot.feed(estimator, k * kTick_s, forces, gait);
  EXPECT_TRUE(estimator.feet()[1].in_contact);
  forces.fill(Vector3::Zero());
  for (int k = 100; k < 150; ++k) robot.feed(estimator, k * kTick_s, forces, gait);
  EXPECT_FALSE(estimator.feet()[3].in_contact);
}

}  // namespace
}  // namespace surefoot::estimation
