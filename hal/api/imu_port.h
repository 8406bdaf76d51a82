// Inertial measurement unit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.h"
#include "hal/api/sensor_counters.h"

namespace surefoot::hal {

// One sample in the sensor's own frame I (docs/frames_and_units.md). A sensor at rest, z up, reads
// specific force (0, 0, +9.81).
struct ImuSample {
  TimeNs stamp;  // when the sample was taken
  std::uint32_t sequence = 0;
  std::array<double, 3> angular_velocity_I_rad_s{};
  std::array<double, 3> specific_force_I_m_s2{};

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("stamp_ns", self.stamp);
    visit("sequence", self.sequence);
    visit("angular_velocity_I_rad_s", self.angular_velocity_I_rad_s);
    visit("specific_force_I_m_s2", self.specific_force_I_m_s2);
  }
};

class ImuPort {
 public:
  // Moves up to out.size() samples, oldest first, and returns how many. Never blocks.
  std::size_t receive(std::span<ImuSample> out) { return do_receive(out); }
  SensorCounters counters() const { return do_counters(); }

 protected:
  ~ImuPort() = default;

 private:
  virtual std::size_t do_receive(std::span<ImuSample> out) = 0;
  virtual SensorCounters do_counters() const = 0;
};

}  // namespace surefoot::hal
