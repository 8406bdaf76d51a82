// CLOCK_MONOTONIC as a hal::Clock. Used as the tick clock on the robot and as the stopwatch
// everywhere.
#pragma once

#include "core/base/status.h"
#include "core/base/time.h"
#include "hal/api/clock.h"

namespace surefoot::hal {

class MonotonicClock final : public Clock {
 public:
  MonotonicClock();  // now() counts from here

 private:
  TimeNs do_now() const override;
  // clock_nanosleep to the absolute time, restarted after signals.
  Status do_wait_until(TimeNs deadline) override;

  TimeNs origin_;
};

}  // namespace surefoot::hal
