#include "core/autonomy/mission.h"

#include "core/math/elementary.h"

namespace surefoot::autonomy {
namespace {

constexpr double kDriveEnable_s = 1.0;  // drives must answer within this time after the rest
constexpr double kFacingCosine = 0.7;   // looking farther away it turns on the spot: it sees ahead
constexpr double kArrivedHold_s = 0.5;  // standing at the goal before the mission counts as done
constexpr double kComeToRest_s = 4.0;   // braking and the last steps take no longer

}  // namespace

void Mission::reset(const MissionConfig& config, double braking_m_s2) {
  *this = Mission{};
  config_ = config;
  braking_m_s2_ = braking_m_s2;
  begin_line();
}

double Mission::Path::along_m(const estimation::RobotState& state) const {
  return (state.p_OB_m.head<2>() - from_O_m).dot(direction_O);
}

double Mission::Path::left_m(const estimation::RobotState& state) const {
  const Vector2 off = state.p_OB_m.head<2>() - from_O_m;
  return math::cross(direction_O, off);
}

double Mission::Path::to_go_m(const estimation::RobotState& state) const {
  const Vector2 to = from_O_m + direction_O * length_m - state.p_OB_m.head<2>();
  return math::sqrt(to.squaredNorm());
}

// From where the last line ended, or O, to the waypoint ahead or the goal.
void Mission::begin_line() {
  Vector2 to(config_.goal_x_m, 0.0);
  if (!config_.waypoints.empty()) {
    const Waypoint& waypoint = config_.waypoints[waypoint_];
    to = Vector2(waypoint.x_m, waypoint.y_m);
  }
  const Vector2 way = to - path_.from_O_m;
  path_.length_m = math::sqrt(way.squaredNorm());
  if (path_.length_m > 0) path_.direction_O = way / path_.length_m;
  path_.heading_rad = math::atan2(path_.direction_O[1], path_.direction_O[0]);
  stuck_s_ = 0;
  least_to_go_m_ = path_.length_m;
}

// A fall may have ended far off the line: on from there.
void Mission::begin_line_here(const estimation::RobotState& state) {
  fell_ = false;
  path_.from_O_m = state.p_OB_m.head<2>();
  begin_line();
}

// false: that was the last.
bool Mission::next_line() {
  if (waypoint_ + 1 >= config_.waypoints.size()) return false;
  path_.from_O_m += path_.direction_O * path_.length_m;
  ++waypoint_;
  begin_line();
  return true;
}

void Mission::note_progress(double to_go_m, double step_s) {
  constexpr double kProgress_m = 0.05;
  stuck_s_ += step_s;
  if (to_go_m > least_to_go_m_ - kProgress_m) return;
  least_to_go_m_ = to_go_m;
  stuck_s_ = 0;
}

bool Mission::at_end(const estimation::RobotState& state) const {
  if (config_.waypoints.empty()) {
    return path_.along_m(state) >= path_.length_m - config_.goal_tolerance_m;
  }
  return path_.to_go_m(state) <= config_.goal_tolerance_m;
}

void Mission::enter(MissionPhase phase) {
  phase_ = phase;
  phase_s_ = 0;
}

void Mission::stop(StopReason reason) {
  stop_reason_ = reason;
  command_ = control::VelocityCommand{};
  enter(MissionPhase::kStopped);
}

bool Mission::finished() const {
  if (phase_ == MissionPhase::kStopped) return true;
  if (phase_ != MissionPhase::kArrived) return false;
  return rested_s_ >= kArrivedHold_s || phase_s_ >= kComeToRest_s + kArrivedHold_s;
}

void Mission::update(const estimation::RobotState& state, const MissionFacts& facts,
                     double step_s) {
  elapsed_s_ += step_s;
  phase_s_ += step_s;
  if (phase_ == MissionPhase::kStopped) return;
  const bool may_fall = phase_ >= MissionPhase::kStandUp;
  if (config_.recover && may_fall && facts.fallen) {
    fell_ = fell_ || phase_ >= MissionPhase::kSettle;
    return enter(MissionPhase::kRecover);
  }
  if (facts.fault != StopReason::kNone) return stop(facts.fault);
  if (phase_ == MissionPhase::kArrived) {
    rested_s_ = facts.at_rest ? rested_s_ + step_s : 0.0;
    return;
  }
  if (elapsed_s_ >= config_.timeout_s) return stop(StopReason::kMissionTimeout);

  switch (phase_) {
    case MissionPhase::kEnableDrives:
      if (facts.drives_ready && phase_s_ >= config_.rest_s) {
        const bool recover = config_.recover && facts.must_recover;
        return enter(recover ? MissionPhase::kRecover : MissionPhase::kStandUp);
      }
      if (phase_s_ > config_.rest_s + kDriveEnable_s) return stop(StopReason::kDriveSilent);
      break;
    case MissionPhase::kRecover:
      if (facts.recovery_failed) return stop(StopReason::kRecoveryFailed);
      if (facts.recovered) return enter(MissionPhase::kStandUp);
      break;
    case MissionPhase::kStandUp:
      if (facts.stand_up_done) return enter(MissionPhase::kSettle);
      break;
    case MissionPhase::kSettle: {
      const bool stand = config_.kind == MissionConfig::Kind::kStand;
      if (stand && phase_s_ >= config_.stand_s) return enter(MissionPhase::kArrived);
      if (stand || phase_s_ < config_.settle_s) break;
      gait_ = config_.gait;
      if (fell_) begin_line_here(state);
      return enter(MissionPhase::kWalk);
    }
    case MissionPhase::kWalk:
      if (facts.jump_refused) return stop(StopReason::kNoJump);
      if (config_.kind == MissionConfig::Kind::kScript) return follow_script(state, step_s);
      if (config_.kind == MissionConfig::Kind::kNavigate) return navigate(facts);
      return cross(state, step_s);
    case MissionPhase::kArrived:
    case MissionPhase::kStopped: break;
  }
}

void Mission::arrive() {
  command_ = control::VelocityCommand{};
  rested_s_ = 0;
  enter(MissionPhase::kArrived);
}

// What ends it short of the goal comes as a fault.
void Mission::navigate(const MissionFacts& facts) {
  if (facts.at_goal) return arrive();
  command_ = facts.navigation;
}

// Along the line in hand to its end, then the next.
void Mission::cross(const estimation::RobotState& state, double step_s) {
  if (at_end(state) && !next_line()) return arrive();
  note_progress(path_.to_go_m(state), step_s);
  if (config_.live_lock_s > 0 && stuck_s_ >= config_.live_lock_s) {
    return stop(StopReason::kLiveLock);
  }
  const double sideways = math::clamp(-config_.line_gain_1_s * path_.left_m(state),
                                      -config_.max_lateral_m_s, config_.max_lateral_m_s);
  // A goal is a line to cross, a waypoint a place to reach.
  double along_m_s = approach_speed_m_s(path_.length_m - path_.along_m(state));
  if (!config_.waypoints.empty()) {
    along_m_s = math::clamp(config_.line_gain_1_s * (path_.length_m - path_.along_m(state)),
                            -config_.max_lateral_m_s, config_.speed_m_s);
  }
  // The command is in the body's heading: turn the wanted velocity of the line into it.
  const math::SinCos yaw = math::sin_cos(math::wrap_angle(state.yaw_rad - path_.heading_rad));
  command_.forward_m_s = yaw.cos * along_m_s + yaw.sin * sideways;
  command_.left_m_s = yaw.cos * sideways - yaw.sin * along_m_s;
  command_.yaw_rate_rad_s = turn_towards(state, path_.heading_rad);
  if (yaw.cos >= kFacingCosine) return;
  command_.forward_m_s = 0.0;
  command_.left_m_s = 0.0;
}

// From which the robot comes to a stand at the goal.
double Mission::approach_speed_m_s(double left_m) const {
  if (braking_m_s2_ <= 0) return config_.speed_m_s;
  const double limit_m_s = math::sqrt(2.0 * braking_m_s2_ * math::clamp(left_m, 0.0, 1e3));
  return math::clamp(limit_m_s, 0.0, config_.speed_m_s);
}

double Mission::turn_towards(const estimation::RobotState& state, double heading_rad) const {
  const double error = math::wrap_angle(heading_rad - state.yaw_rad);
  return math::clamp(config_.heading_gain_1_s * error, -config_.max_yaw_rate_rad_s,
                     config_.max_yaw_rate_rad_s);
}

// The command of the line in hand; the heading is what the commanded turns add up to.
void Mission::follow_script(const estimation::RobotState& state, double step_s) {
  while (script_step_ < config_.script.size() &&
         script_s_ >= config_.script[script_step_].duration_s) {
    script_s_ -= config_.script[script_step_].duration_s;
    ++script_step_;
  }
  if (script_step_ >= config_.script.size()) return arrive();
  const ScriptStep& line = config_.script[script_step_];
  script_s_ += step_s;
  gait_ = line.gait;
  heading_rad_ = math::wrap_angle(heading_rad_ + line.yaw_rate_rad_s * step_s);
  command_.forward_m_s = line.forward_m_s;
  command_.left_m_s = line.left_m_s;
  command_.yaw_rate_rad_s = line.yaw_rate_rad_s + turn_towards(state, heading_rad_);
}

}  // namespace surefoot::autonomy
