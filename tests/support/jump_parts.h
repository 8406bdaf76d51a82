// A small motion, a jump configuration and a standing robot, for tests of jumping without files.
#pragma once

#include "core/estimation/estimator.h"
#include "core/motions/jump.h"
#include "core/robot/kinematics.h"
#include "tests/support/mini_cheetah.h"

namespace surefoot::tests {

inline motions::JumpConfig jump_config() {
  motions::JumpConfig config;
  config.crouch_s = 0.2;
  config.hold_s = 0.1;
  config.abort_error_rad = 0.6;
  config.landing_height_m = 0.2;
  config.landing_foot_m = 0.06;
  config.late_landing_s = 0.2;
  config.landing_s = 0.2;
  config.rise_s = 0.2;
  config.stance = config.push = config.flight = {60.0, 1.5};
  config.landing = {40.0, 2.0};
  return config;
}

// Straight up and down: 0.2 s on four feet, 0.1 s on two, 0.3 s in the air.
inline motions::Motion small_motion() {
  motions::Motion motion;
  motion.version = motions::kMotionVersion;
  motion.rise_m = 0.13;
  motion.edge_m = 0.34;
  motion.front_lift_s = 0.2;
  motion.hind_lift_s = 0.3;
  motion.start = {.edge_min_m = 0.31,
                  .edge_max_m = 0.37,
                  .rise_min_m = 0.1,
                  .rise_max_m = 0.16,
                  .max_heading_rad = 0.12,
                  .max_tilt_rad = 0.1,
                  .max_speed_m_s = 0.1,
                  .max_rate_rad_s = 0.5,
                  .max_joint_error_rad = 0.2};
  for (int i = 0; i <= 6; ++i) {
    motions::MotionRow row;
    row.time_s = 0.1 * i;
    row.trunk = {0.0, 0.18 + 0.01 * i, 0.0};
    row.joint_rad = {-1.1, 2.3 - 0.02 * i, -1.1, 2.3 - 0.02 * i};
    row.torque_Nm = {1.0, -5.0, 1.0, -5.0};
    if (i <= 2) row.force_N = {5.0, 40.0, 5.0, 40.0};
    SUREFOOT_ASSERT(ok(motion.rows.push_back(row)));
  }
  return motion;
}

// The joints at given angles (hip, knee; the abduction joints straight), level, at rest, all feet
// on the ground.
inline estimation::RobotState robot_at(const robot::RobotModel& model, double hip_rad,
                                       double knee_rad) {
  estimation::RobotState state;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const Vector3 q(0.0, hip_rad, knee_rad);
    for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
      state.joints[robot::joint_index(leg, i)].position_rad = q[static_cast<Eigen::Index>(i)];
    }
    estimation::FootState& foot = state.feet[leg];
    foot.p_B_m = robot::foot_position_B_m(model, leg, q);
    foot.jacobian_B = robot::foot_jacobian_B(model, leg, q);
    foot.in_contact = true;
  }
  state.p_OB_m[2] = model.foot_radius_m - state.feet[0].p_B_m[2];
  for (estimation::FootState& foot : state.feet) foot.p_O_m = state.p_OB_m + foot.p_B_m;
  return state;
}

// Joints and feet follow the commands at once; the trunk stays level.
inline void follow(const robot::RobotModel& model, const actuation::JointCommands& commands,
                   estimation::RobotState& state) {
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    Vector3 q;
    for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
      const std::size_t joint = robot::joint_index(leg, i);
      q[static_cast<Eigen::Index>(i)] = commands[joint].position_rad;
      state.joints[joint].position_rad = commands[joint].position_rad;
    }
    state.feet[leg].p_B_m = robot::foot_position_B_m(model, leg, q);
    state.feet[leg].jacobian_B = robot::foot_jacobian_B(model, leg, q);
    state.feet[leg].p_O_m = state.p_OB_m + state.feet[leg].p_B_m;
  }
}

}  // namespace surefoot::tests
