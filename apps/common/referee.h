// Judges a run. In simulation from the ground truth, which nothing else may look at; on a robot
// from what the autonomy itself reports.
#pragma once

#include <cstdint>
#include <string>

#include "apps/common/run_log.h"
#include "core/autonomy/tick.h"

namespace surefoot::apps {

enum class Outcome : std::uint8_t {
  kGoal = 0,
  kFall,
  kCollision,
  kLiveLock,
  kNoPath,
  kTimeout,
  kFault,
  kAborted,
};
const char* to_string(Outcome outcome);  // the words of summary.json
int exit_code(Outcome outcome);          // 0 goal, 3 fault, 1 else

const char* describe(autonomy::StopReason reason);

struct RefereeRules {
  bool has_truth = true;
  bool has_goal = true;              // false: mission stand, where staying up is the goal
  double goal_x_m = 3.0;             // W, on y = 0
  double goal_tolerance_m = 0.2;     // of the true body at the end
  double lane_half_width_m = 0;      // 0: no lane
  double fall_tilt_rad = 1.0471976;  // 60 degrees
  double fall_contact_s = 0.2;       // trunk on the ground without a break
  bool may_recover = false;          // a fall is counted and the run goes on
};

struct Verdict {
  Outcome outcome = Outcome::kAborted;
  std::string reason;
};

class Referee {
 public:
  explicit Referee(const RefereeRules& rules) : rules_(rules) {}

  // Every sample of a run, in order.
  void observe(TimeNs stamp, const autonomy::Telemetry& telemetry, const sim::Truth& truth);
  // A fall that ends the mission or a line crossed: the run ends here.
  bool over() const { return over_; }
  int falls() const { return falls_; }
  // After the last sample.
  Verdict verdict() const;

 private:
  void fall(std::string reason);
  void end(Outcome outcome, std::string reason);
  Verdict verdict_at_goal() const;

  RefereeRules rules_;
  bool over_ = false;
  int falls_ = 0;
  Verdict ended_;
  bool was_up_ = false;   // the robot stood: before that the trunk lies on the ground
  bool is_down_ = false;  // fell, and has not stood up again
  std::string fall_reason_;
  bool trunk_down_ = false;
  TimeNs trunk_down_since_;
  autonomy::MissionPhase phase_ = autonomy::MissionPhase::kEnableDrives;
  autonomy::StopReason stop_reason_ = autonomy::StopReason::kNone;
  std::array<double, 3> p_WB_m_{};
};

}  // namespace surefoot::apps
