// How long work takes, by the processor's time of this thread: what other programs take of a shared
// machine does not count, as far as caches and clock rates are not theirs too.
#pragma once

#include <ctime>

namespace surefoot::apps {

inline double processor_us() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

template <class Work>
double time_us(Work&& work) {
  const double begin_us = processor_us();
  work();
  return processor_us() - begin_us;
}

}  // namespace surefoot::apps
