#include "apps/common/progress.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace surefoot::apps {

const char* to_string(autonomy::MissionPhase phase) {
  switch (phase) {
    case autonomy::MissionPhase::kEnableDrives: return "enable drives";
    case autonomy::MissionPhase::kRecover: return "recover";
    case autonomy::MissionPhase::kStandUp: return "stand up";
    case autonomy::MissionPhase::kSettle: return "settle";
    case autonomy::MissionPhase::kWalk: return "walk";
    case autonomy::MissionPhase::kArrived: return "arrived";
    case autonomy::MissionPhase::kStopped: return "stopped";
  }
  return "";
}

Progress::Progress(bool quiet)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1), begin_(Clock::now()), next_(begin_) {}

void Progress::update(TimeNs now, const autonomy::Telemetry& telemetry) {
  if (quiet_) return;
  const Clock::time_point present = Clock::now();
  if (present < next_) return;
  next_ = present + (terminal_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(1000));
  const double wall_s = std::chrono::duration<double>(present - begin_).count();
  const double speed = std::hypot(telemetry.v_OB_m_s[0], telemetry.v_OB_m_s[1]);
  std::fprintf(stderr, "%s%6.1f s  x %5.2f m  %4.2f m/s  %-13s  %4.1f x real time%s",
               terminal_ ? "\r" : "", now.seconds(), telemetry.p_OB_m[0], speed,
               to_string(telemetry.phase), wall_s > 0 ? now.seconds() / wall_s : 0.0,
               terminal_ ? "" : "\n");
  std::fflush(stderr);
  written_ = true;
}

void Progress::finish() {
  if (terminal_ && written_) std::fputs("\n", stderr);
}

}  // namespace surefoot::apps
