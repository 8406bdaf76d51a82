// Where the feet of a robot that walks one leg at a time stand, and what became of that: feet
// slide, and lose the ground they stood on.
//
// In: the estimator's state each tick, which legs stand, which of them carry in full.
// Out: the place each standing leg is to keep its foot at, and whether one slipped or lost its
// ground since the step began.
//
// A foot that slides is followed: held where it was it would lift the trunk off the others. One
// that feels no ground goes down until it does, at most `search_depth_m` below where it stood.
//
// Frames: O, metres, centres of the foot spheres. No allocation.
#pragma once

#include <array>

#include "core/control/config.h"
#include "core/control/leg_status.h"
#include "core/control/load_sharing.h"
#include "core/estimation/estimator.h"
#include "core/planning/stance.h"

namespace surefoot::control {

planning::Feet feet_of(const estimation::RobotState& state);

class StandingFeet {
 public:
  void reset(const SwingConfig& swing, const StaticWalkConfig& walk);

  // A step begins, or one slip was answered: where the feet are is where they stand from now on.
  void take(const estimation::RobotState& state);
  // The foot in the air has come down.
  void put(std::size_t leg, const Vector3& place_O_m);
  void follow(const estimation::RobotState& state, const LegStatuses& legs,
              const LoadShares& shares, double step_s);

  const planning::Feet& places_O_m() const { return places_O_m_; }
  // Since take(), any but `stepping`: moved by more than slip_m; without contact for 30 ms.
  bool have_slipped(const estimation::RobotState& state, std::size_t stepping) const;
  bool have_lost_ground(std::size_t stepping) const;

 private:
  SwingConfig swing_;
  StaticWalkConfig walk_;
  planning::Feet places_O_m_{};
  planning::Feet taken_O_m_{};
  std::array<double, robot::kLegs> lost_s_{};  // without contact while it should carry
};

}  // namespace surefoot::control
