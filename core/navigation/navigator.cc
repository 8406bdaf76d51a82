#include "core/navigation/navigator.h"

#include "core/math/elementary.h"

namespace surefoot::navigation {
namespace {

constexpr TimeNs kTrailStep = milliseconds(100);

NavigationReason reason_of(SpeedReason reason) {
  switch (reason) {
    case SpeedReason::kNone: return NavigationReason::kNone;
    case SpeedReason::kNoPath: return NavigationReason::kNoPlanYet;
    case SpeedReason::kTurning: return NavigationReason::kTurning;
    case SpeedReason::kCurve: return NavigationReason::kCurve;
    case SpeedReason::kBlocked: return NavigationReason::kBlocked;
    case SpeedReason::kWalker: return NavigationReason::kWalker;
    case SpeedReason::kAside: return NavigationReason::kAside;
    case SpeedReason::kEnd: return NavigationReason::kEnd;
  }
  return NavigationReason::kNone;
}

}  // namespace

Status Navigator::reset(const NavigationConfig& config) {
  RangeCheck check;
  NavigationConfig::describe(config, check);
  if (!check.good || config.follow.far_m <= config.follow.near_m) return Status::kInvalid;
  config_ = config;
  status_ = {};
  goal_number_ = 0;
  planned_number_ = 0;
  trail_.clear();
  released_ = false;
  planner_.reset(config);
  for (Plan& plan : plans_) plan.path.clear();
  shown_ = 0;
  follower_.reset(config);
  return Status::kOk;
}

void Navigator::stop(NavigationState state, NavigationReason reason) {
  status_.state = state;
  status_.reason = reason;
  plans_[shown_].path.clear();
  follower_.set_path(nullptr);
}

Status Navigator::set_goal(const Vector2& goal_O_m) {
  for (const double x : {goal_O_m[0], goal_O_m[1]}) {
    if (!math::is_finite(x)) return Status::kInvalid;
    if (math::magnitude(x) > kMaxGoal_m) return Status::kOutOfRange;
  }
  goal_O_m_ = goal_O_m;
  ++goal_number_;
  stop(NavigationState::kGoing, NavigationReason::kNoPlanYet);
  return Status::kOk;
}

void Navigator::clear_goal() { stop(NavigationState::kIdle, NavigationReason::kNoGoal); }

void Navigator::remember(const RobotPose& robot, TimeNs stamp) {
  if (!trail_.empty() && stamp < trail_.back().stamp + kTrailStep) return;
  trail_.push_overwrite({stamp, robot.p_O_m});
}

// The newest pose that is old enough; else the oldest.
Vector2 Navigator::past_O_m(const RobotPose& robot, TimeNs stamp) const {
  Vector2 past_O_m = trail_.empty() ? robot.p_O_m : trail_.front().p_O_m;
  for (std::size_t i = 0; i < trail_.size(); ++i) {
    if ((stamp - trail_[i].stamp).seconds() < config_.shape.behind_s) break;
    past_O_m = trail_[i].p_O_m;
  }
  return past_O_m;
}

bool Navigator::release(const objects::Objects& objects, const RobotPose& robot, TimeNs stamp) {
  released_ = status_.state == NavigationState::kGoing || status_.state == NavigationState::kNoPath;
  if (!released_) return false;
  input_.goal_O_m = goal_O_m_;
  input_.goal_number = goal_number_;
  input_.robot = robot;
  input_.past_O_m = past_O_m(robot, stamp);
  input_.stamp = stamp;
  objects::assign(input_.objects, objects);
  return true;
}

void Navigator::run() {
  if (!released_) return;
  if (planned_number_ != input_.goal_number) planner_.forget();
  planned_number_ = input_.goal_number;
  planner_.run(input_, plans_[1 - shown_]);
}

void Navigator::publish() {
  if (!released_) return;
  released_ = false;
  const Plan& plan = plans_[1 - shown_];
  const bool wanted =
      plan.goal_number == goal_number_ &&
      (status_.state == NavigationState::kGoing || status_.state == NavigationState::kNoPath);
  if (!wanted) {
    ++status_.counters.plans_dropped;
    return;
  }
  ++status_.counters.plans;
  if (plan.outcome == PlanOutcome::kPartial) ++status_.counters.plans_partial;
  if (plan.smoothing.raw) ++status_.counters.plans_raw;
  shown_ = 1 - shown_;
  status_.rest_m = plan.rest_m;
  if (plan.live_lock) return stop(NavigationState::kLiveLock, NavigationReason::kNoProgress);
  follower_.set_path(&plans_[shown_].path);
  const bool goal = plan.outcome == PlanOutcome::kGoalEnclosed;
  const bool enclosed = goal || plan.outcome == PlanOutcome::kRobotEnclosed;
  if (enclosed) ++status_.counters.plans_enclosed;
  if (plan.enclosed) {
    return stop(NavigationState::kNoPath,
                goal ? NavigationReason::kGoalEnclosed : NavigationReason::kRobotEnclosed);
  }
  status_.state = NavigationState::kGoing;
}

void Navigator::plan(const objects::Objects& objects, const RobotPose& robot, TimeNs stamp) {
  if (!release(objects, robot, stamp)) return;
  run();
  publish();
}

bool Navigator::arrived(const RobotPose& robot) const {
  const double within2 = math::square(config_.follow.arrive_m);
  if ((robot.p_O_m - goal_O_m_).squaredNorm() <= within2) return true;
  const Plan& plan = plans_[shown_];
  return plan.to_goal && !plan.path.empty() &&
         (robot.p_O_m - plan.path.back().p_O_m).squaredNorm() <= within2;
}

void Navigator::explain() {
  if (status_.state != NavigationState::kGoing) return;
  const Plan& plan = plans_[shown_];
  const bool failed = plan.path.empty() && plan.goal_number == goal_number_;
  status_.reason = reason_of(follower_.reason());
  if (!failed || status_.reason != NavigationReason::kNoPlanYet) return;
  if (plan.outcome == PlanOutcome::kRobotEnclosed)
    status_.reason = NavigationReason::kRobotEnclosed;
  if (plan.outcome == PlanOutcome::kGoalEnclosed) status_.reason = NavigationReason::kGoalEnclosed;
}

VelocityCommand Navigator::follow(const RobotPose& robot, const objects::Objects& objects,
                                  TimeNs stamp) {
  remember(robot, stamp);
  if (status_.state == NavigationState::kGoing && arrived(robot)) {
    stop(NavigationState::kArrived, NavigationReason::kArrived);
  }
  const bool was_aside = follower_.reason() == SpeedReason::kAside;
  const VelocityCommand command = follower_.follow(robot, objects, stamp);
  if (!was_aside && follower_.reason() == SpeedReason::kAside) ++status_.counters.steps_aside;
  explain();
  status_.off_path_m = follower_.off_path_m();
  status_.free_m = follower_.free_m();
  return command;
}

}  // namespace surefoot::navigation
