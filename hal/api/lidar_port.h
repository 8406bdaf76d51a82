// Planar laser scanner.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/status.h"
#include "core/base/time.h"
#include "hal/api/sensor_counters.h"

namespace surefoot::hal {

inline constexpr std::size_t kMaxLidarBeams = 1081;

// One sweep in the scanner's frame L: x forward, y left, beams counter-clockwise in the x-y plane.
// Beam i points at first_angle_rad + i * angle_step_rad. Range 0 means no return.
struct LidarScan {
  TimeNs stamp;          // time of the first beam
  TimeNs beam_interval;  // between consecutive beams
  std::uint32_t sequence = 0;
  std::uint16_t beam_count = 0;
  float first_angle_rad = 0;
  float angle_step_rad = 0;
  std::array<float, kMaxLidarBeams> range_m{};

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("stamp_ns", self.stamp);
    visit("beam_interval_ns", self.beam_interval);
    visit("sequence", self.sequence);
    visit("beam_count", self.beam_count);
    visit("first_angle_rad", self.first_angle_rad);
    visit("angle_step_rad", self.angle_step_rad);
    const std::size_t count = self.beam_count <= kMaxLidarBeams ? self.beam_count : 0;
    for (std::size_t i = 0; i < count; ++i) visit("range_m", self.range_m[i]);
  }
};

class LidarPort {
 public:
  // Copies the oldest waiting scan into out. kUnavailable: none, out unchanged. Never blocks.
  Status receive(LidarScan& out) { return do_receive(out); }
  SensorCounters counters() const { return do_counters(); }

 protected:
  ~LidarPort() = default;

 private:
  virtual Status do_receive(LidarScan& out) = 0;
  virtual SensorCounters do_counters() const = 0;
};

}  // namespace surefoot::hal
