// Time, for the executive alone. Nothing in core but runtime/executive sees this interface.
#pragma once

#include "core/base/status.h"
#include "core/base/time.h"

namespace surefoot::hal {

class Clock {
 public:
  // Monotonic time since the clock's start.
  TimeNs now() const { return do_now(); }
  // Returns when now() >= deadline. kTimeout: the deadline had passed already when called (a late
  // tick). kEndOfData: a recorded or finished source has no further ticks.
  Status wait_until(TimeNs deadline) { return do_wait_until(deadline); }

 protected:
  ~Clock() = default;

 private:
  virtual TimeNs do_now() const = 0;
  virtual Status do_wait_until(TimeNs deadline) = 0;
};

}  // namespace surefoot::hal
