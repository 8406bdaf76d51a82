#include "core/actuation/joint_bus.h"

#include <algorithm>

#include "core/base/assert.h"
#include "core/math/elementary.h"

namespace surefoot::actuation {
namespace {

constexpr std::uint32_t kLastStandardId = 0x7FF;
constexpr std::uint8_t kNoReplyFlags =
    hal::CanFrame::kExtendedId | hal::CanFrame::kFlexibleDataRate | hal::CanFrame::kBitRateSwitch;

bool is_finite(const JointCommand& c) {
  return math::is_finite(c.position_rad) && math::is_finite(c.velocity_rad_s) &&
         math::is_finite(c.kp_Nm_rad) && math::is_finite(c.kd_Nm_s_rad) &&
         math::is_finite(c.torque_Nm);
}

// Positions count only where there is a gain to act on them.
bool differs(const JointCommand& a, const JointCommand& b) {
  const bool moved = a.position_rad != b.position_rad && a.kp_Nm_rad > 0.0;
  return moved || a.velocity_rad_s != b.velocity_rad_s || a.kp_Nm_rad != b.kp_Nm_rad ||
         a.kd_Nm_s_rad != b.kd_Nm_s_rad || a.torque_Nm != b.torque_Nm;
}

using math::magnitude;

std::span<const std::uint8_t> payload(const hal::CanFrame& frame) {
  return {frame.data.data(), std::min<std::size_t>(frame.size, frame.data.size())};
}

}  // namespace

DriveCommand to_wire(const JointCommand& command, double scale, double offset_rad) {
  const double square = scale * scale;
  return {.position_rad = scale * command.position_rad + offset_rad,
          .velocity_rad_s = scale * command.velocity_rad_s,
          .kp_Nm_rad = command.kp_Nm_rad / square,
          .kd_Nm_s_rad = command.kd_Nm_s_rad / square,
          .torque_Nm = command.torque_Nm / scale};
}

JointCommand from_wire(const DriveCommand& command, double scale, double offset_rad) {
  const double square = scale * scale;
  return {.position_rad = (command.position_rad - offset_rad) / scale,
          .velocity_rad_s = command.velocity_rad_s / scale,
          .kp_Nm_rad = command.kp_Nm_rad * square,
          .kd_Nm_s_rad = command.kd_Nm_s_rad * square,
          .torque_Nm = command.torque_Nm * scale};
}

Status JointBus::configure(const robot::RobotModel& model, const ActuationParameters& parameters) {
  *this = JointBus{};
  parameters_ = parameters;
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    const Status status = configure_joint(model, joint);
    if (!ok(status)) return status;
    for (std::size_t other = 0; other < joint; ++other) {
      const bool same =
          wires_[other].bus == wires_[joint].bus && wires_[other].can_id == wires_[joint].can_id;
      if (same) return Status::kInvalid;
    }
  }
  std::size_t next = 0;
  for (std::size_t bus = 0; bus < hal::kMaxCanBuses; ++bus) {
    for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
      if (wires_[joint].bus == bus) order_[next++] = static_cast<std::uint8_t>(joint);
    }
  }
  configured_ = true;
  return Status::kOk;
}

Status JointBus::configure_joint(const robot::RobotModel& model, std::size_t joint) {
  const robot::JointWiring& wiring = model.wiring[joint];
  const robot::Actuator& actuator = model.actuators[joint % robot::kJointsPerLeg];
  const robot::JointRange range = model.joint_range(joint);
  Wire& wire = wires_[joint];
  wire.ranges = {.position_rad = wiring.position_range_rad,
                 .velocity_rad_s = wiring.velocity_range_rad_s,
                 .kp_max_Nm_rad = wiring.kp_max_Nm_rad,
                 .kd_max_Nm_s_rad = wiring.kd_max_Nm_s_rad,
                 .torque_Nm = wiring.torque_range_Nm};
  const bool good_scale = (wiring.direction == 1.0 || wiring.direction == -1.0) &&
                          math::is_finite(wiring.belt_ratio) && wiring.belt_ratio > 0.0;
  const bool good_address = wiring.bus < hal::kMaxCanBuses && wiring.can_id >= 1 &&
                            wiring.can_id <= 0xFF;  // a reply names the drive in one byte
  const bool good_limits = math::is_finite(wiring.offset_rad) && math::is_finite(range.min_rad) &&
                           math::is_finite(range.max_rad) &&
                           math::is_finite(actuator.torque_limit_Nm) &&
                           actuator.torque_limit_Nm > 0.0;
  if (!valid(wire.ranges) || !good_scale || !good_address || !good_limits) return Status::kInvalid;

  wire.bus = wiring.bus;
  wire.can_id = wiring.can_id;
  wire.scale = wiring.direction * wiring.belt_ratio;
  wire.offset_rad = wiring.offset_rad;
  wire.min_rad = range.min_rad + parameters_.soft_stop_margin_rad;
  wire.max_rad = range.max_rad - parameters_.soft_stop_margin_rad;
  wire.torque_limit_Nm = actuator.torque_limit_Nm;
  const double low = magnitude(wire.scale * range.min_rad + wire.offset_rad);
  const double high = magnitude(wire.scale * range.max_rad + wire.offset_rad);
  const bool reachable = low <= wiring.position_range_rad && high <= wiring.position_range_rad;
  return reachable && wire.min_rad < wire.max_rad ? Status::kOk : Status::kOutOfRange;
}

std::size_t JointBus::joint_on(std::uint8_t bus, std::uint32_t id) const {
  for (std::size_t joint = 0; configured_ && joint < robot::kJoints; ++joint) {
    if (wires_[joint].bus == bus && wires_[joint].can_id == id) return joint;
  }
  return robot::kJoints;
}

void JointBus::receive(std::span<const hal::CanFrame> frames) {
  for (const hal::CanFrame& frame : frames) receive_frame(frame, false);
}

void JointBus::listen(std::span<const hal::CanFrame> frames) {
  for (const hal::CanFrame& frame : frames) receive_frame(frame, true);
}

void JointBus::receive_frame(const hal::CanFrame& frame, bool listening) {
  if ((frame.flags & hal::CanFrame::kErrorFrame) != 0) {
    ++counters_.errors;
    return;
  }
  if ((frame.flags & kNoReplyFlags) != 0 || frame.id > kLastStandardId ||
      frame.size > kMaxReplyBytes) {
    ++counters_.invalid;
    return;
  }
  const std::size_t addressed = joint_on(frame.bus, frame.id);
  if (frame.size == kCommandBytes && addressed < robot::kJoints) {
    ++counters_.commands;
    if (listening) note_sent(addressed);
    return;
  }
  const Result<std::uint8_t> id = reply_drive_id(payload(frame));
  if (!id.ok()) {
    ++counters_.invalid;
    return;
  }
  const std::size_t joint = joint_on(frame.bus, id.value());
  if (joint == robot::kJoints) {
    ++counters_.unknown;
    return;
  }
  const Result<Reply> reply = decode_reply(wires_[joint].ranges, payload(frame));
  SUREFOOT_ASSERT(reply.ok());  // length and ranges were checked above and in configure
  apply(joint, reply.value(), frame.stamp);
}

JointState JointBus::joint_state(const Wire& wire, const Reply& reply, TimeNs stamp) {
  const JointCommand joint_side = from_wire({.position_rad = reply.position_rad,
                                             .velocity_rad_s = reply.velocity_rad_s,
                                             .kp_Nm_rad = 0,
                                             .kd_Nm_s_rad = 0,
                                             .torque_Nm = reply.torque_Nm},
                                            wire.scale, wire.offset_rad);
  return {.position_rad = joint_side.position_rad,
          .velocity_rad_s = joint_side.velocity_rad_s,
          .torque_Nm = joint_side.torque_Nm,
          .stamp = stamp,
          .valid = true};
}

void JointBus::apply(std::size_t joint, const Reply& reply, TimeNs stamp) {
  const Wire& wire = wires_[joint];
  Link& link = links_[joint];
  ++counters_.replies;
  if (link.outstanding == 0) ++counters_.duplicates;
  if (link.outstanding > 0) --link.outstanding;
  link.missed_in_a_row = 0;

  states_[joint] = joint_state(wire, reply, stamp);
  measured_[joint] = joint_state(wire, centred(wire.ranges, reply), stamp);
  if (reply.has_health) {
    health_[joint].error = reply.error;
    health_[joint].temperature_code = reply.temperature_code;
  }
  if (reply.has_voltage) health_[joint].voltage_V = reply.voltage_V;
}

hal::CanFrame JointBus::frame_to(std::size_t joint) const {
  hal::CanFrame frame;
  frame.bus = wires_[joint].bus;
  frame.id = wires_[joint].can_id;
  frame.size = kCommandBytes;
  return frame;
}

void JointBus::put(const CommandBytes& bytes, hal::CanFrame& frame) {
  for (std::size_t i = 0; i < bytes.size(); ++i) frame.data[i] = bytes[i];
}

// A drive that left the frame before unanswered: it or its reply is lost, or late. A late reply is
// counted here as missed and on arrival takes the place of the answer to this frame.
void JointBus::note_sent(std::size_t joint) {
  Link& link = links_[joint];
  if (link.outstanding > 0) {
    link.missed += link.outstanding;
    counters_.missed += link.outstanding;
    ++link.missed_in_a_row;
    if (link.missed_in_a_row >= parameters_.silent_after_ticks) {
      states_[joint].valid = false;
      measured_[joint].valid = false;
    }
  }
  link.outstanding = 1;
}

JointCommand JointBus::limit(std::size_t joint, const JointCommand& command) const {
  const Wire& wire = wires_[joint];
  const JointState& state = states_[joint];
  JointCommand out = command;
  out.position_rad = math::clamp(out.position_rad, wire.min_rad, wire.max_rad);
  out.torque_Nm = math::clamp(out.torque_Nm, -wire.torque_limit_Nm, wire.torque_limit_Nm);
  out.kp_Nm_rad = out.kp_Nm_rad > 0.0 ? out.kp_Nm_rad : 0.0;
  out.kd_Nm_s_rad = out.kd_Nm_s_rad > 0.0 ? out.kd_Nm_s_rad : 0.0;
  if (state.valid && state.position_rad <= wire.min_rad) {
    if (out.torque_Nm < 0.0) out.torque_Nm = 0.0;
    if (out.velocity_rad_s < 0.0) out.velocity_rad_s = 0.0;
  }
  if (state.valid && state.position_rad >= wire.max_rad) {
    if (out.torque_Nm > 0.0) out.torque_Nm = 0.0;
    if (out.velocity_rad_s > 0.0) out.velocity_rad_s = 0.0;
  }
  return out;
}

JointCommand JointBus::damping_command() const {
  JointCommand command;
  command.kd_Nm_s_rad = parameters_.damping_Nm_s_rad;
  return command;
}

JointCommands JointBus::damping_commands() const {
  JointCommands commands;
  for (JointCommand& command : commands) command = damping_command();
  return commands;
}

Status JointBus::encode_joint(std::size_t joint, const JointCommand& command,
                              hal::CanFrame& frame) {
  const Wire& wire = wires_[joint];
  const bool finite = is_finite(command);
  const JointCommand wanted = finite ? command : damping_command();
  const JointCommand limited = limit(joint, wanted);
  if (!finite) {
    ++counters_.refused;
  } else if (differs(limited, wanted)) {
    ++counters_.limited;
  }
  DriveCommand drive = to_wire(limited, wire.scale, wire.offset_rad);
  CommandBytes bytes{};
  // Only a product that overflows can fail here: gains or speeds of 1e300.
  Status status = finite ? Status::kOk : Status::kInvalid;
  if (!ok(encode_command(wire.ranges, drive, bytes))) {
    status = Status::kInvalid;
    ++counters_.refused;
    drive = to_wire(limit(joint, damping_command()), wire.scale, wire.offset_rad);
    SUREFOOT_ASSERT(ok(encode_command(wire.ranges, drive, bytes)));
  }
  put(bytes, frame);
  note_sent(joint);
  return status;
}

std::uint32_t JointBus::silent_joints() const {
  std::uint32_t mask = 0;
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    if (links_[joint].missed_in_a_row >= parameters_.silent_after_ticks) mask |= 1u << joint;
  }
  return mask;
}

std::uint32_t JointBus::faulty_joints() const {
  std::uint32_t mask = 0;
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    if (health_[joint].error != DriveError::kNone) mask |= 1u << joint;
  }
  return mask;
}

bool JointBus::all_valid() const {
  for (const JointState& state : states_) {
    if (!state.valid) return false;
  }
  return true;
}

Status JointBus::decode_command_frame(const hal::CanFrame& frame, std::size_t& joint,
                                      JointCommand& command) const {
  if (frame.flags != 0) return Status::kNotFound;
  const std::size_t found = joint_on(frame.bus, frame.id);
  if (found == robot::kJoints) return Status::kNotFound;
  const Result<DriveCommand> drive = decode_command(wires_[found].ranges, payload(frame));
  if (!drive.ok()) return drive.status();
  joint = found;
  command = from_wire(drive.value(), wires_[found].scale, wires_[found].offset_rad);
  return Status::kOk;
}

}  // namespace surefoot::actuation
