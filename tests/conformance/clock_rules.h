// The rules of hal/api/clock.h, once for all backends.
//
//   CLOCK-MONOTONIC  now() never goes back
//   CLOCK-WAIT       kOk only when now() has reached the deadline, and not far beyond it
//   CLOCK-LATE       a deadline that has passed is kTimeout at once
//   CLOCK-END        after kEndOfData every wait ends so, and time stands still
//   CLOCK-STATUS     no other status
#pragma once

#include "hal/api/clock.h"
#include "tests/conformance/violations.h"

namespace surefoot::conformance {

struct ClockBench {
  hal::Clock* clock = nullptr;
  TimeNs period;              // of the ticks waited for
  int ticks = 20;             // to wait for; recorded sources may end earlier
  TimeNs allowed_overshoot;   // of kOk beyond the deadline: scheduling on a busy host
  bool asks_for_late = true;  // false: a recorded source decides itself which ticks were late
};

Violations clock_violations(const ClockBench& bench);

}  // namespace surefoot::conformance
