// The backends of the host against the rules of the HAL interfaces.
#include <gtest/gtest.h>

#include "hal/linux/clocks.h"
#include "tests/conformance/clock_rules.h"

namespace surefoot::conformance {
namespace {

TEST(Linux, MonotonicClockKeepsTheRules) {
  hal::MonotonicClock clock;
  const ClockBench bench{.clock = &clock,
                         .period = milliseconds(5),
                         .ticks = 10,
                         .allowed_overshoot = milliseconds(2000)};  // a build machine may be busy
  EXPECT_EQ(joined(clock_violations(bench)), "");
}

}  // namespace
}  // namespace surefoot::conformance
