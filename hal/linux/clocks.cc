#include "hal/linux/clocks.h"

#include <cerrno>
#include <ctime>

namespace surefoot::hal {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

TimeNs monotonic() {
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return {static_cast<std::int64_t>(time.tv_sec) * kNsPerSecond + time.tv_nsec};
}

}  // namespace

MonotonicClock::MonotonicClock() : origin_(monotonic()) {}

TimeNs MonotonicClock::do_now() const { return monotonic() - origin_; }

Status MonotonicClock::do_wait_until(TimeNs deadline) {
  const TimeNs absolute = deadline + origin_;
  if (monotonic() > absolute) return Status::kTimeout;
  timespec time{};
  time.tv_sec = static_cast<time_t>(absolute.ns / kNsPerSecond);
  time.tv_nsec = static_cast<long>(absolute.ns % kNsPerSecond);
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
  return Status::kOk;
}

}  // namespace surefoot::hal
