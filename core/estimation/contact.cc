#include "core/estimation/contact.h"

#include "core/math/elementary.h"

namespace surefoot::estimation {
namespace {

// Inertia of the leg about each joint at a half-bent pose, rotors included: abduction turns the
// whole leg at about hip height, hip turns thigh and shank, knee the shank.
Vector3 diagonal_inertia(const robot::RobotModel& model) {
  const double half_leg = 0.35 * (model.thigh_length_m + model.shank_length_m);
  const double shank = model.shank.inertia_kg_m2[1] +
                       model.shank.mass_kg * math::square(model.shank.centre_of_mass_m[2]);
  const double thigh = model.thigh.inertia_kg_m2[1] +
                       model.thigh.mass_kg * math::square(model.thigh.centre_of_mass_m[2]);
  const double shank_at_hip = model.shank.mass_kg * math::square(half_leg);
  const double leg_mass = model.thigh.mass_kg + model.shank.mass_kg;
  const double sideways = leg_mass * math::square(model.hip_offset_m) + shank_at_hip;
  return {model.abad.inertia_kg_m2[0] + sideways + model.actuators[0].reflected_inertia_kg_m2(),
          thigh + shank_at_hip + model.actuators[1].reflected_inertia_kg_m2(),
          shank + model.actuators[2].reflected_inertia_kg_m2()};
}

}  // namespace

void ContactEstimator::reset(const ContactConfig& config, const robot::RobotModel& model,
                             double tick_s) {
  config_ = config;
  model_ = model;
  tick_s_ = tick_s;
  inertia_kg_m2_ = diagonal_inertia(model);
  started_ = false;
  confirmations_.fill(0);
  feet_.fill(FootContact{});
  integral_Nm_s_.fill(Vector3::Zero());
  residual_Nm_.fill(Vector3::Zero());
}

// One step of the observer for the joints of a leg: r follows the torque that the motors do not
// explain.
Vector3 ContactEstimator::external_torque_Nm(std::size_t leg, const Vector3& qd,
                                             const Vector3& torque) {
  const double gain = config_.observer_gain_1_s;
  const Vector3 momentum = inertia_kg_m2_.cwiseProduct(qd);
  if (!started_) integral_Nm_s_[leg] = momentum;
  Vector3 applied = torque;
  for (int i = 0; i < 3; ++i) {
    applied[i] -= model_.actuators[static_cast<std::size_t>(i)].viscous_friction_Nm_s * qd[i];
  }
  integral_Nm_s_[leg] += (applied + residual_Nm_[leg]) * tick_s_;
  residual_Nm_[leg] = (momentum - integral_Nm_s_[leg]) * gain;
  return residual_Nm_[leg];
}

void ContactEstimator::update(const std::array<actuation::JointState, robot::kJoints>& joints,
                              const std::array<GaitPhase, robot::kLegs>& gait,
                              const std::array<FootMotion, robot::kLegs>& motion,
                              const Matrix3& R_OB) {
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    Vector3 qd;
    Vector3 torque;
    for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
      const actuation::JointState& joint = joints[robot::joint_index(leg, i)];
      const auto row = static_cast<Eigen::Index>(i);
      qd[row] = joint.velocity_rad_s;
      torque[row] = joint.torque_Nm;
    }
    const Vector3 external = external_torque_Nm(leg, qd, torque);
    // J^T F = external. Near a straight knee J is singular: F is left as it was.
    const Matrix3& jacobian = motion[leg].jacobian_B;
    constexpr double kSmallestDeterminant_m3 = 1e-4;
    const double determinant = jacobian.determinant();
    if (determinant > kSmallestDeterminant_m3 || determinant < -kSmallestDeterminant_m3) {
      feet_[leg].force_O_N = R_OB * (jacobian.transpose().inverse() * external);
    }
    decide(leg, gait[leg], motion[leg]);
  }
  started_ = true;
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
