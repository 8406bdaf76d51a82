// The human: gamepad, telemetry link or a scripted mission.
#pragma once

#include <cstdint>

#include "core/base/status.h"
#include "core/base/time.h"
#include "hal/api/sensor_counters.h"

namespace surefoot::hal {

struct OperatorCommand {
  TimeNs stamp;
  std::uint32_t sequence = 0;
  bool armed = false;           // false: the robot lies down and disables its drives
  bool emergency_stop = false;  // latched by the robot until it is restarted
  double forward_m_s = 0;       // body x
  double left_m_s = 0;          // body y
  double yaw_rate_rad_s = 0;    // about body z, counter-clockwise

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("stamp_ns", self.stamp);
    visit("sequence", self.sequence);
    visit("armed", self.armed);
    visit("emergency_stop", self.emergency_stop);
    visit("forward_m_s", self.forward_m_s);
    visit("left_m_s", self.left_m_s);
    visit("yaw_rate_rad_s", self.yaw_rate_rad_s);
  }
};

class OperatorPort {
 public:
  // Copies the newest command not yet delivered into out; older ones are dropped and counted.
  // kUnavailable: nothing new, out unchanged. Never blocks.
  Status receive(OperatorCommand& out) { return do_receive(out); }
  SensorCounters counters() const { return do_counters(); }

 protected:
  ~OperatorPort() = default;

 private:
  virtual Status do_receive(OperatorCommand& out) = 0;
  virtual SensorCounters do_counters() const = 0;
};

}  // namespace surefoot::hal
