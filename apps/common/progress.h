// One line about a run under way, on standard error: rewritten in place on a terminal, a new line
// per second of real time elsewhere. Allocates nothing.
#pragma once

#include <chrono>

#include "core/autonomy/tick.h"
#include "core/base/time.h"

namespace surefoot::apps {

const char* to_string(autonomy::MissionPhase phase);

class Progress {
 public:
  explicit Progress(bool quiet);
  void update(TimeNs now, const autonomy::Telemetry& telemetry);
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  bool quiet_;
  bool terminal_;
  bool written_ = false;
  Clock::time_point begin_;
  Clock::time_point next_;
};

}  // namespace surefoot::apps
