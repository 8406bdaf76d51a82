// One motor drive of the MIT Mini-Cheetah kind, seen from the bus: the firmware's modes, control
// law and time-out. All quantities at the drive's output shaft; JointWiring turns them into joint
// quantities.
#pragma once

#include <cstdint>
#include <span>

#include "core/actuation/motor_protocol.h"
#include "core/base/time.h"
#include "core/robot/robot_model.h"

namespace surefoot::sim {

class Drive {
 public:
  Drive() = default;
  Drive(const robot::JointWiring& wiring, const robot::Actuator& actuator, double timeout_s);

  // Joint state as the drive's encoder sees it.
  void sense(double joint_position_rad, double joint_velocity_rad_s);
  // A frame addressed to this drive. False: not understood, ignored by the firmware.
  bool receive(std::span<const std::uint8_t> bytes, TimeNs now);
  // Torque at the joint for the next physics step: control law, firmware range, torque limit and
  // the torque-speed line. Zero out of motor mode and after the time-out.
  double joint_torque_Nm(TimeNs now);
  // The answer to a frame. Noise is added to angle and speed before they are coded.
  actuation::ReplyBytes reply(std::uint8_t size, double position_noise_rad,
                              double velocity_noise_rad_s) const;

  bool motor_mode() const { return motor_mode_; }

 private:
  robot::JointWiring wiring_;
  robot::Actuator actuator_;
  actuation::WireRanges ranges_;
  TimeNs timeout_;
  actuation::DriveCommand command_;
  TimeNs commanded_at_;
  bool motor_mode_ = false;
  double zero_rad_ = 0;  // set by the zero frame
  double position_rad_ = 0;
  double velocity_rad_s_ = 0;
  double joint_velocity_rad_s_ = 0;
  double torque_Nm_ = 0;  // at the drive's output, last step
};

}  // namespace surefoot::sim
