// Trotting over ground that the map shows: gait clock, footholds, swing legs, stance forces.
//
// In: the estimator's RobotState, the published map window (or none), a velocity command.
// Out: twelve joint commands for this tick, and for each leg what it is about.
//
// Each leg is in one of three modes:
//   stance  carries load: torque from the force distribution, light joint damping
//   swing   follows a path to its foothold under joint stiffness
//   search  should stand but feels no ground: moves straight down until it does or the depth is
//   used up
// A swing begins when the gait says so and a foothold exists; without one the leg stays in stance
// for this cycle, the reason is reported and the body slows down (blocked_s()).
//
// Cost per tick: one force QP, four leg Jacobians, at most two foothold searches. No allocation.
#pragma once

#include <array>

#include "core/actuation/joint_bus.h"
#include "core/control/body_reference.h"
#include "core/control/config.h"
#include "core/control/foothold.h"
#include "core/control/gait.h"
#include "core/control/horizon_plan.h"
#include "core/control/leg_status.h"
#include "core/control/map_offset.h"
#include "core/control/swing.h"
#include "core/control/whole_body.h"
#include "core/estimation/estimator.h"
#include "core/mapping/map_window.h"
#include "core/robot/robot_model.h"

namespace surefoot::control {

struct WalkCommand {
  VelocityCommand velocity;
  GaitKind gait = GaitKind::kStand;
  GroundRule ground = GroundRule::kGood;  // while nothing forces a step
};

class Locomotion {
 public:
  void reset(const ControlConfig& config, const robot::RobotModel& model);

  // All legs in stance at the present pose: call once when stand-up is done.
  void start(const estimation::RobotState& state);

  // command.gait: kStand brings the robot to rest in four-legged stance: it steps on while the
  // commanded speed comes down, and one cycle more, which puts the feet below the hips. A change of
  // gait takes place where the present cycle ends.
  const actuation::JointCommands& update(const estimation::RobotState& state,
                                         const mapping::MapWindow* window,
                                         const WalkCommand& command, const ForcePlan& plan,
                                         double step_s);
  // What the predictive controller should solve next, from the last update on.
  void plan(const estimation::RobotState& state, MpcProblem& problem) const;

  const LegStatuses& legs() const { return legs_; }
  // What the contact estimator needs to know of the plan.
  std::array<estimation::GaitPhase, robot::kLegs> gait_phases() const {
    return control::gait_phases(legs_);
  }
  bool all_in_stance() const;
  // All in stance, and no further step is due.
  bool at_rest() const { return !gait_running_ && all_in_stance(); }
  // How long a leg has been without a foothold, 0 when every leg has one.
  double blocked_s() const { return blocked_s_; }
  const BodyReference& reference() const { return reference_; }

 private:
  GroundRule ground_rule(const estimation::RobotState& state, GroundRule wanted) const;
  // Whether legs may be lifted.
  bool advance_gait(GaitKind gait, double step_s);
  void advance_leg(std::size_t leg, const estimation::RobotState& state,
                   const mapping::MapWindow* window, bool stepping, double step_s);
  void try_swing(std::size_t leg, const estimation::RobotState& state,
                 const mapping::MapWindow* window);
  void follow_foothold(std::size_t leg, const estimation::RobotState& state,
                       const mapping::MapWindow* window);
  Foothold find_foothold(std::size_t leg, const estimation::RobotState& state,
                         const mapping::MapWindow* window) const;
  void set_path(std::size_t leg, const mapping::MapWindow* window);
  void plan_forces(const estimation::RobotState& state, const ForcePlan& plan);
  void control_body(const estimation::RobotState& state);

  ControlConfig config_;
  robot::RobotModel model_;
  Gait gait_;
  FootholdPlanner footholds_;
  MapOffset map_offset_;
  BodyReferenceTracker tracker_;
  BodyReference reference_;
  WholeBody whole_body_;
  VelocityCommand command_;  // ramped
  GroundRule ground_ = GroundRule::kGood;
  bool gait_running_ = false;
  double halted_s_ = 0;  // since the commanded speed has come down to zero in order to stand
  double blocked_s_ = 0;
  LegStatuses legs_;
  actuation::JointCommands joints_;
};

}  // namespace surefoot::control
