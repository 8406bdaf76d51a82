// Assertion of what only a programming error can break. On in every build: a robot that computes on
// after a broken invariant is more dangerous than one whose drives time out (25 ms) and go limp.
#pragma once

namespace surefoot {

// Supplied by the program (hal/linux on Linux, the start-up code on a microcontroller). Must not
// return: it reports where, and stops the process, upon which the drives' own time-out damps the
// legs.
[[noreturn]] void assertion_failed(const char* file, int line, const char* expression);

}  // namespace surefoot

#define SUREFOOT_ASSERT(condition)    \
  ((condition) ? static_cast<void>(0) \
               : ::surefoot::assertion_failed(__FILE__, __LINE__, #condition))
