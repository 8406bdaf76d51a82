// Counts what must not happen after start-up: heap calls and page faults of the present thread.
//
// The malloc family is interposed by this library and forwards to the C library. Counting costs one
// thread-local test per call and is off until armed. In a build with AddressSanitizer the
// interposition is left out, since the sanitizer has its own: counts then stay 0 and
// heap_counting_available() says so.
//
// For debugging: with SUREFOOT_HEAP_TRAP=1 in the environment when the program starts, the first
// heap call under guard prints a backtrace and aborts.
#pragma once

#include <cstdint>

#include "core/runtime/executive.h"

namespace surefoot::hal {

struct MemoryCounts {
  std::uint64_t heap_calls =
      0;  // malloc, calloc, realloc, memalign and relatives, free of non-null
  std::uint64_t page_faults = 0;  // minor and major
};

bool heap_counting_available();

// Sums what happens on one thread between arm() and disarm(). Not nested, not shared by threads.
class MemoryGuard {
 public:
  void arm();
  void disarm();
  bool armed() const { return armed_; }
  // Of all armed periods so far.
  const MemoryCounts& counts() const { return counts_; }

 private:
  bool armed_ = false;
  MemoryCounts at_arm_;
  MemoryCounts counts_;
};

// Arms for a scope.
class ScopedMemoryGuard {
 public:
  explicit ScopedMemoryGuard(MemoryGuard& guard) : guard_(guard) { guard_.arm(); }
  ~ScopedMemoryGuard() { guard_.disarm(); }
  ScopedMemoryGuard(const ScopedMemoryGuard&) = delete;
  ScopedMemoryGuard& operator=(const ScopedMemoryGuard&) = delete;

 private:
  MemoryGuard& guard_;
};

// Guards every tick body of an executive, so that a simulator that runs inside Clock::wait_until()
// on the same thread is not counted. The first `warm_up_ticks` bodies are start-up and are not
// counted: they touch every page and fault in code.
class TickMemoryGuard final : public runtime::TickObserver {
 public:
  explicit TickMemoryGuard(std::uint64_t warm_up_ticks) : remaining_(warm_up_ticks) {}
  const MemoryCounts& counts() const { return guard_.counts(); }
  std::uint64_t guarded_ticks() const { return guarded_; }

 private:
  void do_begin_tick_body() override;
  void do_end_tick_body() override;

  std::uint64_t remaining_;
  std::uint64_t guarded_ = 0;
  MemoryGuard guard_;
};

}  // namespace surefoot::hal
