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
#include "core/navigation/status.h"
#include "core/navigation/types.h"
#include "core/objects/object.h"

namespace surefoot::navigation {

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
