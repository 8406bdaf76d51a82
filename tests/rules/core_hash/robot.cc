// Workloads of core/robot, core/actuation and core/estimation.
#include <array>

#include "core/actuation/motor_protocol.h"
#include "core/base/random.h"
#include "core/estimation/attitude.h"
#include "core/estimation/relocation.h"
#include "core/estimation/tracking.h"
#include "core/geometry/rotations.h"
#include "core/robot/dynamics.h"
#include "core/robot/kinematics.h"
#include "tests/rules/core_hash/workloads.h"
#include "tests/support/mini_cheetah.h"

namespace surefoot::tests {
void hash_kinematics(Fnv64& hash) {
  const robot::RobotModel model = robot::full_mini_cheetah();
  Random random(4);
  for (int i = 0; i < 5000; ++i) {
    const std::size_t leg = random.below(4);
    robot::LegVector q;
    q[0] = random.uniform(-0.8, 0.8);
    q[1] = random.uniform(-1.5, 0.6);
    q[2] = random.uniform(0.3, 2.6);
    Vector3 target = robot::foot_position_B_m(model, leg, q);
    mix(hash, target);
    mix(hash, robot::foot_jacobian_B(model, leg, q));
    for (int axis = 0; axis < 3; ++axis) target[axis] += random.uniform(-0.05, 0.05);
    const robot::LegSolution solution = robot::solve_leg(model, leg, target);
    mix(hash, solution.q_rad);
    hash.byte(static_cast<std::uint8_t>(solution.status));
  }
}

void hash_dynamics(Fnv64& hash) {
  const robot::RobotModel model = robot::full_mini_cheetah();
  robot::Dynamics dynamics;
  dynamics.reset(model);
  Random random(14);
  for (int i = 0; i < 500; ++i) {
    robot::MotionState state;
    robot::GeneralisedVector acceleration;
    for (int k = 0; k < robot::kVelocities; ++k) {
      state.velocity[k] = random.uniform(-5, 5);
      acceleration[k] = random.uniform(-20, 20);
    }
    for (int k = 0; k < 12; ++k) state.q_rad[k] = random.uniform(-2, 2);
    const double roll_rad = random.uniform(-1, 1);
    const double pitch_rad = random.uniform(-1, 1);
    const double yaw_rad = random.uniform(-3, 3);
    state.R_OB = geometry::from_roll_pitch_yaw(roll_rad, pitch_rad, yaw_rad);
    dynamics.update(state);
    robot::MassMatrix mass;
    dynamics.mass_matrix(mass);
    mix(hash, mass);
    mix(hash, dynamics.inverse_dynamics(acceleration));
    mix(hash, dynamics.centroid().angular_momentum_B_kg_m2_s);
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      const robot::PointMotion foot = dynamics.foot(leg, Vector3(0.001, 0, -0.017));
      mix(hash, foot.jacobian_B);
      mix(hash, foot.bias_B_m_s2);
    }
    robot::MassFactor factor;
    hash.byte(factor.factor(mass) ? 1 : 0);
    mix(hash, factor.solve(acceleration));
    factor.inverse(mass);
    mix(hash, mass);
  }
}

void hash_actuation(Fnv64& hash) {
  constexpr actuation::WireRanges kRanges = {12.5, 45.0, 500.0, 5.0, 18.0};
  Random random(5);
  for (int i = 0; i < 20000; ++i) {
    actuation::DriveCommand command;
    command.position_rad = random.uniform(-14, 14);
    command.velocity_rad_s = random.uniform(-50, 50);
    command.kp_Nm_rad = random.uniform(0, 500);
    command.kd_Nm_s_rad = random.uniform(0, 5);
    command.torque_Nm = random.uniform(-20, 20);
    actuation::CommandBytes bytes{};
    hash.byte(static_cast<std::uint8_t>(actuation::encode_command(kRanges, command, bytes)));
    hash.bytes(bytes.data(), bytes.size());
    const Result<actuation::DriveCommand> back = actuation::decode_command(kRanges, bytes);
    mix(hash, back.value().position_rad);
    mix(hash, back.value().torque_Nm);
  }
}

void hash_attitude(Fnv64& hash) {
  estimation::AttitudeConfig config;
  config.correction_gain_1_s = 1.0;
  config.bias_gain_1_s2 = 0.05;
  config.max_gravity_error_m_s2 = 3.0;
  config.still_bias_gain_1_s = 1.0;
  robot::ImuSpecification imu;
  imu.rate_Hz = 1000;
  imu.mount.position_B_m = {0.01, -0.02, 0.03};
  imu.mount.roll_pitch_yaw_rad = {0.1, -0.2, 0.3};
  estimation::AttitudeEstimator estimator;
  estimator.reset(config, imu);
  Random random(6);
  for (int i = 0; i < 5000; ++i) {
    hal::ImuSample sample;
    sample.stamp = milliseconds(i + 1);
    for (double& rate : sample.angular_velocity_I_rad_s) rate = random.normal();
    for (double& force : sample.specific_force_I_m_s2) force = random.normal();
    sample.specific_force_I_m_s2[2] += 9.81;
    hash.byte(static_cast<std::uint8_t>(estimator.update(sample, i < 500)));
    mix(hash, estimator.R_OB());
    mix(hash, estimator.gyro_bias_B_rad_s());
    mix(hash, estimator.specific_force_B_m_s2());
  }
}

void hash_tracking(Fnv64& hash) {
  estimation::TrackingConfig config;
  config.jump_m = 0.05;
  config.jump_rad = 0.05;
  config.position_gain_1_s = 1.0;
  config.max_horizontal_m_s = 0.03;
  config.max_vertical_m_s = 0.01;
  config.yaw_gain_1_s = 0.5;
  config.max_yaw_rate_rad_s = 0.01;
  config.yaw_bias_gain_1_s2 = 0.01;
  config.tilt_gain_1_s = 0.05;
  robot::TrackingCameraSpecification camera;
  camera.mount.position_B_m = {0.26, 0.01, -0.02};
  camera.mount.roll_pitch_yaw_rad = {0.1, -0.2, 0.3};
  estimation::DriftEstimator drift;
  drift.reset(config);
  const estimation::CameraMount mount(camera);
  estimation::Relocation relocation;
  Random random(16);
  for (int i = 0; i < 5000; ++i) {
    hal::PoseSample sample;
    sample.stamp = milliseconds(5 * (i + 1));
    Vector3 turn;
    for (std::size_t k = 0; k < 3; ++k) {
      sample.p_ST_m[k] = 0.0025 * i + 0.01 * random.normal();
      turn[static_cast<Eigen::Index>(k)] = 0.01 * random.normal();
    }
    const geometry::Quaternion q = geometry::from_rotation_vector(turn);
    sample.q_ST_wxyz = {q.w, q.x, q.y, q.z};
    estimation::PoseAtStamp own;
    own.p_OB_m = Vector3(0.0025 * i, 0.002 * i, 0.3);
    hash.byte(static_cast<std::uint8_t>(drift.check(sample)));
    const estimation::CameraPose pose = mount.trunk(sample);
    const estimation::DriftCorrection correction = drift.observe(pose, own);
    mix(hash, correction.shift_O_m);
    mix(hash, correction.yaw_rad);
    relocation.observe(pose, own);
    if (i % 100 == 0) relocation.pin(milliseconds(5 * (i - 100)));
    const Result<estimation::PoseAtStamp> found = relocation.pose(sample.stamp);
    if (found.ok()) mix(hash, found.value().p_OB_m);
  }
  hash.word(drift.counters().jumps, 8);
}

}  // namespace surefoot::tests
