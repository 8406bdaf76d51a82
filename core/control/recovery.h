// From any resting pose, upside-down included, to lying on the belly with folded legs, from where
// StandUp rises.
//
// Stages: limp (damped until nothing moves much), fold (abduction joints and knees first, then
// hips, so that no leg sweeps through the trunk), look at gravity, and unless it points into the
// belly: roll over the nearer side and begin again with fold. Legs that have crossed hold each
// other back: where folding leaves a joint short of its place, the outer one of the two is spread,
// folded beside the other and brought back. A roll is a list of keyframes of the configuration,
// given for the two sides: the low side, over which the robot rolls and whose legs are tucked in,
// and the high side, whose legs push the ground away from behind the back. The same list mirrored
// rolls over the other side. A roll that has not turned the robot is repeated over the other side;
// after max_rolls, or as many starts in vain, the recovery has failed.
//
// Cost: twelve blends per tick. Bounded: every stage has a longest duration. No allocation.
#pragma once

#include <array>
#include <cstdint>

#include "core/actuation/joint_bus.h"
#include "core/control/config.h"
#include "core/estimation/estimator.h"
#include "core/math/linear.h"
#include "core/robot/robot_model.h"

namespace surefoot::control {

// What gravity says about how the trunk lies.
enum class Lie : std::uint8_t {
  kUpright = 0,  // within upright_tilt_rad of standing
  kRightDown,    // nearer to its right side (or that much nearer over it): roll over the right
  kLeftDown,
};
Lie lie_of(const Matrix3& R_OB, double upright_tilt_rad);

enum class RecoveryStage : std::uint8_t {
  kLimp = 0,
  kFoldOut,     // abduction joints to zero, knees folded, hips stay
  kFoldIn,      // hips
  kSpread,      // legs that have caught on each other: one of a side outwards
  kFoldSpread,  // hips and knees, with that leg still out
  kLook,        // until it has stopped rocking
  kRoll,
  kDone,
  kFailed,
};

class Recovery {
 public:
  void reset(const RecoveryConfig& config, const robot::RobotModel& model,
             const std::array<double, 3>& folded_rad);

  // Forgets earlier tries: a fall from standing.
  void begin();
  // Begins with kLimp from whatever the joints do now; tries made since begin() count.
  void start();
  const actuation::JointCommands& update(const estimation::RobotState& state, double step_s);

  RecoveryStage stage() const { return stage_; }
  bool done() const { return stage_ == RecoveryStage::kDone; }
  bool failed() const { return stage_ == RecoveryStage::kFailed; }
  int rolls() const { return rolls_; }

 private:
  void enter(RecoveryStage stage, const estimation::RobotState& state);
  void advance(const estimation::RobotState& state);
  void set_fold_target();
  void begin_roll(const estimation::RobotState& state);
  void set_roll_target();
  void set_spread_target(const estimation::RobotState& state);
  bool is_caught(const estimation::RobotState& state, std::size_t leg) const;
  bool any_caught(const estimation::RobotState& state) const;
  bool is_quiet(const estimation::RobotState& state) const;
  void command_blend();

  RecoveryConfig config_;
  robot::RobotModel model_;
  std::array<double, 3> folded_rad_{};
  RecoveryStage stage_ = RecoveryStage::kLimp;
  double stage_s_ = 0;
  double quiet_s_ = 0;
  double blend_s_ = 0;              // duration of the blend under way
  std::size_t keyframe_ = 0;        // of the roll
  Lie side_ = Lie::kUpright;        // of the roll under way or last made
  Lie roll_began_ = Lie::kUpright;  // how it lay when the last roll began
  int rolls_ = 0;
  int spreads_ = 0;  // since start()
  int starts_ = 0;
  std::array<double, robot::kJoints> from_rad_{};
  std::array<double, robot::kJoints> to_rad_{};
  actuation::JointCommands commands_;
};

}  // namespace surefoot::control
