#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <vector>

#include "core/base/assert.h"
#include "hal/linux/clocks.h"
#include "hal/linux/memory_lock.h"

namespace surefoot::hal {
namespace {

TEST(MonotonicClock, WaitsUntilTheDeadlineAndSaysWhenItHasPassed) {
  MonotonicClock clock;
  const TimeNs before = clock.now();
  EXPECT_GE(before.ns, 0);
  EXPECT_EQ(clock.wait_until(before + milliseconds(5)), Status::kOk);
  EXPECT_GE(clock.now(), before + milliseconds(5));
  const TimeNs late = clock.now();
  EXPECT_EQ(clock.wait_until(before), Status::kTimeout);
  EXPECT_LT(clock.now() - late, milliseconds(1000));
}

TEST(MemoryLock, SaysWhatWasGranted) {
  const MemoryLockReport report = lock_memory();
  EXPECT_FALSE(report.note.empty());
  EXPECT_GT(report.stack_bytes, 0u);
  EXPECT_TRUE(report.locked || report.populated_bytes > 0) << report.note;
}

TEST(AssertionDeathTest, NamesThePlaceAndStops) {
  EXPECT_DEATH(SUREFOOT_ASSERT(1 + 1 == 3), "linux_test.cc:[0-9]+: assertion failed: 1 \\+ 1 == 3");
}

}  // namespace
}  // namespace surefoot::hal
