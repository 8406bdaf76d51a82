// The trunk's pose for a step: over the feet, within every leg's reach, clear of the ground. The
// search for footsteps rates a place by it, the static walk takes it.
//
// Frames: O, metres. Cost: at most 2 (1 + (max_lowering_m + max_raising_m) / 6 mm) poses, each five
// legs and one look at the ground under them (clearance.h).
#pragma once

#include "core/planning/clearance.h"
#include "core/planning/stance.h"
#include "core/robot/robot_model.h"

namespace surefoot::planning {

// What a pose must leave and may take.
struct StepLimits {
  double reach_margin_m = 0;   // to either end of every leg's reach
  double stop_margin_rad = 0;  // to every joint's stops
  double max_lowering_m = 0;   // of the trunk
  double max_raising_m = 0;
};

// The step of `turn` from `feet` to `landed`, which differ in that step's foot.
struct Step {
  const Feet& feet_O_m;
  const Feet& landed_O_m;
  std::size_t turn = 0;
  double yaw_rad = 0;
  Vector2 centre_offset_O_m;  // of the centre of mass from B's origin, seen from above
};

struct StepPose {
  TrunkPose pose;
  bool reaches = false;  // all legs, the stepping one at both ends of its way
  bool lowered = false;
  bool narrow = false;   // see CentrePlace
  double deepest_m = 0;  // of trunk and legs in the ground, where it reaches
  int tried = 0;         // poses, this one included
};

// Over the feet as they will stand, along slope_share of the slope of their plane or along all of
// it, as high as usual or lower or higher: the first that reaches and touches nothing but the feet;
// else the least deep of those that reach; none reaches: the last that was tried.
StepPose step_pose(const robot::RobotModel& model, const StanceShape& shape,
                   const StepLimits& limits, const PlanningGround& ground, const Step& step);

}  // namespace surefoot::planning
