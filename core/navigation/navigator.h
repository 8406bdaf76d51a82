// Navigation as the autonomy sees it: a goal in, a velocity command out.
//
//   each tick                 follow()
//   about once a second       release(), run(), publish(): a slow task with logical execution time.
//                             release() copies all that run() reads; run() touches nothing that
//                             follow() reads; publish() shows the result at a fixed later tick.
//                             plan() does all three at once, for tests and for tools.
//
// set_goal() may come between release and publish: what was planned for another goal is dropped.
// Frame: O. Stamps must not fall. Memory: about 9 MB, static; no heap.
// Errors: reset() kInvalid: configuration out of its domain, nothing changed. set_goal() kInvalid:
// not finite; kOutOfRange: beyond kMaxGoal_m; the goal before stays.
#pragma once

#include <array>

#include "core/base/ring_buffer.h"
#include "core/base/status.h"
#include "core/navigation/config.h"
#include "core/navigation/path_follower.h"
#include "core/navigation/planner.h"
#include "core/navigation/types.h"
#include "core/objects/object.h"

namespace surefoot::navigation {

enum class NavigationState : std::uint8_t { kIdle = 0, kGoing, kArrived, kNoPath, kLiveLock };

// Why the robot does not walk as fast as it could, or at all.
enum class NavigationReason : std::uint8_t {
  kNone = 0,
  kNoGoal,
  kNoPlanYet,
  kRobotEnclosed,
  kGoalEnclosed,
  kNoProgress,
  kTurning,
  kCurve,
  kBlocked,
  kWalker,
  kAside,
  kEnd,
  kArrived,
};

constexpr const char* to_string(NavigationReason reason) {
  constexpr std::array<const char*, 13> kNames{
      "none",        "no goal",     "no plan yet", "robot enclosed", "goal enclosed",
      "no progress", "turning",     "curve",       "blocked",        "walker",
      "step aside",  "end of path", "arrived"};
  return kNames[static_cast<std::size_t>(reason)];
}

struct NavigationCounters {
  std::uint64_t plans = 0;
  std::uint64_t plans_partial = 0;
  std::uint64_t plans_enclosed = 0;
  std::uint64_t plans_raw = 0;      // could not be smoothed
  std::uint64_t plans_dropped = 0;  // for another goal
  std::uint64_t steps_aside = 0;    // begun

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("plans", self.plans);
    visit("plans_partial", self.plans_partial);
    visit("plans_enclosed", self.plans_enclosed);
    visit("plans_raw", self.plans_raw);
    visit("plans_dropped", self.plans_dropped);
    visit("steps_aside", self.steps_aside);
  }
};

struct NavigationStatus {
  NavigationState state = NavigationState::kIdle;
  NavigationReason reason = NavigationReason::kNoGoal;
  double rest_m = 0;      // of the way, when last planned
  double off_path_m = 0;  // robot to the left of the path
  double free_m = 0;      // of the way ahead
  NavigationCounters counters;
};

class Navigator {
 public:
  static constexpr double kMaxGoal_m = 20000.0;  // from O's origin, along each axis

  Status reset(const NavigationConfig& config);
  Status set_goal(const Vector2& goal_O_m);
  void clear_goal();

  // false: there is no goal to plan for.
  bool release(const objects::Objects& objects, const RobotPose& robot, TimeNs stamp);
  // May run anywhere between release and publish.
  void run();
  void publish();
  void plan(const objects::Objects& objects, const RobotPose& robot, TimeNs stamp);

  // Objects as they are now. Also without a goal: the robot makes way.
  VelocityCommand follow(const RobotPose& robot, const objects::Objects& objects, TimeNs stamp);

  const NavigationStatus& status() const { return status_; }
  const Path& path() const { return plans_[shown_].path; }  // empty: none
  const Planner& planner() const { return planner_; }       // not between release and publish

 private:
  struct Past {
    TimeNs stamp;
    Vector2 p_O_m = Vector2::Zero();
  };
  static constexpr std::size_t kTrail = 64;

  void stop(NavigationState state, NavigationReason reason);
  void remember(const RobotPose& robot, TimeNs stamp);
  Vector2 past_O_m(const RobotPose& robot, TimeNs stamp) const;
  bool arrived(const RobotPose& robot) const;
  void explain();

  NavigationConfig config_;
  NavigationStatus status_;
  Vector2 goal_O_m_ = Vector2::Zero();
  std::uint32_t goal_number_ = 0;
  std::uint32_t planned_number_ = 0;  // goal that the planner was last run for
  RingBuffer<Past, kTrail> trail_;
  bool released_ = false;
  PlanInput input_;
  Planner planner_;
  std::array<Plan, 2> plans_;
  std::size_t shown_ = 0;
  PathFollower follower_;
};

}  // namespace surefoot::navigation
