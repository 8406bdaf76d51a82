// What navigation says of itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

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

}  // namespace surefoot::navigation
