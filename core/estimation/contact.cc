#include "core/estimation/contact.h"

#include "core/math/elementary.h"
#include "core/math/gravity.h"

namespace surefoot::estimation {
void ContactEstimator::reset(const ContactConfig& config, const robot::RobotModel& model,
                             double tick_s) {
  config_ = config;
  model_ = model;
  tick_s_ = tick_s;
  dynamics_.reset(model);
  started_ = false;
  external_Nm_.setZero();
  velocity_.setZero();
  confirmations_.fill(0);
  feet_.fill(FootContact{});
}

// The trunk moves in the inertial frame that goes with it now: its velocity is zero there and need
// not be known.
void ContactEstimator::observe_torques(
    const std::array<actuation::JointState, robot::kJoints>& joints, const TrunkMotion& trunk) {
  robot::MotionState state;
  robot::JointVector torque_Nm;
  state.R_OB = trunk.R_OB;
  state.velocity.setZero();
  state.velocity.head<3>() = trunk.angular_velocity_B_rad_s;
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    const auto row = static_cast<Eigen::Index>(joint);
    const robot::Actuator& actuator = model_.actuators[joint % robot::kJointsPerLeg];
    state.q_rad[row] = joints[joint].position_rad;
    state.velocity[6 + row] = joints[joint].velocity_rad_s;
    torque_Nm[row] =
        joints[joint].torque_Nm - actuator.viscous_friction_Nm_s * joints[joint].velocity_rad_s;
  }
  if (!started_) velocity_ = state.velocity;
  robot::GeneralisedVector acceleration = (state.velocity - velocity_) / tick_s_;
  acceleration.segment<3>(3) =
      trunk.specific_force_B_m_s2 + trunk.R_OB.transpose() * Vector3(0.0, 0.0, -kGravity_m_s2);
  velocity_ = state.velocity;
  started_ = true;
  dynamics_.update(state);
  const robot::JointVector needed_Nm = dynamics_.inverse_dynamics(acceleration).tail<12>();
  const double share = math::clamp(config_.observer_gain_1_s * tick_s_, 0.0, 1.0);
  external_Nm_ += (needed_Nm - torque_Nm - external_Nm_) * share;
}

void ContactEstimator::update(const std::array<actuation::JointState, robot::kJoints>& joints,
                              const std::array<GaitPhase, robot::kLegs>& gait,
                              const std::array<FootMotion, robot::kLegs>& motion,
                              const TrunkMotion& trunk) {
  observe_torques(joints, trunk);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    // J^T F = external torque. Near a straight knee J is singular: F is left as it was.
    const Matrix3& jacobian = motion[leg].jacobian_B;
    constexpr double kSmallestDeterminant_m3 = 1e-4;
    const double determinant = jacobian.determinant();
    if (determinant > kSmallestDeterminant_m3 || determinant < -kSmallestDeterminant_m3) {
      const Vector3 external_Nm =
          external_Nm_.segment<3>(static_cast<Eigen::Index>(robot::joint_index(leg, 0)));
      feet_[leg].force_O_N = trunk.R_OB * (jacobian.transpose().inverse() * external_Nm);
    }
    decide(leg, gait[leg], motion[leg]);
  }
}

void ContactEstimator::decide(std::size_t leg, const GaitPhase& gait, const FootMotion& motion) {
  FootContact& foot = feet_[leg];
  const double force_N = foot.force_O_N[2];
  const bool may_touch = gait.stance_planned || gait.swing_progress >= config_.earliest_swing_phase;
  bool next = foot.in_contact;
  if (!may_touch) {
    next = false;
    confirmations_[leg] = 0;
  } else {
    const bool stopped = motion.vertical_velocity_O_m_s > -config_.max_touchdown_speed_m_s;
    const bool expected = gait.height_above_landing_m < config_.expected_height_m;
    const double needed_N = expected ? config_.touchdown_force_N : config_.surprise_force_N;
    const bool disagrees =
        foot.in_contact ? force_N < config_.lift_off_force_N : stopped && force_N > needed_N;
    confirmations_[leg] = disagrees ? confirmations_[leg] + 1 : 0;
    if (confirmations_[leg] >= config_.confirm_ticks) {
      next = !foot.in_contact;
      confirmations_[leg] = 0;
    }
  }
  foot.ticks_since_change = next == foot.in_contact ? foot.ticks_since_change + 1 : 0;
  foot.in_contact = next;
}

}  // namespace surefoot::estimation
