// One line of `candump -L` text (can-utils): `(seconds.microseconds) interface ID#DATA`.
//
//   ID        3 hex digits: 11-bit id; 8: 29-bit id, or, with bit 29 set (20000000), an error frame
//   #DATA     0..8 bytes as pairs of hex digits; then `_9` .. `_F` may state a raw length code
//   #R, #R0 .. #R8   remote frame asking for so many bytes
//   ##F DATA  FD frame: one hex digit of flags (1 bit-rate switch, 2 error state, 4 FD), then
//             0..8, 12, 16, 20, 24, 32, 48 or 64 bytes without a space
//
// Also read: nanoseconds (9 digits, `candump -N`), lower case, a final ` R` or ` T` (direction,
// `-x`), CR before the end of the line. Not kept: FD error state, raw length code, direction.
// Nothing here allocates or depends on the locale.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/time.h"
#include "hal/api/can_port.h"

namespace surefoot::hal {

enum class CandumpFault : std::uint8_t {
  kNone = 0,
  kStamp,      // no `(seconds.fraction)`
  kInterface,  // no interface name of 1..15 characters
  kId,         // not 3 or 8 hex digits, or a bit is set that no identifier has
  kSeparator,  // no `#`
  kFlags,      // no FD flag digit
  kData,       // odd number of digits, a character that is not hexadecimal, or a wrong length
  kTrailing,   // more text after the frame
  kTooLong,    // the line is longer than any frame
};
const char* to_string(CandumpFault fault);

struct CandumpEntry {
  CanFrame frame;       // its stamp is the line's time; its bus is 0: the interface name decides
  bool remote = false;  // size is the number of bytes asked for; data is zero
  std::string_view interface_name;
};

inline constexpr std::size_t kMaxInterfaceName = 15;  // IFNAMSIZ - 1
inline constexpr std::size_t kMaxCandumpLine = 192;   // a 64-byte FD frame needs 183

// On a fault `out` holds what was read up to there and must not be used. `interface_name` points
// into `line`.
CandumpFault parse_candump_line(std::string_view line, CandumpEntry& out);

// Writes the line without its end and returns its length; times are truncated to microseconds and
// negative ones are written as zero. 0: the entry is not a frame (size, id or name out of range).
std::size_t format_candump_line(const CandumpEntry& entry, std::span<char, kMaxCandumpLine> out);

}  // namespace surefoot::hal
