#include "core/control/whole_body.h"

#include <Eigen/Cholesky>

#include "core/control/friction_pyramid.h"
#include "core/geometry/rotations.h"
#include "core/math/elementary.h"
#include "core/math/gravity.h"

namespace surefoot::control {
namespace {

using robot::GeneralisedVector;
using robot::kLegs;
using robot::velocity_row;

constexpr double kLargestAngle_rad = 100.0;  // beyond any joint's turns
constexpr double kLargestNumber = 1e6;       // in any unit of a task
constexpr double kLargestResult = 1e30;
constexpr double kRotationTolerance = 1e-3;
// A foot's Jacobian counts as singular when a joint turn of 1 rad moves it less than this share of
// the leg's length in some direction: a knee within 0.1 rad of straight.
constexpr double kSingularShare = 0.025;

// Numbers that a robot can have, so that nothing can overflow. False for NaN.
template <class Derived>
bool sane(const Eigen::MatrixBase<Derived>& m, double largest) {
  for (Eigen::Index i = 0; i < m.cols(); ++i) {
    for (Eigen::Index j = 0; j < m.rows(); ++j) {
      if (!(m(j, i) <= largest && m(j, i) >= -largest)) return false;
    }
  }
  return true;
}

bool usable(const WholeBodyState& state) {
  return sane(state.q_rad, kLargestAngle_rad) && sane(state.qd_rad_s, kLargestNumber) &&
         sane(state.p_OB_m, kLargestNumber) && sane(state.v_OB_m_s, kLargestNumber) &&
         sane(state.angular_velocity_B_rad_s, kLargestNumber) &&
         geometry::is_rotation(state.R_OB, kRotationTolerance);
}

bool usable(const BodyTask& body) {
  return sane(body.p_OB_m, kLargestNumber) && sane(body.v_OB_m_s, kLargestNumber) &&
         sane(body.a_OB_m_s2, kLargestNumber) &&
         geometry::is_rotation(body.R_OB, kRotationTolerance) &&
         sane(body.angular_velocity_O_rad_s, kLargestNumber) &&
         sane(body.angular_acceleration_O_rad_s2, kLargestNumber);
}

// What the leg's mode does not use is not looked at.
bool usable(const LegTasks& legs) {
  for (const LegTask& leg : legs) {
    const bool good = leg.in_contact ? sane(leg.force_O_N, kLargestNumber)
                                     : sane(leg.position_O_m, kLargestNumber) &&
                                           sane(leg.velocity_O_m_s, kLargestNumber) &&
                                           sane(leg.acceleration_O_m_s2, kLargestNumber);
    if (!good) return false;
  }
  return true;
}

Vector3 vector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

// Force at p (axes of B) as moment and force on the trunk, from axes of O.
robot::Matrix6x3 wrench_of_force(const Vector3& p_B_m, const Matrix3& R_BO) {
  robot::Matrix6x3 map;
  map.topRows<3>() = geometry::cross_matrix(p_B_m) * R_BO;
  map.bottomRows<3>() = R_BO;
  return map;
}

TaskRows trunk_rows(Eigen::Index first) {
  TaskRows rows;
  rows.trunk.block<3, 3>(0, first).setIdentity();
  return rows;
}

}  // namespace

WholeBodyState whole_body_state(const estimation::RobotState& state) {
  WholeBodyState result;
  result.p_OB_m = state.p_OB_m;
  result.v_OB_m_s = state.v_OB_m_s;
  result.R_OB = state.R_OB;
  result.angular_velocity_B_rad_s = state.angular_velocity_B_rad_s;
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    const auto row = static_cast<Eigen::Index>(joint);
    result.q_rad[row] = state.joints[joint].position_rad;
    result.qd_rad_s[row] = state.joints[joint].velocity_rad_s;
  }
  return result;
}

void WholeBody::reset(const WholeBodyConfig& config, const robot::RobotModel& model) {
  config_ = config;
  model_ = model;
  singular_m2_ = math::square(kSingularShare * (model.thigh_length_m + model.shank_length_m));
  dynamics_.reset(model);
  qp_.reset();
  command_ = WholeBodyCommand{};
  command_.force_O_N.fill(Vector3::Zero());
  counters_ = WholeBodyCounters{};
}

const WholeBodyCommand& WholeBody::update(const WholeBodyState& state, const BodyTask& body,
                                          const LegTasks& legs) {
  ++counters_.calls;
  const robot::JointVector last_rad = command_.q_rad;
  const bool good = usable(state) && usable(body) && usable(legs) && solve(state, body, legs);
  if (!good) fall_back(state, last_rad);
  return command_;
}

// false: no result that could be used.
bool WholeBody::solve(const WholeBodyState& state, const BodyTask& body, const LegTasks& legs) {
  observe(state, legs);
  if (!factor_.factor(mass_)) return false;
  bias_ = dynamics_.bias();
  plan_steps(state, body, legs);
  const std::uint32_t damped_steps = priority_.damped_rows();
  // The same singularity in units of the accelerations' metric: 1 / mass.
  double largest_kg_m2 = 0;
  for (int i = 6; i < robot::kVelocities; ++i) {
    if (mass_(i, i) > largest_kg_m2) largest_kg_m2 = mass_(i, i);
  }
  plan_accelerations(state, body, legs, singular_m2_ / largest_kg_m2);
  if (damped_steps + priority_.damped_rows() > 0) ++counters_.damped;
  find_forces(legs);
  find_torques(legs);
  bool good = sane(command_.q_rad, kLargestResult) && sane(command_.qd_rad_s, kLargestResult) &&
              sane(command_.torque_Nm, kLargestResult) &&
              sane(command_.acceleration, kLargestResult) &&
              sane(command_.relaxation, kLargestResult);
  for (const Vector3& force : command_.force_O_N) good = good && sane(force, kLargestResult);
  if (good) limit(state);
  return good;
}

void WholeBody::observe(const WholeBodyState& state, const LegTasks& legs) {
  R_BO_ = state.R_OB.transpose();
  robot::MotionState motion;
  motion.R_OB = state.R_OB;
  motion.q_rad = state.q_rad;
  motion.velocity.head<3>() = state.angular_velocity_B_rad_s;
  motion.velocity.segment<3>(3) = R_BO_ * state.v_OB_m_s;
  motion.velocity.tail<12>() = state.qd_rad_s;
  dynamics_.update(motion);
  dynamics_.mass_matrix(mass_);
  flight_ = true;
  const Vector3 to_contact_B = R_BO_ * Vector3(0.0, 0.0, -model_.foot_radius_m);
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    if (legs[leg].in_contact) flight_ = false;
    points_[leg] = dynamics_.foot(leg, legs[leg].in_contact ? to_contact_B : Vector3::Zero());
  }
}

TaskRows WholeBody::foot_rows(std::size_t leg) const {
  TaskRows rows;
  rows.trunk.leftCols<3>() = -geometry::cross_matrix(points_[leg].p_B_m);
  rows.trunk.rightCols<3>().setIdentity();
  rows.leg = leg;
  rows.joints = points_[leg].jacobian_B;
  return rows;
}

// Eq. 16 and 17: steps (column 0) and velocities (column 1) from the tasks' errors and velocities,
// all in axes of B.
void WholeBody::plan_steps(const WholeBodyState& state, const BodyTask& body,
                           const LegTasks& legs) {
  metric_.setIdentity();
  priority_.reset(metric_, singular_m2_);
  TaskPriority::Targets targets = TaskPriority::Targets::Zero();
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    if (legs[leg].in_contact) priority_.add(foot_rows(leg), targets);
  }
  const robot::Motion& trunk = dynamics_.link_velocity_B(0);
  targets.col(0) = geometry::to_rotation_vector(R_BO_ * body.R_OB);
  targets.col(1) = R_BO_ * body.angular_velocity_O_rad_s;
  if (flight_) targets << Vector3::Zero(), trunk.angular;
  priority_.add(trunk_rows(0), targets);
  targets.col(0) = R_BO_ * (body.p_OB_m - state.p_OB_m);
  targets.col(1) = R_BO_ * body.v_OB_m_s;
  if (flight_) targets << Vector3::Zero(), trunk.linear;
  priority_.add(trunk_rows(3), targets);
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    if (legs[leg].in_contact) continue;
    targets.col(0) = R_BO_ * (legs[leg].position_O_m - state.p_OB_m) - points_[leg].p_B_m;
    targets.col(1) = R_BO_ * legs[leg].velocity_O_m_s;
    priority_.add(foot_rows(leg), targets);
  }
  command_.q_rad = priority_.solution().col(0).tail<12>();  // steps yet: limit() adds the angles
  command_.qd_rad_s = priority_.solution().col(1).tail<12>();
}

// Eq. 18 with the task accelerations of eq. 19. Left sides: J nu' = wanted - Jdot nu, axes of B.
void WholeBody::plan_accelerations(const WholeBodyState& state, const BodyTask& body,
                                   const LegTasks& legs, double singular) {
  factor_.inverse(metric_);
  priority_.reset(metric_, singular);
  TaskPriority::Targets targets = TaskPriority::Targets::Zero();
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    if (!legs[leg].in_contact) continue;
    targets.col(0) = -points_[leg].bias_B_m_s2;
    priority_.add(foot_rows(leg), targets);
  }
  const Vector3& w = state.angular_velocity_B_rad_s;
  const Vector3 turn = geometry::to_rotation_vector(R_BO_ * body.R_OB);
  const Vector3 spin = R_BO_ * body.angular_velocity_O_rad_s - w;
  targets.col(0) = R_BO_ * body.angular_acceleration_O_rad_s2 +
                   vector(config_.attitude_gain_1_s2).cwiseProduct(turn) +
                   vector(config_.rate_gain_1_s).cwiseProduct(spin);
  if (flight_) targets.setZero();
  priority_.add(trunk_rows(0), targets);
  const Vector3 wanted_O =
      body.a_OB_m_s2 + vector(config_.position_gain_1_s2).cwiseProduct(body.p_OB_m - state.p_OB_m) +
      vector(config_.velocity_gain_1_s).cwiseProduct(body.v_OB_m_s - state.v_OB_m_s);
  const Vector3 fall_O(0.0, 0.0, -kGravity_m_s2);
  // Of the numbers of v_B, in axes that turn (robot/dynamics.h).
  targets.col(0) = R_BO_ * (flight_ ? fall_O : wanted_O) - w.cross(R_BO_ * state.v_OB_m_s);
  priority_.add(trunk_rows(3), targets);
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    if (legs[leg].in_contact) continue;
    const LegTask& task = legs[leg];
    const Vector3 p_O = state.p_OB_m + state.R_OB * points_[leg].p_B_m;
    const Vector3 v_O = state.R_OB * points_[leg].v_B_m_s;
    const Vector3 a_O =
        task.acceleration_O_m_s2 +
        vector(config_.foot_position_gain_1_s2).cwiseProduct(task.position_O_m - p_O) +
        vector(config_.foot_velocity_gain_1_s).cwiseProduct(task.velocity_O_m_s - v_O);
    targets.col(0) = R_BO_ * a_O - points_[leg].bias_B_m_s2;
    priority_.add(foot_rows(leg), targets);
  }
  command_.acceleration = priority_.solution().col(0);
}

// Eq. 25 to 28. The trunk's six equations, M_ff (a + r) + ... = sum of wrenches, give the
// relaxation r = B f - d, so that only forces are unknown: |f - f_ref|^2 force_weight +
// |B f - d|^2 weights.
void WholeBody::find_forces(const LegTasks& legs) {
  using Map = Eigen::Matrix<double, 6, 12>;
  const Eigen::LLT<Matrix6> trunk(mass_.topLeftCorner<6, 6>());
  Vector6 weight;
  weight.head<3>().setConstant(config_.angular_relaxation_weight);
  weight.tail<3>().setConstant(config_.linear_relaxation_weight);
  const Vector6 wanted = mass_.topRows<6>() * command_.acceleration + bias_.head<6>();
  const Vector6 d = trunk.solve(wanted);
  Map b = Map::Zero();
  FootForceQp::Forces linear = FootForceQp::Forces::Zero();
  std::array<bool, kLegs> in_contact{};
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    in_contact[leg] = legs[leg].in_contact;
    if (!in_contact[leg]) continue;
    const auto column = static_cast<Eigen::Index>(3 * leg);
    const robot::Matrix6x3 wrench = wrench_of_force(points_[leg].p_B_m, R_BO_);
    for (int i = 0; i < 3; ++i) {
      const Vector6 one = wrench.col(i);
      b.col(column + i) = trunk.solve(one);
    }
    linear.segment<3>(column) = config_.force_weight * legs[leg].force_O_N;
  }
  const Eigen::Matrix<double, 12, 6> weighted = b.transpose() * weight.asDiagonal();
  linear += weighted * d;
  FootForceQp::Hessian hessian = weighted * b;
  for (int i = 0; i < 12; ++i) hessian(i, i) += config_.force_weight;
  FootForceQp::Forces forces = qp_.solve(hessian, linear, config_.force_weight, in_contact,
                                         {config_.friction, 0.0, config_.max_normal_N});
  if (!(qp_.residual_N() <= config_.max_residual_N)) {
    ++counters_.unsettled;
    if (!sane(forces, kLargestResult)) qp_.reset();
    forces = nearest_to_reference(legs);
  }
  command_.relaxation = b * forces - d;
  command_.acceleration.head<6>() += command_.relaxation;
  command_.force_residual_N = qp_.residual_N();
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    command_.force_O_N[leg] = forces.segment<3>(static_cast<Eigen::Index>(3 * leg));
  }
}

FootForceQp::Forces WholeBody::nearest_to_reference(const LegTasks& legs) const {
  const FrictionPyramid<double> pyramid(config_.friction);
  FootForceQp::Forces forces = FootForceQp::Forces::Zero();
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    if (!legs[leg].in_contact) continue;
    Vector3 force = legs[leg].force_O_N;
    pyramid.project(force[0], force[1], force[2], 0.0, config_.max_normal_N);
    forces.segment<3>(static_cast<Eigen::Index>(3 * leg)) = force;
  }
  return forces;
}

// Eq. 29: the joints' rows of M nu' + C nu + g - J' f.
void WholeBody::find_torques(const LegTasks& legs) {
  for (std::size_t leg = 0; leg < kLegs; ++leg) {
    const Eigen::Index row = velocity_row(leg);
    Vector3 torque = bias_.segment<3>(row) +
                     mass_.block<3, 6>(row, 0) * command_.acceleration.head<6>() +
                     mass_.block<3, 3>(row, row) * command_.acceleration.segment<3>(row);
    if (legs[leg].in_contact) {
      torque -= points_[leg].jacobian_B.transpose() * (R_BO_ * command_.force_O_N[leg]);
    }
    command_.torque_Nm.segment<3>(row - 6) = torque;
  }
}

void WholeBody::limit(const WholeBodyState& state) {
  bool angle_limited = false;
  bool torque_limited = false;
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    const robot::Actuator& actuator = model_.actuators[joint % robot::kJointsPerLeg];
    const auto i = static_cast<Eigen::Index>(joint);
    const double step =
        math::clamp(command_.q_rad[i], -config_.max_joint_step_rad, config_.max_joint_step_rad);
    const robot::JointRange range = model_.joint_range(joint);
    const double q = math::clamp(state.q_rad[i] + step, range.min_rad, range.max_rad);
    angle_limited = angle_limited || q != state.q_rad[i] + command_.q_rad[i];
    command_.q_rad[i] = q;
    command_.qd_rad_s[i] = math::clamp(command_.qd_rad_s[i], -actuator.no_load_speed_rad_s,
                                       actuator.no_load_speed_rad_s);
    const double torque =
        math::clamp(command_.torque_Nm[i], -actuator.torque_limit_Nm, actuator.torque_limit_Nm);
    torque_limited = torque_limited || torque != command_.torque_Nm[i];
    command_.torque_Nm[i] = torque;
  }
  if (angle_limited) ++counters_.angle_limited;
  if (torque_limited) ++counters_.torque_limited;
}

// Holds the present angles, and where these are no numbers the last ones.
void WholeBody::fall_back(const WholeBodyState& state, const robot::JointVector& last_rad) {
  ++counters_.refused;
  command_ = WholeBodyCommand{};
  command_.force_O_N.fill(Vector3::Zero());
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    const robot::JointRange range = model_.joint_range(joint);
    const auto i = static_cast<Eigen::Index>(joint);
    const double q =
        sane(state.q_rad.segment<1>(i), kLargestAngle_rad) ? state.q_rad[i] : last_rad[i];
    command_.q_rad[i] = math::clamp(q, range.min_rad, range.max_rad);
  }
  qp_.reset();
}

}  // namespace surefoot::control
