// What the robot is about to do: from enabling its drives to standing at the goal, or stopping with
// a reason. A flat state machine on the estimator's state; no knowledge of legs.
#pragma once

#include "core/autonomy/config.h"
#include "core/autonomy/tick.h"
#include "core/control/foothold.h"
#include "core/estimation/estimator.h"

namespace surefoot::autonomy {

// What the mission needs to know beside the state.
struct MissionFacts {
  bool drives_ready = false;  // every drive answers
  bool must_recover = false;  // before standing up: it does not lie on its folded legs
  bool fallen = false;
  bool recovered = false;
  bool recovery_failed = false;
  bool stand_up_done = false;
  bool all_in_stance = false;
  StopReason fault = StopReason::kNone;
};

class Mission {
 public:
  void reset(const MissionConfig& config);
  void update(const estimation::RobotState& state, const MissionFacts& facts, double step_s);

  MissionPhase phase() const { return phase_; }
  bool phase_changed() const { return phase_s_ == 0.0; }  // first tick of a phase
  StopReason stop_reason() const { return stop_reason_; }
  const control::VelocityCommand& command() const { return command_; }
  // kStand outside of phase kWalk.
  control::GaitKind gait() const {
    return phase_ == MissionPhase::kWalk ? gait_ : control::GaitKind::kStand;
  }
  bool finished() const;

 private:
  void enter(MissionPhase phase);
  void stop(StopReason reason);
  void arrive();
  void cross(const estimation::RobotState& state);
  void follow_script(const estimation::RobotState& state, double step_s);
  double turn_towards(const estimation::RobotState& state, double heading_rad) const;

  MissionConfig config_;
  MissionPhase phase_ = MissionPhase::kEnableDrives;
  StopReason stop_reason_ = StopReason::kNone;
  control::GaitKind gait_ = control::GaitKind::kStand;
  control::VelocityCommand command_;
  double elapsed_s_ = 0;
  double phase_s_ = 0;
  std::size_t script_step_ = 0;  // mission script: the line in hand
  double script_s_ = 0;          // time spent in it
  double heading_rad_ = 0;       // mission script: what the commanded turns add up to
};

}  // namespace surefoot::autonomy
