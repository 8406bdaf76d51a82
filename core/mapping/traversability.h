// What a place on the ground means to the robot, and where the classes begin.
#pragma once

#include <cstdint>

#include "core/mapping/mapping_config.h"
#include "core/robot/robot_model.h"

namespace surefoot::mapping {

// Paper 002, section III-B. Every cell has one; README.md says how it is found.
enum class Traversability : std::uint8_t {
  kUnknown = 0,  // too little is known around it; never walked on
  kSteppable,    // a foot can be placed here
  kUnsteppable,  // a foot cannot be placed, but the place can be stepped over
  kJumpOnly,     // at a rise or drop too high for a step, not too high for a jump
  kImpassable,   // at a rise or drop too high for a jump
};

// Steppable cells are told apart up to this distance from the nearest that is not (Chebyshev).
inline constexpr std::uint8_t kMaxMargin_cells = 3;

// Thresholds of the classes, in metres of step and in slope.
struct TraversabilityLimits {
  double max_slope = 0;          // tangent of the steepest ground that a foot stands on
  double max_raise_m = 0;        // of ground beside the foot over the ground under it
  double max_drop_m = 0;         // of ground beside the foot below the ground under it
  std::uint8_t max_unknown = 0;  // cells without height in the patch of 17
  double max_step_m = 0;         // higher steps, up or down, can only be jumped
  double max_jump_m = 0;         // higher ones cannot be passed
};

// The highest step, up or down, that a walking robot takes, from its geometry:
//  - the leg folds from standing (body height over the sole) to its shortest (knee at its stop) and
//    still clears the step by the swing's clearance;
//  - while the other feet are on the low side the belly keeps as much room above the step as the
//    step is high (the body sways, pitches and sinks by less than that).
double step_height_m(const robot::RobotModel& model, double body_height_m,
                     double swing_clearance_m);

TraversabilityLimits traversability_limits(const MappingConfig& config,
                                           const robot::RobotModel& model, double body_height_m,
                                           double swing_clearance_m);

// kInvalid: a value is not finite, a limit is negative, or max_jump_m is below max_step_m.
Status validate(const TraversabilityLimits& limits);

}  // namespace surefoot::mapping
