// The MIT Mini-Cheetah CAN protocol of one drive: 8-byte commands, replies of 6, 7 or 8 bytes, and
// three special frames. All quantities are at the drive's output shaft ("wire" side); joint_bus.h
// turns them into joint quantities.
//
// Command, big endian:  p 16 bit | v 12 | kp 12 | kd 12 | t 12
// Reply,   big endian:  id 8     | p 16 | v 12  | t 12  [| byte 6 [| byte 7]]
// The drive applies  torque = kp (p - angle) + kd (v - speed) + t.
//
// Codes truncate, as the drive firmware does: code = floor((x - low) (2^n - 1) / (high - low) +
// 2^-16) after clamping x to [low, high]. The 2^-16 of a code only absorbs the rounding of decode:
// every code survives decode and encode. So a decoded value is at most one step below what was
// asked, and zero, which lies between two codes of the symmetric fields, becomes 0x7FF (0x7FFF),
// half a step below zero. A limp drive is therefore asked for kp = kd = t = 0 and still feels half
// a torque step (4.4 mN m at +-18 N m); no command can say exactly zero.
//
// All functions: no state, at most a few hundred cycles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/status.h"

namespace surefoot::actuation {

inline constexpr std::size_t kCommandBytes = 8;
inline constexpr std::size_t kMinReplyBytes = 6;
inline constexpr std::size_t kMaxReplyBytes = 8;

// What the codes of a drive's firmware mean. Drives of one make differ: always configuration.
struct WireRanges {
  double position_rad = 0;    // +-
  double velocity_rad_s = 0;  // +-
  double kp_max_Nm_rad = 0;   // 0 .. this
  double kd_max_Nm_s_rad = 0;
  double torque_Nm = 0;  // +-
};

// Each span finite and above zero.
bool valid(const WireRanges& ranges);

struct DriveCommand {
  double position_rad = 0;
  double velocity_rad_s = 0;
  double kp_Nm_rad = 0;
  double kd_Nm_s_rad = 0;
  double torque_Nm = 0;
};

using CommandBytes = std::array<std::uint8_t, kCommandBytes>;

// What a frame addressed to a drive asks for. The special ones are seven bytes 0xFF and a last byte
// 0xFC (enter motor mode; also harmless way to ask for a reply), 0xFD (exit), 0xFE (make the
// present angle zero: honoured out of motor mode only, writes flash, blocks the drive up to 1 s).
enum class FrameKind : std::uint8_t { kCommand, kEnterMotorMode, kExitMotorMode, kSetZero };

// kInvalid: not 8 bytes.
Result<FrameKind> classify(std::span<const std::uint8_t> bytes);

// The bytes of a special frame. kCommand is a programmer's error.
CommandBytes encode_special(FrameKind kind);

// Values beyond the ranges are clamped. A fully saturated command would read as a special frame:
// its kd is lowered by one code (0.02 % of the range), so no command ever aliases one.
// kInvalid: a value is not finite or a range is not valid; out unchanged.
Status encode_command(const WireRanges& ranges, const DriveCommand& command, CommandBytes& out);

// The drive's side. kInvalid: not 8 bytes, or a special frame.
Result<DriveCommand> decode_command(const WireRanges& ranges, std::span<const std::uint8_t> bytes);

// Error codes of 8-byte replies (CubeMars AK drives); values from 7 up are passed through.
enum class DriveError : std::uint8_t {
  kNone = 0,
  kOverTemperature = 1,
  kOverCurrent = 2,
  kOverVoltage = 3,
  kUnderVoltage = 4,
  kEncoder = 5,
  kPhaseUnbalance = 6,
};

struct Reply {
  std::uint8_t drive_id = 0;
  double position_rad = 0;
  double velocity_rad_s = 0;
  double torque_Nm = 0;
  bool has_voltage = false;  // 7 bytes
  double voltage_V = 0;      // 0 .. 40; some firmware sends the margin to its limit instead
  bool has_health = false;   // 8 bytes
  std::uint8_t temperature_code = 0;  // degrees Celsius on AK firmware V1/V2, raw as sent
  DriveError error = DriveError::kNone;
};

struct ReplyBytes {
  std::array<std::uint8_t, kMaxReplyBytes> data{};
  std::uint8_t size = 0;
  std::span<const std::uint8_t> bytes() const { return {data.data(), size}; }
};

// The drive id of a reply (byte 0): replies of all drives may share one CAN id.
// kInvalid: not 6, 7 or 8 bytes.
Result<std::uint8_t> reply_drive_id(std::span<const std::uint8_t> bytes);

// kInvalid: not 6, 7 or 8 bytes, or a range is not valid.
Result<Reply> decode_reply(const WireRanges& ranges, std::span<const std::uint8_t> bytes);

// What the drive measured, in the mean: position, velocity and torque half a code higher than
// decoded, for the drive truncates. Half a code of velocity is 7 to 16 mrad/s, and never averages
// out.
Reply centred(const WireRanges& ranges, const Reply& decoded);

// The drive's side: 8 bytes with health, 7 with voltage, else 6. Values are clamped.
// kInvalid: a value is not finite or a range is not valid.
Result<ReplyBytes> encode_reply(const WireRanges& ranges, const Reply& reply);

// One field: code of x in [low, high] with the given bits, and back. For tests and tables.
std::uint32_t encode_field(double x, double low, double high, unsigned bits);
double decode_field(std::uint32_t code, double low, double high, unsigned bits);

}  // namespace surefoot::actuation
