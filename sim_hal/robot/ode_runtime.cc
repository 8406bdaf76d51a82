#include "sim_hal/robot/ode_runtime.h"

#include <ode/ode.h>

#include <atomic>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

#include "sim_hal/simulator_error.h"

namespace surefoot::sim {

namespace {

// ODE's handlers are plain functions: the count cannot live in an object of ours.
std::atomic<std::uint64_t>& message_count() {
  static std::atomic<std::uint64_t> count{0};
  return count;
}

void on_message(int number, const char* text, va_list arguments) {
  if (message_count().fetch_add(1) < 10) {  // the first few in full, the rest only counted
    std::fprintf(stderr, "ODE message %d: ", number);
    std::vfprintf(stderr, text, arguments);
    std::fputc('\n', stderr);
  }
}

// After an error or a failed assertion inside ODE its state is undefined: stop here.
[[noreturn]] void on_error(int number, const char* text, va_list arguments) {
  std::fprintf(stderr, "ODE error %d: ", number);
  std::vfprintf(stderr, text, arguments);
  std::fputc('\n', stderr);
  std::abort();
}

bool initialise() {
  dInitODE2(0);
  dSetMessageHandler(&on_message);
  dSetErrorHandler(&on_error);
  dSetDebugHandler(&on_error);
  return dCheckConfiguration("ODE_double_precision") != 0;
}

}  // namespace

void start_ode() {
  static const bool double_precision = initialise();
  if (!double_precision) throw SimulatorError("ODE is not built for double precision");
  dAllocateODEDataForThread(static_cast<unsigned int>(dAllocateMaskAll));
}

std::uint64_t ode_messages() { return message_count().load(); }

}  // namespace surefoot::sim
