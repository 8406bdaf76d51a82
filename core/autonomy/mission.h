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
  bool at_rest = false;                 // on all feet, no step due
  bool jump_refused = false;            // an edge ahead, and the pilot has given up
  bool at_goal = false;                 // mission navigate: the navigator says so, likewise
  control::VelocityCommand navigation;  // its command
  StopReason fault = StopReason::kNone;
};

class Mission {
 public:
  // braking_m_s2: how fast the speed comes down ahead of a goal; 0: not before it is reached.
  void reset(const MissionConfig& config, double braking_m_s2 = 0);
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

  // Missions that go somewhere: unit vector along the line in hand, and how far the robot is to its
  // left.
  const Vector2& path_O() const { return path_.direction_O; }
  double off_path_m(const estimation::RobotState& state) const { return path_.left_m(state); }
  // For how long it has not come nearer to the end of the line in hand.
  double stuck_s() const { return stuck_s_; }

 private:
  // The line in hand of a mission that goes somewhere.
  struct Path {
    Vector2 from_O_m = Vector2::Zero();
    Vector2 direction_O = Vector2(1, 0);
    double length_m = 0;
    double heading_rad = 0;

    double along_m(const estimation::RobotState& state) const;
    double left_m(const estimation::RobotState& state) const;
    double to_go_m(const estimation::RobotState& state) const;
  };

  void enter(MissionPhase phase);
  void stop(StopReason reason);
  void arrive();
  void cross(const estimation::RobotState& state, double step_s);
  void navigate(const MissionFacts& facts);
  void follow_script(const estimation::RobotState& state, double step_s);
  void begin_line();
  void begin_line_here(const estimation::RobotState& state);
  bool next_line();
  bool at_end(const estimation::RobotState& state) const;
  void note_progress(double to_go_m, double step_s);
  double turn_towards(const estimation::RobotState& state, double heading_rad) const;
  double approach_speed_m_s(double left_m) const;

  MissionConfig config_;
  double braking_m_s2_ = 0;
  MissionPhase phase_ = MissionPhase::kEnableDrives;
  StopReason stop_reason_ = StopReason::kNone;
  control::GaitKind gait_ = control::GaitKind::kStand;
  control::VelocityCommand command_;
  double elapsed_s_ = 0;
  double phase_s_ = 0;
  double rested_s_ = 0;          // arrived: at rest without a break
  std::size_t script_step_ = 0;  // mission script: the line in hand
  double script_s_ = 0;          // time spent in it
  std::size_t waypoint_ = 0;     // mission cross: the one ahead
  Path path_;
  double least_to_go_m_ = 0;  // on the line in hand
  double stuck_s_ = 0;
  bool fell_ = false;       // since it last walked
  double heading_rad_ = 0;  // mission script: what the commanded turns add up to
};

}  // namespace surefoot::autonomy
