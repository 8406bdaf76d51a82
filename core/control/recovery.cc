#include "core/control/recovery.h"

#include "core/math/elementary.h"

namespace surefoot::control {
namespace {

constexpr double kShortestBlend_s = 0.05;
constexpr double kLongestLimp_s = 0.8;  // what still moves then is sinking slowly
constexpr double kLongestLook_s = 0.6;
constexpr double kLongestLookBeforeRoll_s = 0.3;  // a roll does not mind that it rocks
constexpr double kCaught_rad = 0.3;               // off its place after folding
constexpr double kSpread_rad = 1.0;
constexpr int kMaxSpreads = 2;
constexpr double kQuietJoint_rad_s = 0.4;

double smooth(double s) { return s * s * (3.0 - 2.0 * s); }
using math::magnitude;
double longest_look_s(bool upright) { return upright ? kLongestLook_s : kLongestLookBeforeRoll_s; }
Lie mirrored(Lie side) { return side == Lie::kRightDown ? Lie::kLeftDown : Lie::kRightDown; }

}  // namespace

Lie lie_of(const Matrix3& R_OB, double upright_tilt_rad) {
  if (R_OB(2, 2) >= math::cos(upright_tilt_rad)) return Lie::kUpright;
  return R_OB(2, 1) >= 0.0 ? Lie::kRightDown : Lie::kLeftDown;
}

void Recovery::reset(const RecoveryConfig& config, const robot::RobotModel& model,
                     const std::array<double, 3>& folded_rad) {
  model_ = model;
  *this = Recovery{};
  config_ = config;
  folded_rad_ = folded_rad;
}

void Recovery::begin() {
  rolls_ = 0;
  starts_ = 0;
  side_ = Lie::kUpright;
}

void Recovery::start() {
  stage_ = RecoveryStage::kLimp;
  stage_s_ = 0;
  quiet_s_ = 0;
  keyframe_ = 0;
  spreads_ = 0;
  ++starts_;
}

bool Recovery::is_quiet(const estimation::RobotState& state) const {
  const double limit = math::square(config_.quiet_rad_s);
  if (state.angular_velocity_B_rad_s.squaredNorm() > limit) return false;
  for (const actuation::JointState& joint : state.joints) {
    if (magnitude(joint.velocity_rad_s) > kQuietJoint_rad_s) return false;
  }
  return true;
}

void Recovery::enter(RecoveryStage stage, const estimation::RobotState& state) {
  stage_ = stage;
  stage_s_ = 0;
  quiet_s_ = 0;
  for (std::size_t i = 0; i < robot::kJoints; ++i) {
    // A blend goes on from what was commanded: a joint that is held off its command by a load would
    // give way otherwise. From limp, from where the joint is.
    const bool held = commands_[i].kp_Nm_rad > 0.0;
    from_rad_[i] = held ? to_rad_[i] : state.joints[i].position_rad;
  }
  if (stage == RecoveryStage::kSpread) {
    set_spread_target(state);
  } else {
    to_rad_ = from_rad_;
  }
  if (stage == RecoveryStage::kFoldOut || stage == RecoveryStage::kFoldIn) set_fold_target();
  if (stage == RecoveryStage::kFoldSpread) set_fold_target();
  if (stage == RecoveryStage::kRoll) set_roll_target();
  double farthest_rad = 0;
  for (std::size_t i = 0; i < robot::kJoints; ++i) {
    const double way = magnitude(to_rad_[i] - from_rad_[i]);
    if (way > farthest_rad) farthest_rad = way;
  }
  blend_s_ = farthest_rad / config_.speed_rad_s;
  if (blend_s_ < kShortestBlend_s) blend_s_ = kShortestBlend_s;
}

void Recovery::set_fold_target() {
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const bool abduction = stage_ != RecoveryStage::kFoldSpread;
    const bool hip = stage_ != RecoveryStage::kFoldOut;
    const std::array<double, 3> folded_rad = model_.pose_of(leg, folded_rad_);
    if (abduction) to_rad_[robot::joint_index(leg, 0)] = folded_rad[0];
    if (hip) to_rad_[robot::joint_index(leg, 1)] = folded_rad[1];
    to_rad_[robot::joint_index(leg, 2)] = folded_rad[2];
  }
}

bool Recovery::is_caught(const estimation::RobotState& state, std::size_t leg) const {
  for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
    const std::size_t joint = robot::joint_index(leg, i);
    if (magnitude(to_rad_[joint] - state.joints[joint].position_rad) > kCaught_rad) return true;
  }
  return false;
}

bool Recovery::any_caught(const estimation::RobotState& state) const {
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    if (is_caught(state, leg)) return true;
  }
  return false;
}

// On a side where legs have caught on each other the one that already lies farther out is spread;
// the next time the other one. All joints start from where they are: none shall go on pressing
// against what holds it.
void Recovery::set_spread_target(const estimation::RobotState& state) {
  const auto outwards_rad = [&state](std::size_t leg) {
    return robot::left_sign(leg) * state.joints[robot::joint_index(leg, 0)].position_rad;
  };
  std::array<bool, robot::kLegs> spread{};
  for (std::size_t side = 0; side < 2; ++side) {
    const std::size_t front = side;
    const std::size_t hind = side + 2;
    if (!is_caught(state, front) && !is_caught(state, hind)) continue;
    const bool front_is_out = outwards_rad(front) >= outwards_rad(hind);
    spread[front_is_out == (spreads_ % 2 == 0) ? front : hind] = true;
  }
  ++spreads_;
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    from_rad_[joint] = state.joints[joint].position_rad;
    to_rad_[joint] = from_rad_[joint];
  }
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    if (spread[leg]) to_rad_[robot::joint_index(leg, 0)] = robot::left_sign(leg) * kSpread_rad;
  }
}

void Recovery::set_roll_target() {
  const RollKeyframe& keyframe = config_.roll[keyframe_];
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const bool is_left = robot::left_sign(leg) > 0;
    const bool is_low = is_left == (side_ == Lie::kLeftDown);
    const std::array<double, 3> pose =
        model_.pose_of(leg, is_low ? keyframe.low_rad : keyframe.high_rad);
    for (std::size_t i = 0; i < pose.size(); ++i) to_rad_[robot::joint_index(leg, i)] = pose[i];
  }
}

// Over the nearer side; over the other one when that has just been tried in vain.
void Recovery::begin_roll(const estimation::RobotState& state) {
  const Lie lie = lie_of(state.R_OB, config_.upright_tilt_rad);
  if (rolls_ >= config_.max_rolls || config_.roll.size() == 0) {
    return enter(RecoveryStage::kFailed, state);
  }
  const bool in_vain = rolls_ > 0 && lie == roll_began_ && side_ == lie;
  side_ = in_vain ? mirrored(lie) : lie;
  roll_began_ = lie;
  ++rolls_;
  keyframe_ = 0;
  enter(RecoveryStage::kRoll, state);
}

void Recovery::advance(const estimation::RobotState& state) {
  const bool blended = stage_s_ >= blend_s_;
  const bool upright = lie_of(state.R_OB, config_.upright_tilt_rad) == Lie::kUpright;
  switch (stage_) {
    case RecoveryStage::kLimp:
      if (quiet_s_ >= config_.quiet_s || stage_s_ >= kLongestLimp_s) {
        enter(RecoveryStage::kFoldOut, state);
      }
      break;
    case RecoveryStage::kFoldOut:
      if (blended) enter(RecoveryStage::kFoldIn, state);
      break;
    case RecoveryStage::kFoldIn:
      if (!blended) break;
      if (any_caught(state) && spreads_ < kMaxSpreads) return enter(RecoveryStage::kSpread, state);
      return enter(RecoveryStage::kLook, state);
    case RecoveryStage::kSpread:
      if (blended) enter(RecoveryStage::kFoldSpread, state);
      break;
    case RecoveryStage::kFoldSpread:
      if (blended) enter(RecoveryStage::kFoldOut, state);
      break;
    case RecoveryStage::kLook:
      if (quiet_s_ < config_.quiet_s && stage_s_ < longest_look_s(upright)) break;
      if (upright && starts_ > config_.max_rolls) return enter(RecoveryStage::kFailed, state);
      if (upright) return enter(RecoveryStage::kDone, state);
      return begin_roll(state);
    case RecoveryStage::kRoll:
      if (stage_s_ < blend_s_ + config_.roll[keyframe_].hold_s) break;
      if (keyframe_ + 1 == config_.roll.size()) return enter(RecoveryStage::kFoldOut, state);
      ++keyframe_;
      return enter(RecoveryStage::kRoll, state);
    case RecoveryStage::kDone:
    case RecoveryStage::kFailed: break;
  }
}

void Recovery::command_blend() {
  const double share = smooth(math::clamp(stage_s_ / blend_s_, 0.0, 1.0));
  for (std::size_t i = 0; i < robot::kJoints; ++i) {
    commands_[i] = actuation::JointCommand{};
    commands_[i].position_rad = from_rad_[i] + (to_rad_[i] - from_rad_[i]) * share;
    commands_[i].kp_Nm_rad = config_.kp_Nm_rad;
    commands_[i].kd_Nm_s_rad = config_.kd_Nm_s_rad;
  }
}

const actuation::JointCommands& Recovery::update(const estimation::RobotState& state,
                                                 double step_s) {
  stage_s_ += step_s;
  quiet_s_ = is_quiet(state) ? quiet_s_ + step_s : 0.0;
  advance(state);
  if (stage_ == RecoveryStage::kLimp || stage_ == RecoveryStage::kFailed) {
    for (actuation::JointCommand& command : commands_) {
      command = actuation::JointCommand{};
      command.kd_Nm_s_rad = config_.limp_damping_Nm_s_rad;
    }
    return commands_;
  }
  command_blend();
  return commands_;
}

}  // namespace surefoot::control
