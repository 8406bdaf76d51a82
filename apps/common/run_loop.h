// The loop of a run: ticks, and between them samples for the log and the referee.
#pragma once

#include <string>

#include "apps/common/backend.h"
#include "apps/common/plan_log.h"
#include "apps/common/progress.h"
#include "apps/common/referee.h"
#include "apps/common/run_log.h"
#include "apps/common/stack.h"
#include "hal/linux/clocks.h"

namespace surefoot::apps {

struct LoopResult {
  double wall_time_s = 0;
  bool interrupted = false;     // SIGINT or SIGTERM
  Status status = Status::kOk;  // other than kOk: the clock ended the run
};

// Who looks on between the ticks.
struct RunWatchers {
  RunLog& log;
  PlanLog& plans;
  Referee& referee;
  Progress& progress;
};

// Runs until the mission is over, the referee ends it, a signal comes or `max_ticks` are done.
// Allocates for the logs, between ticks. SIGINT and SIGTERM must be blocked (block_signals).
LoopResult run_loop(Stack& stack, const Backend& backend, const RunWatchers& watchers,
                    std::uint64_t max_ticks, bool realtime);

// So that the loop can ask for SIGINT and SIGTERM instead of being torn out of a tick by them.
void block_signals();

}  // namespace surefoot::apps
