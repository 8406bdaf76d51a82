// Joint commands to CAN frames and CAN frames to joint states, for the twelve drives of a robot.
//
// With belt ratio b (drive-output turns per joint turn), direction d = +-1 and offset o:
//   wire angle  = d b q + o        wire speed = d b qd        wire torque = d tau / b
//   wire kp     = kp / b^2         wire kd    = kd / b^2
// so that power (tau qd) is the same on both sides of the belt and a gain means at the joint what
// the controller asked for.
//
// All quantities of this header are joint side, joints in the order of robot_model.h. A received
// frame is attributed by its bus and by byte 0 of its data, never by its CAN id: drives may all
// answer with one id. A frame of 8 bytes whose id is a drive's own is a command (an echo of ours,
// or a recorded bus) and not a reply; a drive with 8-byte replies must therefore not be given its
// own id as master id. No allocation, no time source; cost of a tick: twelve encodes and as many
// decodes as frames.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/actuation/motor_protocol.h"
#include "core/base/fixed_vector.h"
#include "core/base/parameters.h"
#include "core/base/status.h"
#include "core/base/time.h"
#include "core/robot/robot_model.h"
#include "hal/api/can_port.h"

namespace surefoot::actuation {

// The drive applies kp (position - q) + kd (velocity - qd) + torque at 40 kHz.
struct JointCommand {
  double position_rad = 0;
  double velocity_rad_s = 0;
  double kp_Nm_rad = 0;
  double kd_Nm_s_rad = 0;
  double torque_Nm = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("position_rad", self.position_rad);
    visit("velocity_rad_s", self.velocity_rad_s);
    visit("kp_Nm_rad", self.kp_Nm_rad);
    visit("kd_Nm_s_rad", self.kd_Nm_s_rad);
    visit("torque_Nm", self.torque_Nm);
  }
};

struct JointState {
  double position_rad = 0;
  double velocity_rad_s = 0;
  double torque_Nm = 0;
  TimeNs stamp;        // of the last reply
  bool valid = false;  // a reply has come and the drive is not silent

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("position_rad", self.position_rad);
    visit("velocity_rad_s", self.velocity_rad_s);
    visit("torque_Nm", self.torque_Nm);
    visit("stamp_ns", self.stamp);
    visit("valid", self.valid);
  }
};

// What a drive's 7- and 8-byte replies tell about it.
struct DriveHealth {
  DriveError error = DriveError::kNone;  // of the last 8-byte reply
  std::uint8_t temperature_code = 0;     // of the last 8-byte reply
  double voltage_V = 0;                  // of the last 7-byte reply

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("error", self.error);
    visit("temperature_code", self.temperature_code);
    visit("voltage_V", self.voltage_V);
  }
};

// Frames since configure().
struct BusCounters {
  std::uint64_t replies = 0;
  std::uint64_t invalid = 0;     // 29-bit, FD or of a length that no reply has
  std::uint64_t unknown = 0;     // no drive of that id on that bus
  std::uint64_t duplicates = 0;  // more replies than frames sent to the drive
  std::uint64_t commands = 0;    // frames addressed to a drive, not from it
  std::uint64_t errors = 0;      // error frames of the controller
  std::uint64_t missed = 0;      // frames sent to a drive and never answered
  std::uint64_t limited = 0;     // commands changed by a limit
  std::uint64_t refused = 0;     // commands that were not finite, replaced by damping

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("replies", self.replies);
    visit("invalid", self.invalid);
    visit("unknown", self.unknown);
    visit("duplicates", self.duplicates);
    visit("commands", self.commands);
    visit("errors", self.errors);
    visit("missed", self.missed);
    visit("limited", self.limited);
    visit("refused", self.refused);
  }
};

struct ActuationParameters {
  double soft_stop_margin_rad = 0.03;  // commands stay this far inside the mechanical stops
  double damping_Nm_s_rad = 1.0;       // gain of the damping command
  std::uint32_t silent_after_ticks = 10;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("soft_stop_margin_rad", self.soft_stop_margin_rad, {0.0, 0.5},
               "commands stay this far inside the mechanical stops");
    visit.real("damping_Nm_s_rad", self.damping_Nm_s_rad, {0.0, 100.0},
               "gain that replaces a command that is not finite, and that stops a robot");
    visit.integer("silent_after_ticks", self.silent_after_ticks, {1, 1000},
                  "ticks without a reply after which a drive counts as silent");
  }
};

using JointCommands = std::array<JointCommand, robot::kJoints>;
using JointStates = std::array<JointState, robot::kJoints>;

class JointBus {
 public:
  // Checks the wiring and clears all state. kInvalid: a range is not valid, a direction is not +-1,
  // a belt ratio not above zero, a bus or id out of range, or two joints share bus and id.
  // kOutOfRange: a joint can turn beyond the wire's position range, or its soft stops leave no way
  // to turn. After a failure the bus is not configured: encode appends nothing and receive counts
  // only.
  Status configure(const robot::RobotModel& model, const ActuationParameters& parameters = {});

  // Takes the frames of one tick, oldest first.
  void receive(std::span<const hal::CanFrame> frames);
  // The same for a bus that another program commands (a recorded log): a command seen on the bus
  // counts as sent, so that missed and duplicate replies are found there too.
  void listen(std::span<const hal::CanFrame> frames);

  // Appends the twelve command frames by bus, then by joint, and closes the tick: drives that did
  // not answer the frame before count as missed. Positions are kept inside the soft stops, torque
  // inside the actuator's limit; a joint at or beyond a soft stop is given neither torque nor speed
  // further out. kInvalid: a command was not finite; that joint got the damping command, the others
  // theirs.
  // kExhausted: no room for all frames, none appended. kUnavailable: not configured, none appended.
  template <std::size_t kCapacity>
  Status encode(const JointCommands& commands, FixedVector<hal::CanFrame, kCapacity>& out) {
    if (!configured_) return Status::kUnavailable;
    if (kCapacity - out.size() < robot::kJoints) return Status::kExhausted;
    Status status = Status::kOk;
    for (const std::uint8_t joint : order_) {
      hal::CanFrame frame = frame_to(joint);
      if (!ok(encode_joint(joint, commands[joint], frame))) status = Status::kInvalid;
      SUREFOOT_ASSERT(ok(out.push_back(frame)));
    }
    return status;
  }

  // Appends a special frame for every drive: kEnterMotorMode starts the drives or, when they run,
  // polls their state without a command; kExitMotorMode makes them limp at once. Closes the tick
  // like encode. kInvalid: kCommand, or kSetZero, which is a calibration step and not for a running
  // robot.
  // kExhausted, kUnavailable: as encode.
  template <std::size_t kCapacity>
  Status encode_special_to_all(FrameKind kind, FixedVector<hal::CanFrame, kCapacity>& out) {
    if (kind != FrameKind::kEnterMotorMode && kind != FrameKind::kExitMotorMode) {
      return Status::kInvalid;
    }
    if (!configured_) return Status::kUnavailable;
    if (kCapacity - out.size() < robot::kJoints) return Status::kExhausted;
    for (const std::uint8_t joint : order_) {
      hal::CanFrame frame = frame_to(joint);
      put(encode_special(kind), frame);
      note_sent(joint);
      SUREFOOT_ASSERT(ok(out.push_back(frame)));
    }
    return Status::kOk;
  }
  template <std::size_t kCapacity>
  Status enable(FixedVector<hal::CanFrame, kCapacity>& out) {
    return encode_special_to_all(FrameKind::kEnterMotorMode, out);
  }
  template <std::size_t kCapacity>
  Status poll(FixedVector<hal::CanFrame, kCapacity>& out) {
    return encode_special_to_all(FrameKind::kEnterMotorMode, out);
  }
  template <std::size_t kCapacity>
  Status disable(FixedVector<hal::CanFrame, kCapacity>& out) {
    return encode_special_to_all(FrameKind::kExitMotorMode, out);
  }

  // kp = 0, speed 0, torque 0, kd = the damping gain: the robot sinks without falling.
  JointCommands damping_commands() const;

  // As decoded, and as they were in the mean (centred()): what to estimate from.
  const JointStates& states() const { return states_; }
  const JointStates& measured() const { return measured_; }
  const DriveHealth& health(std::size_t joint) const { return health_[joint]; }
  const BusCounters& counters() const { return counters_; }
  // Ticks in a row without a reply, and since configure().
  std::uint32_t missed_in_a_row(std::size_t joint) const { return links_[joint].missed_in_a_row; }
  std::uint64_t missed(std::size_t joint) const { return links_[joint].missed; }
  // Bit j: joint j's drive has not answered for silent_after_ticks ticks.
  std::uint32_t silent_joints() const;
  // Bit j: joint j's drive reports an error code.
  std::uint32_t faulty_joints() const;
  bool all_valid() const;

  // The joint that a frame commands and the command on the joint side, for records and logs.
  // kNotFound: not addressed to a drive. kInvalid: a special frame or not 8 bytes. Else kOk.
  Status decode_command_frame(const hal::CanFrame& frame, std::size_t& joint,
                              JointCommand& command) const;

 private:
  // One joint's wiring, ready for use.
  struct Wire {
    WireRanges ranges;
    double scale = 1;  // direction * belt
    double offset_rad = 0;
    double min_rad = 0;  // soft stops
    double max_rad = 0;
    double torque_limit_Nm = 0;
    std::uint16_t can_id = 0;
    std::uint8_t bus = 0;
  };
  struct Link {
    std::uint32_t outstanding = 0;  // frames sent and not answered
    std::uint32_t missed_in_a_row = 0;
    std::uint64_t missed = 0;
  };

  Status configure_joint(const robot::RobotModel& model, std::size_t joint);
  std::size_t joint_on(std::uint8_t bus, std::uint32_t id) const;  // kJoints: none
  void receive_frame(const hal::CanFrame& frame, bool listening);
  static JointState joint_state(const Wire& wire, const Reply& reply, TimeNs stamp);
  void apply(std::size_t joint, const Reply& reply, TimeNs stamp);
  hal::CanFrame frame_to(std::size_t joint) const;
  JointCommand limit(std::size_t joint, const JointCommand& command) const;
  JointCommand damping_command() const;
  Status encode_joint(std::size_t joint, const JointCommand& command, hal::CanFrame& frame);
  void note_sent(std::size_t joint);
  static void put(const CommandBytes& bytes, hal::CanFrame& frame);

  ActuationParameters parameters_{};
  std::array<Wire, robot::kJoints> wires_{};
  std::array<Link, robot::kJoints> links_{};
  std::array<std::uint8_t, robot::kJoints> order_{};  // joints by bus, then joint
  JointStates states_{};
  JointStates measured_{};
  std::array<DriveHealth, robot::kJoints> health_{};
  BusCounters counters_{};
  bool configured_ = false;
};

// Joint side to wire side and back; `scale` is direction * belt ratio.
DriveCommand to_wire(const JointCommand& command, double scale, double offset_rad);
JointCommand from_wire(const DriveCommand& command, double scale, double offset_rad);

}  // namespace surefoot::actuation
