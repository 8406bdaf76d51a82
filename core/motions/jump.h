// Plays a motion: crouch to its first pose, hold, push on four feet, push on the hind feet, flight,
// landing, rise to walking height. Whether the jump may start is JumpPilot's decision
// (core/autonomy); here are the states it is decided on (check_start).
//
// In: the estimator's RobotState. Out: twelve joint commands per tick and what the contact
// estimator has to expect of each foot. Torques are those of the motion plus the moment that the
// abduction joints need under its ground forces; joint gains hold the legs on it. Angles: the
// motion's, in flight blended into legs that reach for level ground at landing_foot_m ahead of the
// hips whatever the trunk's attitude.
//
// Memory: a pointer to the motion, which must outlive it. Cost per tick: one interpolation, four
// leg solutions. No allocation.
#pragma once

#include <array>
#include <cstdint>

#include "core/actuation/joint_bus.h"
#include "core/estimation/contact.h"
#include "core/estimation/estimator.h"
#include "core/motions/jump_config.h"
#include "core/motions/motion.h"
#include "core/robot/robot_model.h"

namespace surefoot::motions {

enum class JumpStage : std::uint8_t {
  kIdle = 0,
  kCrouch,
  kHold,  // in the first pose, waiting for play() or cancel()
  kPushFour,
  kPushTwo,  // the front feet have left the ground
  kFlight,
  kLanding,
  kRise,
  kDone,  // standing at walking height
};
inline constexpr const char* kJumpStageNames[] = {
    "idle", "crouch", "hold", "push_four", "push_two", "flight", "landing", "rise", "done"};

// Why a jump was not made.
enum class JumpRefusal : std::uint8_t {
  kNone = 0,
  kNoMotion,  // none of the library goes so high or so far
  kEdgeLost,  // the map shows no edge ahead any more
  kDistance,  // to the edge
  kHeading,   // off the edge's normal
  kRise,      // of the landing
  kLanding,   // the landing is not seen, not level or not free
  kTilt,
  kSpeed,
  kRate,
  kJoints,     // off the first pose
  kFoot,       // not on the ground
  kBrokenOff,  // the joints did not follow while all feet pushed
};
inline constexpr const char* kJumpRefusalNames[] = {
    "none", "no_motion", "edge_lost", "distance", "heading", "rise",       "landing",
    "tilt", "speed",     "rate",      "joints",   "foot",    "broken_off",
};

// What a start set is about.
struct StartState {
  double edge_m = 0;  // trunk's origin to the edge ahead, along the edge's normal
  double rise_m = 0;  // of the landing
  double heading_rad = 0;
  double tilt_rad = 0;
  double speed_m_s = 0;
  double rate_rad_s = 0;
  double joint_error_rad = 0;  // largest, to the first row
  bool all_feet = false;       // on the ground
  bool landing_free = false;
};
// The first thing of `state` that lies outside of the motion's start set.
JumpRefusal check_start(const StartSet& set, const StartState& state);

class JumpController {
 public:
  void reset(const JumpConfig& config, const robot::RobotModel& model, double standing_height_m);

  // From standing on four feet. `motion` must outlive the jump.
  void begin(const Motion& motion, const estimation::RobotState& state);
  // In kHold: starts the motion.
  void play();
  // In kCrouch or kHold: stands up again.
  void cancel(const estimation::RobotState& state);
  // The jump is over or given up: back to kIdle.
  void end() { stage_ = JumpStage::kIdle; }

  const actuation::JointCommands& update(const estimation::RobotState& state, double step_s);

  JumpStage stage() const { return stage_; }
  bool active() const { return stage_ != JumpStage::kIdle; }
  double stage_s() const { return stage_s_; }
  // In the first pose long enough to be at rest.
  bool holds() const { return stage_ == JumpStage::kHold && stage_s_ >= config_.hold_s; }
  bool broken_off() const { return broken_off_; }
  // The motion was played to its end.
  bool landed() const { return has_landed_; }
  double max_joint_error_rad(const estimation::RobotState& state) const;
  std::array<estimation::GaitPhase, robot::kLegs> gait_phases() const { return phases_; }

 private:
  using Angles = std::array<Vector3, robot::kLegs>;

  void enter(JumpStage stage);
  void advance(const estimation::RobotState& state, double step_s);
  bool feels_ground(const estimation::RobotState& state);
  Vector3 weight_Nm(std::size_t leg, const estimation::RobotState& state) const;
  void crouch(const estimation::RobotState& state);
  void push(const estimation::RobotState& state);
  void fly(const estimation::RobotState& state);
  void land(const estimation::RobotState& state);
  void rise(const estimation::RobotState& state);
  void expect_contacts();
  double end_s() const { return motion_->rows.back().time_s; }
  Angles first_pose() const;
  Angles row_angles(const MotionRow& row) const;
  Vector3 landing_foot_B_m(std::size_t leg, const Matrix3& R_OB, double yaw_rad) const;
  void command(std::size_t leg, const Vector3& q, const Vector3& qd, const Vector3& torque,
               const JointGains& gains);

  JumpConfig config_;
  robot::RobotModel model_;
  double standing_height_m_ = 0;
  const Motion* motion_ = nullptr;
  JumpStage stage_ = JumpStage::kIdle;
  double stage_s_ = 0;
  double time_s_ = 0;  // of the motion
  std::size_t hint_ = 0;
  bool broken_off_ = false;
  bool has_landed_ = false;
  int touches_ = 0;                             // ticks in a row in which a foot felt the ground
  std::array<Vector3, robot::kLegs> from_B_m_;  // feet where crouch or rise began
  std::array<estimation::GaitPhase, robot::kLegs> phases_{};
  actuation::JointCommands commands_;
};

}  // namespace surefoot::motions
