// Workloads of core/control.
#include "core/base/assert.h"
#include "core/base/random.h"
#include "core/control/convex_mpc.h"
#include "core/control/gait.h"
#include "core/control/recovery.h"
#include "core/control/swing.h"
#include "core/control/whole_body.h"
#include "core/geometry/rotations.h"
#include "tests/rules/core_hash/workloads.h"
#include "tests/support/mini_cheetah.h"
#include "tests/support/mpc_problems.h"
#include "tests/support/static_walk_world.h"

namespace surefoot::tests {

void hash_swing(Fnv64& hash) {
  control::GaitConfig config;
  config.period_s = 0.4;
  config.stance_share = 0.6;
  config.offset = {0.0, 0.5, 0.5, 0.0};
  control::Gait gait;
  gait.reset(config);
  Random random(8);
  control::SwingPath path;
  for (int i = 0; i < 5000; ++i) {
    gait.advance(0.002);
    for (const control::LegPhase& leg : gait.legs()) {
      hash.byte(leg.stance ? 1 : 0);
      mix(hash, leg.progress);
      mix(hash, leg.remaining_s);
    }
    for (int axis = 0; axis < 3; ++axis) path.landing_O_m[axis] = random.uniform(-0.1, 0.1);
    path.apex_O_m = random.uniform(0.1, 0.2);
    const control::SwingPoint point = control::evaluate(path, random.uniform(), 0.16);
    mix(hash, point.position_O_m);
    mix(hash, point.velocity_O_m_s);
  }
}

void hash_convex_mpc(Fnv64& hash) {
  static control::ConvexMpc mpc;
  const control::MpcConfig config = mpc_config();
  mpc.reset(config);
  Random random(10);
  for (int i = 0; i < 140; ++i) {
    const MpcGait& gait = kMpcGaits[static_cast<std::size_t>(i) % kMpcGaits.size()];
    control::MpcProblem problem = random_mpc_problem(random, gait, config, i % 2 == 0 ? 0.0 : 1.0);
    problem.steps_since_last = i % 3 == 0 ? 1 : 100;
    const control::MpcSolution& solution = mpc.solve(problem);
    for (std::size_t k = 0; k < control::kMpcHorizon; ++k) {
      for (const Vector3& force : solution.force_O_N[k]) mix(hash, force);
      mix(hash, solution.predicted[k].p_OB_m);
      mix(hash, solution.predicted[k].roll_pitch_yaw_rad);
    }
    mix(hash, solution.residual_N);
  }
}

namespace {

control::WholeBodyConfig whole_body_config() {
  control::WholeBodyConfig config;
  config.friction = 0.4;
  config.max_normal_N = 150;
  config.position_gain_1_s2 = config.attitude_gain_1_s2 = {100, 100, 100};
  config.velocity_gain_1_s = config.rate_gain_1_s = {10, 10, 10};
  config.foot_position_gain_1_s2 = {500, 500, 500};
  config.foot_velocity_gain_1_s = {10, 10, 10};
  config.force_weight = 1.0;
  config.linear_relaxation_weight = config.angular_relaxation_weight = 0.1;
  config.max_residual_N = 0.1;
  config.max_joint_step_rad = 0.5;
  return config;
}

Vector3 random_vector(Random& random, double size) {
  Vector3 v;
  for (int axis = 0; axis < 3; ++axis) v[axis] = random.uniform(-size, size);
  return v;
}

}  // namespace

void hash_whole_body(Fnv64& hash) {
  control::WholeBody whole_body;
  whole_body.reset(whole_body_config(), robot::full_mini_cheetah());
  Random random(15);
  for (int i = 0; i < 400; ++i) {
    control::WholeBodyState state;
    control::BodyTask body;
    control::LegTasks legs;
    const Vector3 angles = random_vector(random, 0.5);
    state.R_OB = geometry::from_roll_pitch_yaw(angles[0], angles[1], angles[2]);
    state.v_OB_m_s = random_vector(random, 1.0);
    state.angular_velocity_B_rad_s = random_vector(random, 1.0);
    body.p_OB_m = random_vector(random, 0.05);
    body.v_OB_m_s = random_vector(random, 1.0);
    for (int joint = 0; joint < 12; ++joint) {
      state.q_rad[joint] = random.uniform(-0.3, 0.3) + (joint % 3 == 2 ? 1.5 : 0.0);
      state.qd_rad_s[joint] = random.uniform(-5, 5);
    }
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      legs[leg].in_contact = random.below(3) > 0;
      legs[leg].force_O_N = random_vector(random, 20.0) + Vector3(0, 0, 30);
      legs[leg].position_O_m = random_vector(random, 0.3);
      legs[leg].velocity_O_m_s = random_vector(random, 1.0);
    }
    const control::WholeBodyCommand& command = whole_body.update(state, body, legs);
    mix(hash, command.q_rad);
    mix(hash, command.qd_rad_s);
    mix(hash, command.torque_Nm);
    mix(hash, command.acceleration);
  }
  hash.word(whole_body.counters().damped, 8);
  hash.word(whole_body.counters().refused, 8);
}

void hash_static_walk(Fnv64& hash) {
  StaticWalkWorld world;
  Random random(19);
  control::VelocityCommand command{.forward_m_s = 0.06};
  for (int i = 0; i < 3000; ++i) {
    if (i % 300 == 0) {
      command.left_m_s = random.uniform(-0.02, 0.02);
      command.yaw_rate_rad_s = random.uniform(-0.2, 0.2);
      world.ground_m[random.below(4)] = random.uniform(-0.02, 0.01);
    }
    world.tick(command, i < 2700);
    mix(hash, world.state.p_OB_m);
    for (const control::LegStatus& leg : world.walk->legs()) mix(hash, leg.force_O_N);
  }
  hash.word(world.walk->counters().steps, 8);
}

// Rolls over from random poses; the trunk turns at random between rolls.
void hash_recovery(Fnv64& hash) {
  control::RecoveryConfig config;
  config.upright_tilt_rad = 0.7;
  config.quiet_rad_s = 0.2;
  config.quiet_s = 0.1;
  config.speed_rad_s = 8.0;
  config.kp_Nm_rad = 60.0;
  config.kd_Nm_s_rad = 1.5;
  config.limp_damping_Nm_s_rad = 1.0;
  config.max_rolls = 4;
  SUREFOOT_ASSERT(ok(config.roll.push_back({0.05, {-1.4, -1.6, 2.75}, {0.9, -3.1, 2.75}})));
  SUREFOOT_ASSERT(ok(config.roll.push_back({0.2, {0.0, -1.4, 2.7}, {1.4, -3.4, 0.7}})));
  control::Recovery recovery;
  recovery.reset(config, robot::RobotModel{}, {0.0, -1.4, 2.7});
  Random random(11);
  estimation::RobotState state;
  for (int i = 0; i < 20; ++i) {
    for (actuation::JointState& joint : state.joints) joint.position_rad = random.uniform(-3, 3);
    recovery.begin();
    recovery.start();
    for (int tick = 0; tick < 2000; ++tick) {
      if (tick % 400 == 0) {
        Vector3 turn;
        for (Eigen::Index axis = 0; axis < 3; ++axis) turn[axis] = random.uniform(-2, 2);
        state.R_OB = geometry::to_matrix(geometry::from_rotation_vector(turn));
      }
      const actuation::JointCommands& commands = recovery.update(state, 0.002);
      hash.byte(static_cast<std::uint8_t>(recovery.stage()));
      for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
        mix(hash, commands[joint].position_rad);
        mix(hash, commands[joint].kp_Nm_rad);
        if (joint % 5 != 0 && commands[joint].kp_Nm_rad > 0.0) {
          state.joints[joint].position_rad = commands[joint].position_rad;
        }
      }
    }
  }
}

}  // namespace surefoot::tests
