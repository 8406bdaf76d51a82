// CAN buses: frames as they are on the wire.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/status.h"
#include "core/base/time.h"

namespace surefoot::hal {

inline constexpr std::size_t kMaxCanBuses = 4;

// One classic or FD frame. Bytes from `size` on are zero, so that equal frames compare and hash
// equal.
struct CanFrame {
  enum Flag : std::uint8_t {
    kExtendedId = 1,
    kFlexibleDataRate = 2,
    kBitRateSwitch = 4,
    kErrorFrame = 8
  };

  TimeNs stamp;          // receive time on Clock; zero on transmit
  std::uint32_t id = 0;  // 11- or 29-bit identifier without flag bits
  std::uint8_t bus = 0;  // index into the robot file's bus list
  std::uint8_t flags = 0;
  std::uint8_t size = 0;  // 0..64 bytes
  std::array<std::uint8_t, 64> data{};

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("stamp_ns", self.stamp);
    visit("id", self.id);
    visit("bus", self.bus);
    visit("flags", self.flags);
    visit("size", self.size);
    // Only the bytes in use; a damaged size must not run past the array.
    const std::size_t used = std::min<std::size_t>(self.size, self.data.size());
    for (std::size_t i = 0; i < used; ++i) visit("data", self.data[i]);
  }
};

struct CanCounters {
  std::uint64_t received = 0;
  std::uint64_t sent = 0;
  std::uint64_t receive_dropped = 0;  // arrived, but a queue was full
  std::uint64_t send_dropped = 0;     // refused by a full queue or a bus that is off
  std::uint64_t error_frames = 0;
};

class CanPort {
 public:
  // Moves up to out.size() received frames of all buses, oldest first, and returns how many. Never
  // blocks. Frames of one bus keep their order; equal stamps are ordered by bus index.
  std::size_t receive(std::span<CanFrame> out) { return do_receive(out); }
  // kExhausted: the transmit queue is full, frame dropped and counted. kUnavailable: bus off or
  // index without a bus, dropped and counted. kInvalid: size or id out of range, nothing sent.
  Status send(const CanFrame& frame) { return do_send(frame); }
  CanCounters counters() const { return do_counters(); }

 protected:
  ~CanPort() = default;  // never deleted through the base: owners are static

 private:
  virtual std::size_t do_receive(std::span<CanFrame> out) = 0;
  virtual Status do_send(const CanFrame& frame) = 0;
  virtual CanCounters do_counters() const = 0;
};

}  // namespace surefoot::hal
