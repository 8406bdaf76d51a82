// Tracking camera or other external source of 6-degree-of-freedom poses.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.h"
#include "hal/api/sensor_counters.h"

namespace surefoot::hal {

// Pose of the sensor frame T in the sensor's own start frame S.
struct PoseSample {
  TimeNs stamp;
  std::uint32_t sequence = 0;
  std::uint8_t confidence = 0;  // 0 = lost, 1 low, 2 medium, 3 high
  std::array<double, 3> p_ST_m{};
  std::array<double, 4> q_ST_wxyz{1, 0, 0, 0};  // unit quaternion, w first

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("stamp_ns", self.stamp);
    visit("sequence", self.sequence);
    visit("confidence", self.confidence);
    visit("p_ST_m", self.p_ST_m);
    visit("q_ST_wxyz", self.q_ST_wxyz);
  }
};

class PosePort {
 public:
  // Moves up to out.size() samples, oldest first, and returns how many. Never blocks.
  std::size_t receive(std::span<PoseSample> out) { return do_receive(out); }
  SensorCounters counters() const { return do_counters(); }

 protected:
  ~PosePort() = default;

 private:
  virtual std::size_t do_receive(std::span<PoseSample> out) = 0;
  virtual SensorCounters do_counters() const = 0;
};

}  // namespace surefoot::hal
