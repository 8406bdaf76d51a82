#include "hal/candump/candump_text.h"

#include <algorithm>
#include <array>

namespace surefoot::hal {
namespace {

constexpr std::uint32_t kErrorFlag = 0x20000000;
constexpr std::uint32_t kLastExtendedId = 0x1FFFFFFF;
constexpr std::uint32_t kLastStandardId = 0x7FF;
constexpr std::int64_t kMaxSeconds = 9'000'000'000;  // in nanoseconds still below 2^63
constexpr std::size_t kClassicBytes = 8;
constexpr char kDigits[] = "0123456789ABCDEF";

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

bool is_flexible_length(std::size_t size) {
  constexpr std::array<std::size_t, 7> kLong{12, 16, 20, 24, 32, 48, 64};
  for (const std::size_t length : kLong) {
    if (size == length) return true;
  }
  return size <= kClassicBytes;
}

// Takes text from the front of a line.
class Scanner {
 public:
  explicit Scanner(std::string_view rest) : rest_(rest) {}

  bool done() const { return rest_.empty(); }
  char peek() const { return rest_.empty() ? '\0' : rest_.front(); }
  bool take(char c) {
    if (peek() != c || rest_.empty()) return false;
    rest_.remove_prefix(1);
    return true;
  }
  std::string_view take_until(char stop) {
    const std::size_t length = std::min(rest_.find(stop), rest_.size());
    const std::string_view token = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return token;
  }
  int take_hex() {
    const int value = done() ? -1 : hex_value(rest_.front());
    if (value >= 0) rest_.remove_prefix(1);
    return value;
  }

 private:
  std::string_view rest_;
};

bool parse_decimal(std::string_view text, std::int64_t& value) {
  value = 0;
  if (text.empty() || text.size() > 10) return false;  // at most 1e10: no overflow below
  for (const char c : text) {
    if (c < '0' || c > '9') return false;
    value = value * 10 + (c - '0');
  }
  return true;
}

bool parse_stamp(Scanner& scan, TimeNs& stamp) {
  std::int64_t seconds = 0;
  std::int64_t fraction = 0;
  if (!scan.take('(') || !parse_decimal(scan.take_until('.'), seconds) || !scan.take('.')) {
    return false;
  }
  const std::string_view digits = scan.take_until(')');
  if (!parse_decimal(digits, fraction) || !scan.take(')') || seconds > kMaxSeconds) return false;
  if (digits.size() != 6 && digits.size() != 9) return false;
  stamp = {seconds * 1'000'000'000 + (digits.size() == 6 ? fraction * 1000 : fraction)};
  return true;
}

bool parse_id(std::string_view digits, CanFrame& frame) {
  if (digits.size() != 3 && digits.size() != 8) return false;
  std::uint32_t id = 0;
  for (const char c : digits) {
    const int value = hex_value(c);
    if (value < 0) return false;
    id = (id << 4u) | static_cast<std::uint32_t>(value);
  }
  frame.id = id;
  if (digits.size() == 3) return id <= kLastStandardId;
  if ((id & kErrorFlag) != 0) {
    frame.flags |= CanFrame::kErrorFrame;
    frame.id = id & ~kErrorFlag;
  } else {
    frame.flags |= CanFrame::kExtendedId;
  }
  return frame.id <= kLastExtendedId;
}

// Pairs of hex digits up to the first other character.
bool parse_data(Scanner& scan, std::size_t capacity, CanFrame& frame) {
  std::size_t size = 0;
  while (hex_value(scan.peek()) >= 0) {
    if (size == capacity) return false;
    const int high = scan.take_hex();
    const int low = scan.take_hex();
    if (low < 0) return false;
    frame.data[size++] = static_cast<std::uint8_t>(high * 16 + low);
  }
  frame.size = static_cast<std::uint8_t>(size);
  return true;
}

CandumpFault parse_flexible(Scanner& scan, CanFrame& frame) {
  const int flags = scan.take_hex();
  if (flags < 0 || (frame.flags & CanFrame::kErrorFrame) != 0) return CandumpFault::kFlags;
  frame.flags |= CanFrame::kFlexibleDataRate;
  if ((flags & 1) != 0) frame.flags |= CanFrame::kBitRateSwitch;
  const bool good = parse_data(scan, frame.data.size(), frame) && is_flexible_length(frame.size);
  return good ? CandumpFault::kNone : CandumpFault::kData;
}

CandumpFault parse_classic(Scanner& scan, CandumpEntry& out) {
  if (scan.take('R')) {
    if ((out.frame.flags & CanFrame::kErrorFrame) != 0) return CandumpFault::kData;
    out.remote = true;
    const int length = scan.take_hex();
    if (length > static_cast<int>(kClassicBytes)) return CandumpFault::kData;
    out.frame.size = static_cast<std::uint8_t>(length < 0 ? 0 : length);
  } else if (!parse_data(scan, kClassicBytes, out.frame)) {
    return CandumpFault::kData;
  }
  if (out.frame.size == kClassicBytes && scan.take('_')) {
    return scan.take_hex() > static_cast<int>(kClassicBytes) ? CandumpFault::kNone
                                                             : CandumpFault::kData;
  }
  return CandumpFault::kNone;
}

std::string_view without_line_end(std::string_view line) {
  while (!line.empty() && (line.back() == '\r' || line.back() == '\n' || line.back() == ' ')) {
    line.remove_suffix(1);
  }
  return line;
}

// Appends to a buffer that is large enough by kMaxCandumpLine.
class Printer {
 public:
  explicit Printer(std::span<char, kMaxCandumpLine> out) : out_(out) {}
  void put(char c) { out_[size_++] = c; }
  void put(std::string_view text) {
    for (const char c : text) put(c);
  }
  void hex(std::uint32_t value, unsigned digits) {
    for (unsigned i = digits; i > 0; --i) put(kDigits[(value >> (4 * (i - 1))) & 0xFu]);
  }
  void decimal(std::int64_t value, unsigned digits) {
    std::array<char, 20> reversed{};
    std::size_t count = 0;
    while (value > 0 || count < digits) {
      reversed[count++] = kDigits[value % 10];
      value /= 10;
    }
    while (count > 0) put(reversed[--count]);
  }
  std::size_t size() const { return size_; }

 private:
  std::span<char, kMaxCandumpLine> out_;
  std::size_t size_ = 0;
};

bool is_name(std::string_view name) {
  if (name.empty() || name.size() > kMaxInterfaceName) return false;
  for (const char c : name) {
    if (c <= ' ' || c == '\x7F') return false;
  }
  return true;
}

bool is_frame(const CandumpEntry& entry) {
  const CanFrame& frame = entry.frame;
  const bool flexible = (frame.flags & CanFrame::kFlexibleDataRate) != 0;
  const bool wide = (frame.flags & (CanFrame::kExtendedId | CanFrame::kErrorFrame)) != 0;
  const bool error = (frame.flags & CanFrame::kErrorFrame) != 0;
  if (frame.id > (wide ? kLastExtendedId : kLastStandardId)) return false;
  if ((flexible && (entry.remote || error)) || (error && entry.remote)) return false;
  return flexible ? frame.size <= frame.data.size() && is_flexible_length(frame.size)
                  : frame.size <= kClassicBytes;
}

void print_id(const CanFrame& frame, Printer& print) {
  if ((frame.flags & CanFrame::kErrorFrame) != 0) {
    print.hex(frame.id | kErrorFlag, 8);
  } else {
    print.hex(frame.id, (frame.flags & CanFrame::kExtendedId) != 0 ? 8 : 3);
  }
}

}  // namespace

const char* to_string(CandumpFault fault) {
  switch (fault) {
    case CandumpFault::kNone: return "none";
    case CandumpFault::kStamp: return "no (seconds.microseconds) at the start";
    case CandumpFault::kInterface: return "no interface name";
    case CandumpFault::kId: return "identifier is not 3 or 8 hex digits in range";
    case CandumpFault::kSeparator: return "no # after the identifier";
    case CandumpFault::kFlags: return "no FD flag digit after ##";
    case CandumpFault::kData: return "data is not pairs of hex digits of a length that frames have";
    case CandumpFault::kTrailing: return "text after the frame";
    case CandumpFault::kTooLong: return "line longer than any frame";
  }
  return "unknown fault";
}

CandumpFault parse_candump_line(std::string_view line, CandumpEntry& out) {
  out = {};
  if (line.size() > kMaxCandumpLine) return CandumpFault::kTooLong;
  Scanner scan(without_line_end(line));
  if (!parse_stamp(scan, out.frame.stamp) || !scan.take(' ')) return CandumpFault::kStamp;
  out.interface_name = scan.take_until(' ');
  if (!is_name(out.interface_name) || !scan.take(' ')) return CandumpFault::kInterface;
  if (!parse_id(scan.take_until('#'), out.frame)) return CandumpFault::kId;
  if (!scan.take('#')) return CandumpFault::kSeparator;
  const CandumpFault fault =
      scan.take('#') ? parse_flexible(scan, out.frame) : parse_classic(scan, out);
  if (fault != CandumpFault::kNone) return fault;
  if (scan.take(' ') && !scan.take('R') && !scan.take('T')) return CandumpFault::kTrailing;
  if (scan.done()) return CandumpFault::kNone;
  // A stray character right behind the data is bad data, behind a space it is trailing text.
  return scan.peek() == ' ' ? CandumpFault::kTrailing : CandumpFault::kData;
}

std::size_t format_candump_line(const CandumpEntry& entry, std::span<char, kMaxCandumpLine> out) {
  if (!is_frame(entry) || !is_name(entry.interface_name)) return 0;
  const CanFrame& frame = entry.frame;
  const std::int64_t stamp_us = frame.stamp.ns > 0 ? frame.stamp.ns / 1000 : 0;
  Printer print(out);
  print.put('(');
  print.decimal(stamp_us / 1'000'000, 10);
  print.put('.');
  print.decimal(stamp_us % 1'000'000, 6);
  print.put(") ");
  print.put(entry.interface_name);
  print.put(' ');
  print_id(frame, print);
  print.put('#');
  if ((frame.flags & CanFrame::kFlexibleDataRate) != 0) {
    print.put('#');
    print.hex((frame.flags & CanFrame::kBitRateSwitch) != 0 ? 1 : 0, 1);
  }
  if (entry.remote) {
    print.put('R');
    if (frame.size > 0) print.hex(frame.size, 1);
    return print.size();
  }
  for (std::size_t i = 0; i < frame.size; ++i) print.hex(frame.data[i], 2);
  return print.size();
}

}  // namespace surefoot::hal
