// From what the legs are about and where the body should go to the problem of the predictive
// controller: which foot stands where at each step of the horizon, and the body's reference.
//
// A leg stands at a step when the gait's clock says so at the step's middle, but
//   - the first step takes the leg as it is: a foot that searches or swings bears nothing yet;
//   - a leg that stands through its planned swing (early touchdown, no foothold) goes on standing
//     until that swing would have ended.
// A swinging leg comes down at its foothold. Where a standing leg will step next is not decided
// yet: the Raibert point of the reference (paper 002, equations 7 to 9) stands in for it.
//
// Cost: ten steps of four legs, one sin_cos each. No state.
#pragma once

#include <array>

#include "core/control/body_reference.h"
#include "core/control/config.h"
#include "core/control/convex_mpc.h"
#include "core/control/gait.h"
#include "core/control/leg_status.h"
#include "core/estimation/estimator.h"
#include "core/robot/robot_model.h"

namespace surefoot::control {

// What the predictive controller published last.
struct ForcePlan {
  MpcSolution solution;
  TimeNs stamp;        // of the state that it was solved for
  bool valid = false;  // false: nothing yet
};

struct HorizonInputs {
  const robot::RobotModel& model;
  const ControlConfig& config;
  const estimation::RobotState& state;
  const BodyReference& reference;
  const VelocityCommand& command;
  const Gait& gait;
  bool gait_running;  // false: every leg stands throughout
  const std::array<LegStatus, robot::kLegs>& legs;
};

// Everything of `problem` but steps_since_last.
void plan_horizon(const HorizonInputs& in, MpcProblem& problem);

}  // namespace surefoot::control
