#include "apps/common/run_loop.h"

#include <csignal>
#include <ctime>

namespace surefoot::apps {
namespace {

sigset_t end_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

bool asked_to_end() {
  const sigset_t set = end_signals();
  const timespec at_once{};
  return sigtimedwait(&set, nullptr, &at_once) > 0;
}

}  // namespace

void block_signals() {
  const sigset_t set = end_signals();
  sigprocmask(SIG_BLOCK, &set, nullptr);
}

LoopResult run_loop(Stack& stack, const Backend& backend, const RunWatchers& watchers,
                    std::uint64_t max_ticks, bool realtime) {
  LoopResult result;
  hal::MonotonicClock wall;
  runtime::Executive& executive = stack.executive();
  while (executive.ticks() < max_ticks) {
    result.status = executive.run_tick();
    if (!ok(result.status)) break;
    const autonomy::Telemetry& telemetry = executive.outputs().telemetry;
    const bool finished = stack.autonomy().finished();
    watchers.plans.observe(executive.inputs().stamp, stack.autonomy());
    if (executive.ticks() % kTicksPerSample == 0 || finished) {
      const TimeNs now = executive.inputs().stamp;
      const sim::Truth truth = backend.truth();
      watchers.log.add(now, telemetry, backend.has_truth() ? &truth : nullptr);
      watchers.referee.observe(now, telemetry, truth);
      watchers.progress.update(now, telemetry);
      result.interrupted = asked_to_end();
      if (realtime) static_cast<void>(wall.wait_until(now));
    }
    if (finished || watchers.referee.over() || result.interrupted) break;
  }
  result.wall_time_s = wall.now().seconds();
  return result;
}

}  // namespace surefoot::apps
