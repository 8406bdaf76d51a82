// A body whose legs are moved by a gait controller of its own: it takes body velocities and tells
// how its legs moved it. What navigation alone is run on (the simulator's plant without legs; a
// machine that brings its own gaits).
#pragma once

#include <array>
#include <cstdint>

#include "core/base/status.h"
#include "core/base/time.h"
#include "hal/api/sensor_counters.h"

namespace surefoot::hal {

// In B. Held until the next one; the body comes to a stand by itself when none has come for
// kGaitCommandTimeout.
struct GaitCommand {
  bool walk = false;  // false: stand, the velocities have no meaning
  double forward_m_s = 0;
  double left_m_s = 0;
  double yaw_rate_rad_s = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("walk", self.walk);
    visit("forward_m_s", self.forward_m_s);
    visit("left_m_s", self.left_m_s);
    visit("yaw_rate_rad_s", self.yaw_rate_rad_s);
  }
};

inline constexpr TimeNs kGaitCommandTimeout = milliseconds(100);

// The leg odometry of one control period.
struct GaitSample {
  TimeNs stamp;
  std::uint32_t sequence = 0;
  std::array<double, 3> velocity_B_m_s{};  // of B's origin over the ground, by the feet that stand
  double height_m = 0;                     // B's origin over the feet that stand, along gravity
  bool standing = false;                   // it is up and able to walk
  bool fallen = false;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("stamp_ns", self.stamp);
    visit("sequence", self.sequence);
    visit("velocity_B_m_s", self.velocity_B_m_s);
    visit("height_m", self.height_m);
    visit("standing", self.standing);
    visit("fallen", self.fallen);
  }
};

class GaitPort {
 public:
  // kUnavailable: the body does not listen. Never blocks.
  Status send(const GaitCommand& command) { return do_send(command); }
  // Copies the oldest waiting sample into out. kUnavailable: none, out unchanged. Never blocks.
  Status receive(GaitSample& out) { return do_receive(out); }
  SensorCounters counters() const { return do_counters(); }

 protected:
  ~GaitPort() = default;

 private:
  virtual Status do_send(const GaitCommand& command) = 0;
  virtual Status do_receive(GaitSample& out) = 0;
  virtual SensorCounters do_counters() const = 0;
};

}  // namespace surefoot::hal
