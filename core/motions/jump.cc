#include "core/motions/jump.h"

#include "core/math/elementary.h"
#include "core/math/gravity.h"
#include "core/robot/kinematics.h"

namespace surefoot::motions {
namespace {

constexpr double kBlend_s = 0.12;  // before the motion's end: into the reach for the ground
// A touchdown: so much force on a foot in so many ticks, no earlier than this before the motion's
// end.
constexpr double kTouch_N = 35.0;
constexpr int kTouchTicks = 2;
constexpr double kEarly_s = 0.15;
constexpr double kStrike_s = 0.04;  // feet that strike the ground slide on it

double smooth(double s) { return s * s * (3.0 - 2.0 * s); }
using math::magnitude;

}  // namespace

JumpRefusal check_start(const StartSet& set, const StartState& state) {
  if (!(state.edge_m >= set.edge_min_m && state.edge_m <= set.edge_max_m)) {
    return JumpRefusal::kDistance;
  }
  if (!(magnitude(state.heading_rad) <= set.max_heading_rad)) return JumpRefusal::kHeading;
  if (!(state.rise_m >= set.rise_min_m && state.rise_m <= set.rise_max_m)) {
    return JumpRefusal::kRise;
  }
  if (!state.landing_free) return JumpRefusal::kLanding;
  if (!(state.tilt_rad <= set.max_tilt_rad)) return JumpRefusal::kTilt;
  if (!(state.speed_m_s <= set.max_speed_m_s)) return JumpRefusal::kSpeed;
  if (!(state.rate_rad_s <= set.max_rate_rad_s)) return JumpRefusal::kRate;
  if (!(state.joint_error_rad <= set.max_joint_error_rad)) return JumpRefusal::kJoints;
  if (!state.all_feet) return JumpRefusal::kFoot;
  return JumpRefusal::kNone;
}

void JumpController::reset(const JumpConfig& config, const robot::RobotModel& model,
                           double standing_height_m) {
  *this = JumpController{};
  config_ = config;
  model_ = model;
  standing_height_m_ = standing_height_m;
  from_B_m_.fill(Vector3::Zero());
}

void JumpController::enter(JumpStage stage) {
  stage_ = stage;
  stage_s_ = 0;
}

void JumpController::begin(const Motion& motion, const estimation::RobotState& state) {
  motion_ = &motion;
  time_s_ = 0;
  hint_ = 0;
  broken_off_ = false;
  has_landed_ = false;
  touches_ = 0;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) from_B_m_[leg] = state.feet[leg].p_B_m;
  enter(JumpStage::kCrouch);
}

void JumpController::play() {
  if (stage_ != JumpStage::kHold) return;
  enter(JumpStage::kPushFour);
}

void JumpController::cancel(const estimation::RobotState& state) {
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) from_B_m_[leg] = state.feet[leg].p_B_m;
  enter(JumpStage::kRise);
}

JumpController::Angles JumpController::row_angles(const MotionRow& row) const {
  Angles angles;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    angles[leg] =
        Vector3(0.0, row.joint_rad[planar_joint(leg, 1)], row.joint_rad[planar_joint(leg, 2)]);
  }
  return angles;
}

JumpController::Angles JumpController::first_pose() const { return row_angles(motion_->rows[0]); }

double JumpController::max_joint_error_rad(const estimation::RobotState& state) const {
  std::size_t hint = hint_;
  const Angles wanted = row_angles(motion_at(*motion_, time_s_, hint));
  double largest = 0;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
      const double off = magnitude(wanted[leg][static_cast<Eigen::Index>(i)] -
                                   state.joints[robot::joint_index(leg, i)].position_rad);
      largest = off > largest ? off : largest;
    }
  }
  return largest;
}

void JumpController::command(std::size_t leg, const Vector3& q, const Vector3& qd,
                             const Vector3& torque, const JointGains& gains) {
  for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double limit = model_.actuators[i].torque_limit_Nm;
    actuation::JointCommand& joint = commands_[robot::joint_index(leg, i)];
    joint.position_rad = q[row];
    joint.velocity_rad_s = qd[row];
    joint.torque_Nm = math::clamp(torque[row], -limit, limit);
    joint.kp_Nm_rad = gains.kp_Nm_rad;
    joint.kd_Nm_s_rad = gains.kd_Nm_s_rad;
  }
}

const actuation::JointCommands& JumpController::update(const estimation::RobotState& state,
                                                       double step_s) {
  advance(state, step_s);
  switch (stage_) {
    case JumpStage::kIdle: break;
    case JumpStage::kCrouch:
    case JumpStage::kHold: crouch(state); break;
    case JumpStage::kPushFour:
    case JumpStage::kPushTwo: push(state); break;
    case JumpStage::kFlight: fly(state); break;
    case JumpStage::kLanding: land(state); break;
    case JumpStage::kRise:
    case JumpStage::kDone: rise(state); break;
  }
  expect_contacts();
  return commands_;
}

void JumpController::advance(const estimation::RobotState& state, double step_s) {
  stage_s_ += step_s;
  const bool plays = stage_ >= JumpStage::kPushFour && stage_ <= JumpStage::kFlight;
  if (plays) time_s_ += step_s;
  switch (stage_) {
    case JumpStage::kCrouch:
      if (stage_s_ >= config_.crouch_s) enter(JumpStage::kHold);
      break;
    case JumpStage::kPushFour:
      if (max_joint_error_rad(state) > config_.abort_error_rad) {
        broken_off_ = true;
        return cancel(state);
      }
      if (time_s_ >= motion_->front_lift_s) enter(JumpStage::kPushTwo);
      break;
    case JumpStage::kPushTwo:
      if (time_s_ >= motion_->hind_lift_s) enter(JumpStage::kFlight);
      break;
    case JumpStage::kFlight:
      if (feels_ground(state) || time_s_ >= end_s() + config_.late_landing_s) {
        has_landed_ = true;
        enter(JumpStage::kLanding);
      }
      break;
    case JumpStage::kLanding:
      if (stage_s_ >= config_.landing_s) cancel(state);
      break;
    case JumpStage::kRise:
      if (stage_s_ >= config_.rise_s) enter(JumpStage::kDone);
      break;
    case JumpStage::kIdle:
    case JumpStage::kHold:
    case JumpStage::kDone: break;
  }
}

// By force alone: expect_contacts() keeps the contact estimator out of it.
bool JumpController::feels_ground(const estimation::RobotState& state) {
  bool touched = false;
  for (const estimation::FootState& foot : state.feet) {
    touched = touched || foot.force_O_N[2] > kTouch_N;
  }
  touches_ = touched && time_s_ >= end_s() - kEarly_s ? touches_ + 1 : 0;
  return touches_ >= kTouchTicks;
}

// Torques of a leg that bears a quarter of the weight.
Vector3 JumpController::weight_Nm(std::size_t leg, const estimation::RobotState& state) const {
  const Vector3 share_O_N(0.0, 0.0, 0.25 * model_.total_mass_kg() * kGravity_m_s2);
  return -(state.feet[leg].jacobian_B.transpose() * (state.R_OB.transpose() * share_O_N));
}

// The feet stay where they stand: straight lines in the trunk's frame.
void JumpController::crouch(const estimation::RobotState& state) {
  const double s = smooth(math::clamp(stage_s_ / config_.crouch_s, 0.0, 1.0));
  const double share = stage_ == JumpStage::kHold ? 1.0 : s;
  const Angles first = first_pose();
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const Vector3 low = robot::foot_position_B_m(model_, leg, first[leg]);
    const Vector3 target = from_B_m_[leg] + (low - from_B_m_[leg]) * share;
    command(leg, robot::solve_leg(model_, leg, target).q_rad, Vector3::Zero(),
            weight_Nm(leg, state), config_.stance);
  }
}

void JumpController::push(const estimation::RobotState& state) {
  const MotionRow row = motion_at(*motion_, time_s_, hint_);
  const Angles angles = row_angles(row);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const std::size_t hip = planar_joint(leg, 1);
    const std::size_t knee = planar_joint(leg, 2);
    const std::size_t pair = robot::is_front(leg) ? 0 : 2;
    const Vector3 force_O_N(row.force_N[pair], 0.0, row.force_N[pair + 1]);
    const math::SinCos pitch = math::sin_cos(row.trunk[2]);
    const Vector3 force_B_N(pitch.cos * force_O_N[0] + pitch.sin * force_O_N[2], 0.0,
                            pitch.cos * force_O_N[2] - pitch.sin * force_O_N[0]);
    const double abduction_Nm = -(state.feet[leg].jacobian_B.col(0).dot(force_B_N));
    command(leg, angles[leg], Vector3(0.0, row.joint_rad_s[hip], row.joint_rad_s[knee]),
            Vector3(abduction_Nm, row.torque_Nm[hip], row.torque_Nm[knee]), config_.push);
  }
}

// Below its hip, landing_foot_m ahead, all four at one height whatever the trunk's attitude.
Vector3 JumpController::landing_foot_B_m(std::size_t leg, const Matrix3& R_OB,
                                         double yaw_rad) const {
  const Vector3 hip_O = R_OB * robot::hip_joint_B_m(model_, leg);
  const math::SinCos yaw = math::sin_cos(yaw_rad);
  const Vector3 foot_O(hip_O[0] + yaw.cos * config_.landing_foot_m,
                       hip_O[1] + yaw.sin * config_.landing_foot_m,
                       model_.foot_radius_m - config_.landing_height_m);
  return R_OB.transpose() * foot_O;
}

void JumpController::fly(const estimation::RobotState& state) {
  const MotionRow row = motion_at(*motion_, time_s_, hint_);
  const Angles angles = row_angles(row);
  const double reach = smooth(math::clamp((time_s_ - end_s() + kBlend_s) / kBlend_s, 0.0, 1.0));
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const Vector3 foot_B = landing_foot_B_m(leg, state.R_OB, state.yaw_rad);
    const Vector3 ground = robot::solve_leg(model_, leg, foot_B).q_rad;
    const std::size_t hip = planar_joint(leg, 1);
    const std::size_t knee = planar_joint(leg, 2);
    const Vector3 qd(0.0, row.joint_rad_s[hip], row.joint_rad_s[knee]);
    const Vector3 torque(0.0, row.torque_Nm[hip], row.torque_Nm[knee]);
    command(leg, angles[leg] + (ground - angles[leg]) * reach, qd * (1.0 - reach),
            torque * (1.0 - reach), config_.flight);
  }
}

// Legs as springs about the landing pose of a level trunk, so that they turn it level.
void JumpController::land(const estimation::RobotState& state) {
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const Vector3 target = landing_foot_B_m(leg, Matrix3::Identity(), 0.0);
    command(leg, robot::solve_leg(model_, leg, target).q_rad, Vector3::Zero(),
            weight_Nm(leg, state), config_.landing);
  }
}

void JumpController::rise(const estimation::RobotState& state) {
  const double s = smooth(math::clamp(stage_s_ / config_.rise_s, 0.0, 1.0));
  const double share = stage_ == JumpStage::kDone ? 1.0 : s;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const Vector3 standing = robot::hip_joint_B_m(model_, leg) +
                             Vector3(0.0, 0.0, model_.foot_radius_m - standing_height_m_);
    const Vector3 target = from_B_m_[leg] + (standing - from_B_m_[leg]) * share;
    command(leg, robot::solve_leg(model_, leg, target).q_rad, Vector3::Zero(),
            weight_Nm(leg, state), config_.stance);
  }
}

// From the front feet's lift-off until the feet have ceased to slide where they struck, the
// estimate goes on by the IMU alone. The joints accelerate so much then that a speed read one tick
// late would be off by 0.1 m/s, and a foot that slides says nothing.
void JumpController::expect_contacts() {
  const bool strikes = stage_ == JumpStage::kLanding && stage_s_ < kStrike_s;
  const bool leaves = stage_ == JumpStage::kPushTwo || stage_ == JumpStage::kFlight;
  estimation::GaitPhase phase;
  phase.stance_planned = !(leaves || strikes);
  phases_.fill(phase);
}

}  // namespace surefoot::motions
