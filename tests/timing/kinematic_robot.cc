#include "tests/timing/kinematic_robot.h"

#include <algorithm>

#include "core/base/assert.h"
#include "core/math/gravity.h"
#include "core/robot/kinematics.h"

namespace surefoot::timing {
namespace {

constexpr double kSoft_Nm_rad = 20.0;
constexpr double kCreep_1_s = 10.0;
constexpr double kGroundTolerance_m = 0.004;  // feet this near the lowest stand too

Vector3 joints_of(const std::array<double, robot::kJoints>& values, std::size_t leg) {
  return {values[robot::joint_index(leg, 0)], values[robot::joint_index(leg, 1)],
          values[robot::joint_index(leg, 2)]};
}

}  // namespace

KinematicRobot::KinematicRobot(const apps::Config& config) : model_(config.robot) {
  SUREFOOT_ASSERT(ok(autonomy_.reset(config.robot, config.autonomy)));
  SUREFOOT_ASSERT(ok(bus_.configure(config.robot)));
  const auto& folded = config.autonomy.control.stand_up.folded_rad;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
      q_rad_[robot::joint_index(leg, i)] = folded[i];
    }
  }
  dynamics_.reset(model_);
  feel_ground();
}

hal::CanFrame KinematicRobot::reply(std::size_t joint) const {
  const robot::JointWiring& wire = model_.wiring[joint];
  const actuation::WireRanges ranges{wire.position_range_rad, wire.velocity_range_rad_s,
                                     wire.kp_max_Nm_rad, wire.kd_max_Nm_s_rad,
                                     wire.torque_range_Nm};
  const double scale = wire.direction * wire.belt_ratio;
  actuation::Reply reply;
  reply.drive_id = static_cast<std::uint8_t>(wire.can_id);
  reply.position_rad = scale * q_rad_[joint] + wire.offset_rad;
  reply.velocity_rad_s = scale * qd_rad_s_[joint];
  reply.torque_Nm = torque_Nm_[joint] / scale;
  reply.has_health = true;
  const auto bytes = actuation::encode_reply(ranges, reply);
  SUREFOOT_ASSERT(bytes.ok());
  hal::CanFrame frame;
  frame.stamp = inputs_.stamp;
  frame.bus = wire.bus;
  frame.size = bytes.value().size;
  std::copy_n(bytes.value().data.begin(), frame.size, frame.data.begin());
  return frame;
}

void KinematicRobot::prepare(const KinematicInputs& amounts) {
  inputs_.stamp = inputs_.stamp + autonomy::kTickPeriod;
  inputs_.can.clear();
  for (std::size_t i = 0; i < amounts.can_frames; ++i) {
    SUREFOOT_ASSERT(ok(inputs_.can.push_back(reply(i % robot::kJoints))));
  }
  inputs_.imu.clear();
  for (std::size_t i = 0; i < amounts.imu_samples; ++i) {
    hal::ImuSample sample;
    const auto before = static_cast<std::int64_t>(amounts.imu_samples - 1 - i);
    const auto count = static_cast<std::int64_t>(amounts.imu_samples);
    sample.stamp = inputs_.stamp - TimeNs{autonomy::kTickPeriod.ns / count * before};
    sample.specific_force_I_m_s2 = {0, 0, kGravity_m_s2};
    SUREFOOT_ASSERT(ok(inputs_.imu.push_back(sample)));
  }
  autonomy_.begin_control(inputs_);
}

void KinematicRobot::apply() {
  autonomy_.publish_control(outputs_);
  const double step_s = autonomy::kTickPeriod.seconds();
  for (const hal::CanFrame& frame : outputs_.can) {
    std::size_t joint = 0;
    actuation::JointCommand command;
    if (!ok(bus_.decode_command_frame(frame, joint, command))) continue;
    const double before = q_rad_[joint];
    // A stiff joint is where it should be; the soft one of a standing leg moves as it should and
    // creeps towards where it should be.
    const double creep_rad_s = kCreep_1_s * (command.position_rad - before);
    q_rad_[joint] = command.kp_Nm_rad > kSoft_Nm_rad
                        ? command.position_rad
                        : before + (command.velocity_rad_s + creep_rad_s) * step_s;
    const double speed_before_rad_s = qd_rad_s_[joint];
    qd_rad_s_[joint] = (q_rad_[joint] - before) / step_s;
    acceleration_[6 + static_cast<Eigen::Index>(joint)] =
        (qd_rad_s_[joint] - speed_before_rad_s) / step_s;
  }
  feel_ground();
  ++inputs_.tick;
}

// The lowest feet share the weight; the joints report the torque that holds it and moves the legs.
void KinematicRobot::feel_ground() {
  robot::MotionState motion;
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    const auto row = static_cast<Eigen::Index>(joint);
    motion.q_rad[row] = q_rad_[joint];
    motion.velocity[6 + row] = qd_rad_s_[joint];
  }
  dynamics_.update(motion);
  const robot::JointVector moving_Nm = dynamics_.inverse_dynamics(acceleration_).tail<12>();
  std::array<Vector3, robot::kLegs> feet;
  double lowest = 0;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    feet[leg] = robot::foot_position_B_m(model_, leg, joints_of(q_rad_, leg));
    lowest = std::min(lowest, feet[leg][2]);
  }
  height_m_ = model_.foot_radius_m - lowest;
  double standing = 0;
  for (const Vector3& foot : feet) standing += foot[2] < lowest + kGroundTolerance_m ? 1.0 : 0.0;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const bool stands = feet[leg][2] < lowest + kGroundTolerance_m;
    const double share = stands ? model_.total_mass_kg() * kGravity_m_s2 / standing : 0.0;
    const Matrix3 jacobian = robot::foot_jacobian_B(model_, leg, joints_of(q_rad_, leg));
    const Vector3 holding_Nm = -(jacobian.transpose() * Vector3(0, 0, share));
    for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
      const std::size_t joint = robot::joint_index(leg, i);
      const double limit_Nm = model_.actuators[i].torque_limit_Nm;
      torque_Nm_[joint] = std::clamp(
          holding_Nm[static_cast<Eigen::Index>(i)] + moving_Nm[static_cast<Eigen::Index>(joint)],
          -limit_Nm, limit_Nm);
    }
  }
}

bool KinematicRobot::reach(autonomy::MissionPhase phase, std::size_t most) {
  for (std::size_t i = 0; i < most; ++i) {
    tick();
    if (telemetry().phase == phase) return true;
  }
  return false;
}

}  // namespace surefoot::timing
