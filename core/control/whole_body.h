// Whole-body control after Kim, Di Carlo, Katz, Bledt, Kim: "Highly dynamic quadruped locomotion
// via whole-body impulse control and model predictive control" (2019); equation numbers are theirs.
//
// The predictive controller says which forces the feet should give, this one which torques do that
// while body and swing feet follow their tasks: 1. steps, velocities and accelerations of all
// joints by strict priority (contact feet stand still > body orientation > body position > swing
// feet), 2. the forces nearest to the reference ones that the trunk's dynamics and friction allow,
// 3. joint torques from the full dynamics, with joint angles and speeds for a soft PD.
//
// FRAMES. Everything in the task structs is in O's axes (positions from O's origin), except the
// state's angular velocity, which is in B like the estimator's. Forces are by the ground on the
// robot. Foot positions are centres of the foot spheres; the contact is taken one radius below, the
// friction pyramid about O's z. Attitudes are R_OB.
//
// Flight (no contact): nothing can move the trunk. Its tasks are left out; instead the feet reckon
// with its present velocity and free fall.
//
// The command is always finite, torques are within the actuators' limits, angles within the stops.
// Refused inputs (not a number, no rotation, beyond 1e6, a joint beyond 100 rad) give the fallback:
// the present joint angles (the last commanded where those are no numbers), speeds, torques and
// forces 0; counted in `refused`. Under the PD of the configuration the robot then sags softly;
// what follows is safety's decision. A QP that has not settled to max_residual_N gives way to the
// reference forces, each moved to the nearest point of its pyramid (`unsettled`); the equations of
// motion hold with these as well. A singular foot Jacobian (straight knee) damps what is commanded
// in the lost direction (`damped`).
//
// Memory: sizeof(WholeBody) 20 kB. Cost: no branch on data beyond contacts; tests/timing,
// cases whole_body_*.
#pragma once

#include <array>
#include <cstdint>

#include "core/control/foot_force_qp.h"
#include "core/control/task_priority.h"
#include "core/control/whole_body_config.h"
#include "core/estimation/estimator.h"
#include "core/robot/dynamics.h"

namespace surefoot::control {

struct WholeBodyState {
  Vector3 p_OB_m = Vector3::Zero();
  Vector3 v_OB_m_s = Vector3::Zero();
  Matrix3 R_OB = Matrix3::Identity();
  Vector3 angular_velocity_B_rad_s = Vector3::Zero();
  robot::JointVector q_rad = robot::JointVector::Zero();
  robot::JointVector qd_rad_s = robot::JointVector::Zero();
};

WholeBodyState whole_body_state(const estimation::RobotState& state);

// Where B should be, and how it should move there.
struct BodyTask {
  Vector3 p_OB_m = Vector3::Zero();
  Vector3 v_OB_m_s = Vector3::Zero();
  Vector3 a_OB_m_s2 = Vector3::Zero();
  Matrix3 R_OB = Matrix3::Identity();
  Vector3 angular_velocity_O_rad_s = Vector3::Zero();
  Vector3 angular_acceleration_O_rad_s2 = Vector3::Zero();
};

struct LegTask {
  bool in_contact = false;
  Vector3 force_O_N = Vector3::Zero();     // reference, used in contact
  Vector3 position_O_m = Vector3::Zero();  // of the foot's centre, used without contact
  Vector3 velocity_O_m_s = Vector3::Zero();
  Vector3 acceleration_O_m_s2 = Vector3::Zero();
};

using LegTasks = std::array<LegTask, robot::kLegs>;

struct WholeBodyCommand {
  robot::JointVector q_rad = robot::JointVector::Zero();
  robot::JointVector qd_rad_s = robot::JointVector::Zero();
  robot::JointVector torque_Nm = robot::JointVector::Zero();  // feed-forward
  std::array<Vector3, robot::kLegs> force_O_N{};              // expected, ground on foot
  // Expected generalised acceleration (robot/dynamics.h) and how far its trunk part is from the
  // commanded one.
  robot::GeneralisedVector acceleration = robot::GeneralisedVector::Zero();
  Vector6 relaxation = Vector6::Zero();
  double force_residual_N = 0;  // of the QP
};

// Calls since reset() in which something had to give way.
struct WholeBodyCounters {
  std::uint64_t calls = 0;
  std::uint64_t refused = 0;    // fallback
  std::uint64_t unsettled = 0;  // the QP: forces are the reference ones, in their pyramids
  std::uint64_t damped = 0;     // a task's direction was nearly singular
  std::uint64_t torque_limited = 0;
  std::uint64_t angle_limited = 0;  // step or stop
};

class WholeBody {
 public:
  void reset(const WholeBodyConfig& config, const robot::RobotModel& model);

  const WholeBodyCommand& update(const WholeBodyState& state, const BodyTask& body,
                                 const LegTasks& legs);

  const WholeBodyCommand& command() const { return command_; }
  const WholeBodyCounters& counters() const { return counters_; }
  const robot::Dynamics& dynamics() const { return dynamics_; }  // of the last call's state

 private:
  using Vector18 = robot::GeneralisedVector;

  bool solve(const WholeBodyState& state, const BodyTask& body, const LegTasks& legs);
  void observe(const WholeBodyState& state, const LegTasks& legs);
  void plan_steps(const WholeBodyState& state, const BodyTask& body, const LegTasks& legs);
  void plan_accelerations(const WholeBodyState& state, const BodyTask& body, const LegTasks& legs,
                          double singular);
  void find_forces(const LegTasks& legs);
  FootForceQp::Forces nearest_to_reference(const LegTasks& legs) const;
  void find_torques(const LegTasks& legs);
  void limit(const WholeBodyState& state);
  void fall_back(const WholeBodyState& state, const robot::JointVector& last_rad);
  TaskRows foot_rows(std::size_t leg) const;

  WholeBodyConfig config_;
  robot::RobotModel model_;
  double singular_m2_ = 0;  // pivot of steps and velocities below which they are damped
  robot::Dynamics dynamics_;
  robot::MassMatrix mass_;
  robot::MassMatrix metric_;
  robot::MassFactor factor_;
  Vector18 bias_;
  std::array<robot::PointMotion, robot::kLegs> points_;  // contact points, centres in swing
  Matrix3 R_BO_;
  bool flight_ = false;
  TaskPriority priority_;
  FootForceQp qp_;
  WholeBodyCommand command_;
  WholeBodyCounters counters_;
};

}  // namespace surefoot::control
