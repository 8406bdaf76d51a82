#include "apps/common/referee.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace surefoot::apps {

using autonomy::MissionPhase;
using autonomy::StopReason;

const char* to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::kGoal: return "goal";
    case Outcome::kFall: return "fall";
    case Outcome::kCollision: return "collision";
    case Outcome::kLiveLock: return "live_lock";
    case Outcome::kNoPath: return "no_path";
    case Outcome::kTimeout: return "timeout";
    case Outcome::kFault: return "fault";
    case Outcome::kAborted: return "aborted";
  }
  return "aborted";
}

int exit_code(Outcome outcome) {
  if (outcome == Outcome::kGoal) return 0;
  return outcome == Outcome::kFault ? 3 : 1;
}

const char* describe(StopReason reason) {
  switch (reason) {
    case StopReason::kNone: return "";
    case StopReason::kNoFoothold: return "no foothold within a leg's reach for too long";
    case StopReason::kDriveSilent: return "a drive stopped answering";
    case StopReason::kTilt: return "the robot felt itself tilt beyond recovery";
    case StopReason::kImuSilent: return "the IMU stopped answering";
    case StopReason::kOperator: return "emergency stop by the operator";
    case StopReason::kMissionTimeout: return "the mission's time is over";
    case StopReason::kDriveFault: return "a drive reported an error";
    case StopReason::kRecoveryFailed: return "fell, and no roll brought it back on its belly";
    case StopReason::kLiveLock: return "walks without getting nearer to its goal";
    case StopReason::kNoPath: return "no way to the goal is left open";
    case StopReason::kNoJump: return "an edge ahead, and the jump was refused";
  }
  return "";
}

namespace {

Outcome outcome_of(StopReason reason) {
  switch (reason) {
    case StopReason::kNoJump:
    case StopReason::kNoPath:
    case StopReason::kNoFoothold: return Outcome::kNoPath;
    case StopReason::kMissionTimeout: return Outcome::kTimeout;
    case StopReason::kLiveLock: return Outcome::kLiveLock;
    case StopReason::kTilt:
    case StopReason::kRecoveryFailed: return Outcome::kFall;
    case StopReason::kDriveSilent:
    case StopReason::kImuSilent:
    case StopReason::kDriveFault: return Outcome::kFault;
    case StopReason::kNone:
    case StopReason::kOperator: break;
  }
  return Outcome::kAborted;
}

}  // namespace

void Referee::end(Outcome outcome, std::string reason) {
  if (over_) return;
  over_ = true;
  if (outcome == Outcome::kFall) ++falls_;
  ended_ = {outcome, std::move(reason)};
}

// Where the robot may get up again, each fall from standing counts once.
void Referee::fall(std::string reason) {
  if (!rules_.may_recover) return end(Outcome::kFall, std::move(reason));
  if (!was_up_) return;
  ++falls_;
  was_up_ = false;
  is_down_ = true;
  fall_reason_ = std::move(reason);
}

void Referee::observe(TimeNs stamp, const autonomy::Telemetry& telemetry, const sim::Truth& truth) {
  phase_ = telemetry.phase;
  stop_reason_ = telemetry.stop_reason;
  p_WB_m_ = truth.p_WB_m;
  if (phase_ == MissionPhase::kRecover || phase_ == MissionPhase::kStandUp) is_down_ = false;
  const bool on_feet = phase_ >= MissionPhase::kSettle && phase_ <= MissionPhase::kArrived;
  was_up_ = was_up_ || (on_feet && !is_down_);
  if (!on_feet && rules_.may_recover) {
    if (phase_ == MissionPhase::kRecover && was_up_) ++falls_;  // it noticed first
    was_up_ = false;
  }
  if (phase_ == MissionPhase::kStopped && stop_reason_ == StopReason::kTilt) {
    end(Outcome::kFall, describe(stop_reason_));
  }
  // A robot that stopped by itself lies down on purpose: what follows is not a fall.
  if (!rules_.has_truth || phase_ == MissionPhase::kStopped) return;
  if (truth.obstacle_steps > 0) {
    end(Outcome::kCollision,
        fmt::format("touched the obstacle at x = {:.2f} m, y = {:.2f} m", p_WB_m_[0], p_WB_m_[1]));
  }
  const double tilt = tilt_of(truth.q_WB_wxyz);
  if (tilt > rules_.fall_tilt_rad) {
    fall(fmt::format("tilted {:.0f} degrees at x = {:.2f} m", tilt * 57.29578, p_WB_m_[0]));
  }
  if (!was_up_) return;
  if (truth.trunk_contact && !trunk_down_) trunk_down_since_ = stamp;
  trunk_down_ = truth.trunk_contact;
  if (trunk_down_ && (stamp - trunk_down_since_).seconds() >= rules_.fall_contact_s) {
    fall(fmt::format("trunk on the ground at x = {:.2f} m", p_WB_m_[0]));
  }
  if (rules_.lane_half_width_m > 0 && std::fabs(p_WB_m_[1]) > rules_.lane_half_width_m) {
    end(Outcome::kAborted, fmt::format("left the lane at x = {:.2f} m", p_WB_m_[0]));
  }
}

Verdict Referee::verdict_at_goal() const {
  if (!rules_.has_truth || !rules_.has_goal) return {Outcome::kGoal, "the robot says it arrived"};
  const double off = std::hypot(p_WB_m_[0] - rules_.goal_x_m, p_WB_m_[1]);
  if (off <= rules_.goal_tolerance_m) {
    return {Outcome::kGoal, fmt::format("stands {:.2f} m from the goal", off)};
  }
  return {Outcome::kAborted,
          fmt::format("believes it arrived, stands {:.2f} m from the goal (allowed: {:.2f} m)", off,
                      rules_.goal_tolerance_m)};
}

Verdict Referee::verdict() const {
  if (over_) return ended_;
  if (is_down_) return {Outcome::kFall, fall_reason_ + ", and did not notice"};
  if (phase_ == MissionPhase::kStopped) return {outcome_of(stop_reason_), describe(stop_reason_)};
  if (phase_ == MissionPhase::kArrived) return verdict_at_goal();
  return {Outcome::kAborted, "the run ended before the mission did"};
}

}  // namespace surefoot::apps
