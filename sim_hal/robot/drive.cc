#include "sim_hal/robot/drive.h"

#include <algorithm>
#include <cmath>

namespace surefoot::sim {

Drive::Drive(const robot::JointWiring& wiring, const robot::Actuator& actuator, double timeout_s)
    : wiring_(wiring),
      actuator_(actuator),
      ranges_{wiring.position_range_rad, wiring.velocity_range_rad_s, wiring.kp_max_Nm_rad,
              wiring.kd_max_Nm_s_rad, wiring.torque_range_Nm},
      timeout_{static_cast<std::int64_t>(std::llround(timeout_s * 1e9))} {}

void Drive::sense(double joint_position_rad, double joint_velocity_rad_s) {
  const double factor = wiring_.direction * wiring_.belt_ratio;
  position_rad_ = factor * joint_position_rad + wiring_.offset_rad - zero_rad_;
  velocity_rad_s_ = factor * joint_velocity_rad_s;
  joint_velocity_rad_s_ = joint_velocity_rad_s;
}

bool Drive::receive(std::span<const std::uint8_t> bytes, TimeNs now) {
  const Result<actuation::FrameKind> kind = actuation::classify(bytes);
  if (!kind.ok()) return false;
  commanded_at_ = now;
  switch (kind.value()) {
    case actuation::FrameKind::kEnterMotorMode:
      if (!motor_mode_) command_ = {};
      motor_mode_ = true;
      return true;
    case actuation::FrameKind::kExitMotorMode: motor_mode_ = false; return true;
    case actuation::FrameKind::kSetZero:
      if (!motor_mode_) {  // as motorcontrol v2: only at rest
        zero_rad_ += position_rad_;
        position_rad_ = 0;
      }
      return true;
    case actuation::FrameKind::kCommand: break;
  }
  const Result<actuation::DriveCommand> command = actuation::decode_command(ranges_, bytes);
  if (!command.ok()) return false;
  command_ = command.value();
  return true;
}

double Drive::joint_torque_Nm(TimeNs now) {
  torque_Nm_ = 0;
  if (!motor_mode_) return 0;
  if (now - commanded_at_ >= timeout_) command_ = {};  // stays in motor mode, limp
  const double asked = command_.kp_Nm_rad * (command_.position_rad - position_rad_) +
                       command_.kd_Nm_s_rad * (command_.velocity_rad_s - velocity_rad_s_) +
                       command_.torque_Nm;
  const double coded = std::clamp(asked, -ranges_.torque_Nm, ranges_.torque_Nm);
  const double factor = wiring_.direction * wiring_.belt_ratio;
  // Back EMF takes from the stall torque in the direction of motion and adds against it.
  const double speed_part = joint_velocity_rad_s_ / actuator_.no_load_speed_rad_s;
  const double limit = actuator_.torque_limit_Nm;
  const double high = std::clamp(actuator_.stall_torque_Nm * (1.0 - speed_part), 0.0, limit);
  const double low = std::clamp(-actuator_.stall_torque_Nm * (1.0 + speed_part), -limit, 0.0);
  const double torque = std::clamp(factor * coded, low, high);
  torque_Nm_ = torque / factor;
  return torque;
}

actuation::ReplyBytes Drive::reply(std::uint8_t size, double position_noise_rad,
                                   double velocity_noise_rad_s) const {
  actuation::Reply reply;
  reply.drive_id = static_cast<std::uint8_t>(wiring_.can_id);
  reply.position_rad = position_rad_ + position_noise_rad;
  reply.velocity_rad_s = velocity_rad_s_ + velocity_noise_rad_s;
  reply.torque_Nm = torque_Nm_;
  reply.has_voltage = size == 7;
  reply.voltage_V = 24.0;
  reply.has_health = size == 8;
  reply.temperature_code = 35;
  const Result<actuation::ReplyBytes> bytes = actuation::encode_reply(ranges_, reply);
  return bytes.ok() ? bytes.value() : actuation::ReplyBytes{};
}

}  // namespace surefoot::sim
