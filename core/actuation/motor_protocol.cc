#include "core/actuation/motor_protocol.h"

#include "core/base/assert.h"
#include "core/math/elementary.h"

namespace surefoot::actuation {
namespace {

constexpr unsigned kPositionBits = 16;
constexpr unsigned kFieldBits = 12;
constexpr double kVoltageSpan_V = 40.0;  // motorcontrol v2: byte 6 = 40 V / 255
constexpr double kTruncationGuard = 0x1p-16;

constexpr std::uint8_t byte_of(std::uint32_t code, unsigned shift) {
  return static_cast<std::uint8_t>((code >> shift) & 0xFFu);
}

bool is_positive(double span) { return math::is_finite(span) && span > 0.0; }

bool is_finite(const DriveCommand& c) {
  return math::is_finite(c.position_rad) && math::is_finite(c.velocity_rad_s) &&
         math::is_finite(c.kp_Nm_rad) && math::is_finite(c.kd_Nm_s_rad) &&
         math::is_finite(c.torque_Nm);
}

bool all_ones(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    if (byte != 0xFFu) return false;
  }
  return true;
}

bool is_reply_length(std::size_t size) { return size >= kMinReplyBytes && size <= kMaxReplyBytes; }

// Two 12-bit codes in three bytes.
void pack_pair(std::uint32_t first, std::uint32_t second, std::uint8_t* out) {
  const std::uint32_t both = (first << 12u) | second;
  out[0] = byte_of(both, 16);
  out[1] = byte_of(both, 8);
  out[2] = byte_of(both, 0);
}

struct CodePair {
  std::uint32_t first;
  std::uint32_t second;
};

CodePair unpack_pair(const std::uint8_t* bytes) {
  const std::uint32_t both = (static_cast<std::uint32_t>(bytes[0]) << 16u) |
                             (static_cast<std::uint32_t>(bytes[1]) << 8u) | bytes[2];
  return {both >> 12u, both & 0xFFFu};
}

std::uint32_t unpack_position(const std::uint8_t* bytes) {
  return (static_cast<std::uint32_t>(bytes[0]) << 8u) | bytes[1];
}

std::uint32_t encode_symmetric(double x, double range, unsigned bits) {
  return encode_field(x, -range, range, bits);
}

double half_step(double range, unsigned bits) { return range / ((1u << bits) - 1u); }

double decode_symmetric(std::uint32_t code, double range, unsigned bits) {
  return decode_field(code, -range, range, bits);
}

}  // namespace

std::uint32_t encode_field(double x, double low, double high, unsigned bits) {
  const std::uint32_t last = (1u << bits) - 1u;
  const double steps = (math::clamp(x, low, high) - low) * (last / (high - low));
  const auto code = static_cast<std::uint32_t>(steps + kTruncationGuard);
  return code < last ? code : last;
}

double decode_field(std::uint32_t code, double low, double high, unsigned bits) {
  const std::uint32_t last = (1u << bits) - 1u;
  return static_cast<double>(code) * (high - low) / last + low;
}

bool valid(const WireRanges& ranges) {
  return is_positive(ranges.position_rad) && is_positive(ranges.velocity_rad_s) &&
         is_positive(ranges.kp_max_Nm_rad) && is_positive(ranges.kd_max_Nm_s_rad) &&
         is_positive(ranges.torque_Nm);
}

Result<FrameKind> classify(std::span<const std::uint8_t> bytes) {
  if (bytes.size() != kCommandBytes) return Status::kInvalid;
  if (!all_ones(bytes.first(kCommandBytes - 1))) return FrameKind::kCommand;
  switch (bytes[kCommandBytes - 1]) {
    case 0xFC: return FrameKind::kEnterMotorMode;
    case 0xFD: return FrameKind::kExitMotorMode;
    case 0xFE: return FrameKind::kSetZero;
    default: return FrameKind::kCommand;
  }
}

CommandBytes encode_special(FrameKind kind) {
  SUREFOOT_ASSERT(kind != FrameKind::kCommand);
  CommandBytes out{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFC};
  if (kind == FrameKind::kExitMotorMode) out[7] = 0xFD;
  if (kind == FrameKind::kSetZero) out[7] = 0xFE;
  return out;
}

Status encode_command(const WireRanges& ranges, const DriveCommand& command, CommandBytes& out) {
  if (!valid(ranges) || !is_finite(command)) return Status::kInvalid;
  const std::uint32_t p =
      encode_symmetric(command.position_rad, ranges.position_rad, kPositionBits);
  const std::uint32_t v =
      encode_symmetric(command.velocity_rad_s, ranges.velocity_rad_s, kFieldBits);
  const std::uint32_t kp = encode_field(command.kp_Nm_rad, 0.0, ranges.kp_max_Nm_rad, kFieldBits);
  const std::uint32_t kd =
      encode_field(command.kd_Nm_s_rad, 0.0, ranges.kd_max_Nm_s_rad, kFieldBits);
  const std::uint32_t t = encode_symmetric(command.torque_Nm, ranges.torque_Nm, kFieldBits);
  out[0] = byte_of(p, 8);
  out[1] = byte_of(p, 0);
  pack_pair(v, kp, &out[2]);
  pack_pair(kd, t, &out[5]);
  // Any last byte, not only 0xFC..0xFE: other firmware may give the rest a meaning.
  if (all_ones(std::span(out).first(kCommandBytes - 1))) pack_pair(kd - 1u, t, &out[5]);
  return Status::kOk;
}

Result<DriveCommand> decode_command(const WireRanges& ranges, std::span<const std::uint8_t> bytes) {
  const Result<FrameKind> kind = classify(bytes);
  if (!kind.ok() || kind.value() != FrameKind::kCommand || !valid(ranges)) return Status::kInvalid;
  const CodePair v_kp = unpack_pair(&bytes[2]);
  const CodePair kd_t = unpack_pair(&bytes[5]);
  DriveCommand command;
  command.position_rad =
      decode_symmetric(unpack_position(&bytes[0]), ranges.position_rad, kPositionBits);
  command.velocity_rad_s = decode_symmetric(v_kp.first, ranges.velocity_rad_s, kFieldBits);
  command.kp_Nm_rad = decode_field(v_kp.second, 0.0, ranges.kp_max_Nm_rad, kFieldBits);
  command.kd_Nm_s_rad = decode_field(kd_t.first, 0.0, ranges.kd_max_Nm_s_rad, kFieldBits);
  command.torque_Nm = decode_symmetric(kd_t.second, ranges.torque_Nm, kFieldBits);
  return command;
}

Result<std::uint8_t> reply_drive_id(std::span<const std::uint8_t> bytes) {
  if (!is_reply_length(bytes.size())) return Status::kInvalid;
  return bytes[0];
}

Result<Reply> decode_reply(const WireRanges& ranges, std::span<const std::uint8_t> bytes) {
  if (!is_reply_length(bytes.size()) || !valid(ranges)) return Status::kInvalid;
  const CodePair v_t = unpack_pair(&bytes[3]);
  Reply reply;
  reply.drive_id = bytes[0];
  reply.position_rad =
      decode_symmetric(unpack_position(&bytes[1]), ranges.position_rad, kPositionBits);
  reply.velocity_rad_s = decode_symmetric(v_t.first, ranges.velocity_rad_s, kFieldBits);
  reply.torque_Nm = decode_symmetric(v_t.second, ranges.torque_Nm, kFieldBits);
  if (bytes.size() == 7) {
    reply.has_voltage = true;
    reply.voltage_V = decode_field(bytes[6], 0.0, kVoltageSpan_V, 8);
  } else if (bytes.size() == 8) {
    reply.has_health = true;
    reply.temperature_code = bytes[6];
    reply.error = static_cast<DriveError>(bytes[7]);
  }
  return reply;
}

Reply centred(const WireRanges& ranges, const Reply& decoded) {
  Reply reply = decoded;
  reply.position_rad += half_step(ranges.position_rad, kPositionBits);
  reply.velocity_rad_s += half_step(ranges.velocity_rad_s, kFieldBits);
  reply.torque_Nm += half_step(ranges.torque_Nm, kFieldBits);
  return reply;
}

Result<ReplyBytes> encode_reply(const WireRanges& ranges, const Reply& reply) {
  const bool finite = math::is_finite(reply.position_rad) &&
                      math::is_finite(reply.velocity_rad_s) && math::is_finite(reply.torque_Nm) &&
                      math::is_finite(reply.voltage_V);
  if (!valid(ranges) || !finite) return Status::kInvalid;
  const std::uint32_t p = encode_symmetric(reply.position_rad, ranges.position_rad, kPositionBits);
  ReplyBytes out;
  out.size = 6;
  out.data[0] = reply.drive_id;
  out.data[1] = byte_of(p, 8);
  out.data[2] = byte_of(p, 0);
  pack_pair(encode_symmetric(reply.velocity_rad_s, ranges.velocity_rad_s, kFieldBits),
            encode_symmetric(reply.torque_Nm, ranges.torque_Nm, kFieldBits), &out.data[3]);
  if (reply.has_health) {
    out.size = 8;
    out.data[6] = reply.temperature_code;
    out.data[7] = static_cast<std::uint8_t>(reply.error);
  } else if (reply.has_voltage) {
    out.size = 7;
    out.data[6] = static_cast<std::uint8_t>(encode_field(reply.voltage_V, 0.0, kVoltageSpan_V, 8));
  }
  return out;
}

}  // namespace surefoot::actuation
