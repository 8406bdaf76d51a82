// A LittleDog that does exactly what its joints are told, for tests of the static walk: the trunk
// is where the standing legs put it, feet stop at the ground. No forces.
#pragma once

#include <memory>

#include "core/control/static_walk.h"
#include "core/robot/dynamics.h"
#include "core/robot/kinematics.h"
#include "tests/support/footstep_parts.h"
#include "tests/support/little_dog.h"

namespace surefoot::tests {

inline constexpr double kStaticWalkTick_s = 0.002;

inline control::ControlConfig static_walk_config() {
  control::ControlConfig c;
  c.body.height_m = 0.13;
  c.body.slope_share = 0.7;
  c.foothold.search_radius_m = 0.05;
  c.foothold.lateral_offset_m = 0.01;
  c.swing.clearance_m = 0.02;
  c.swing.search_speed_m_s = 0.1;
  c.swing.search_depth_m = 0.04;
  c.swing.kp_Nm_rad = {20, 20, 20};
  c.swing.kd_Nm_s_rad = {0.3, 0.3, 0.3};
  c.static_walk = {.enabled = true,
                   .shift_s = 0.35,
                   .shift_speed_m_s = 0.15,
                   .shift_acceleration_m_s2 = 1.5,
                   .swing_s = 0.3,
                   .foot_speed_m_s = 0.5,
                   .max_stride_m = 0.12,
                   .margin_m = 0.02,
                   .slip_m = 0.012};
  c.footsteps = footstep_config();
  c.whole_body.friction = 0.4;
  c.whole_body.max_normal_N = 40;
  c.whole_body.position_gain_1_s2 = {100, 100, 100};
  c.whole_body.velocity_gain_1_s = {10, 10, 10};
  c.whole_body.attitude_gain_1_s2 = {100, 100, 100};
  c.whole_body.rate_gain_1_s = {10, 10, 10};
  c.whole_body.foot_position_gain_1_s2 = {500, 500, 500};
  c.whole_body.foot_velocity_gain_1_s = {10, 10, 10};
  c.whole_body.force_weight = 1.0;
  c.whole_body.linear_relaxation_weight = 0.1;
  c.whole_body.angular_relaxation_weight = 0.1;
  c.whole_body.max_residual_N = 0.1;
  c.whole_body.max_joint_step_rad = 0.5;
  return c;
}

class StaticWalkWorld {
 public:
  explicit StaticWalkWorld(const control::ControlConfig& c = static_walk_config()) {
    state.R_OB = Matrix3::Identity();
    state.p_OB_m = Vector3(0, 0, c.body.height_m);
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      Vector3 foot_B = robot::hip_joint_B_m(model, leg);
      foot_B[2] = model.foot_radius_m - c.body.height_m;
      bend(leg, robot::solve_leg(model, leg, foot_B).q_rad);
      state.feet[leg].in_contact = true;
    }
    dynamics.reset(model);
    walk->reset(c, model);
    walk->start(state);
  }

  // One tick; legs that stand carry the trunk.
  void tick(const control::VelocityCommand& velocity, bool walking,
            const mapping::MapWindow* window = nullptr,
            const terrain::TerrainMap* terrain = nullptr) {
    const actuation::JointCommands& commands =
        walk->update(state, window, terrain, velocity, walking, control::GroundRule::kGoodOrUnseen,
                     kStaticWalkTick_s);
    const Vector3 before = state.p_OB_m;
    Vector3 trunk = Vector3::Zero();
    double standing = 0;
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      const robot::LegVector q(commands[robot::joint_index(leg, 0)].position_rad,
                               commands[robot::joint_index(leg, 1)].position_rad,
                               commands[robot::joint_index(leg, 2)].position_rad);
      const Vector3 foot_O = state.feet[leg].p_O_m;
      bend(leg, q);
      if (walk->legs()[leg].mode != control::LegMode::kStance) continue;
      trunk += foot_O - state.feet[leg].p_B_m;
      standing += 1;
      state.feet[leg].p_O_m = foot_O;
    }
    state.p_OB_m = trunk / standing;
    state.v_OB_m_s = (state.p_OB_m - before) / kStaticWalkTick_s;
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      estimation::FootState& foot = state.feet[leg];
      if (walk->legs()[leg].mode == control::LegMode::kStance) continue;
      foot.p_O_m = state.p_OB_m + foot.p_B_m;
      foot.in_contact = foot.p_O_m[2] <= ground_m[leg] + model.foot_radius_m;
    }
    state.stamp = state.stamp + milliseconds(2);
  }

  Vector2 centre_O_m() {
    robot::MotionState motion;
    for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
      motion.q_rad[static_cast<Eigen::Index>(joint)] = state.joints[joint].position_rad;
    }
    dynamics.update(motion);
    return (state.p_OB_m + dynamics.centroid().p_B_m).head<2>();
  }

  int in_the_air() const {
    int count = 0;
    for (const control::LegStatus& leg : walk->legs())
      count += leg.mode != control::LegMode::kStance ? 1 : 0;
    return count;
  }

  robot::RobotModel model = robot::little_dog();
  robot::Dynamics dynamics;
  estimation::RobotState state;
  std::array<double, robot::kLegs> ground_m{};
  std::unique_ptr<control::StaticWalk> walk = std::make_unique<control::StaticWalk>();

 private:
  void bend(std::size_t leg, const robot::LegVector& q) {
    estimation::FootState& foot = state.feet[leg];
    foot.p_B_m = robot::foot_position_B_m(model, leg, q);
    foot.jacobian_B = robot::foot_jacobian_B(model, leg, q);
    foot.p_O_m = state.p_OB_m + foot.p_B_m;
    for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
      state.joints[robot::joint_index(leg, i)].position_rad = q[static_cast<Eigen::Index>(i)];
    }
  }
};

}  // namespace surefoot::tests
