// Prioritised least squares over the 18 generalised velocities (or accelerations, or steps): each
// task is met as far as the tasks before it leave room.
//
// The recursion of Kim et al. 2019 (eq. 16 to 22), with J the task's Jacobian,
//
//   x_k = x_{k-1} + J+_{k|pre} (e_k - J_k x_{k-1}),   J_{k|pre} = J_k N_{k-1},
//   N_k = N_{k-1} (I - J+_{k|pre} J_{k|pre}),          J+ = W J' (J W J')^-1,
//
// W = I for steps and velocities (pseudo-inverse), W = M^-1 for accelerations (dynamically
// consistent inverse). It is carried out on P = N W: since N W = W N' = N W N',
//
//   J_{k|pre} W J_{k|pre}' = J P J',  W J_{k|pre}' = P J',  P_k = P - P J' (J P J')^-1 J P,
//
// so that a task of three rows costs one 18 x 18 update of rank 3 instead of products of 18 x 18
// matrices. The rows of a task are taken one at a time, the one with the largest pivot d = j P j'
// first (an L D L' factorisation of J P J' with pivoting). A pivot below `singular` is a direction
// that the robot hardly has left: its gain is damped (Nakamura and Hanafusa 1986: none at
// `singular`, full at 0) for what is commanded, and the direction is closed to later tasks all the
// same.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/math/linear.h"
#include "core/robot/dynamics.h"

namespace surefoot::control {

// Three rows of Jacobian: the trunk's six columns and those of one leg.
struct TaskRows {
  static constexpr std::size_t kNoLeg = robot::kLegs;

  Eigen::Matrix<double, 3, 6> trunk = Eigen::Matrix<double, 3, 6>::Zero();
  std::size_t leg = kNoLeg;
  Matrix3 joints = Matrix3::Zero();
};

class TaskPriority {
 public:
  static constexpr int kTargets = 2;  // unknown vectors solved for at once
  using Targets = Eigen::Matrix<double, 3, kTargets>;
  using Solution = Eigen::Matrix<double, robot::kVelocities, kTargets>;

  // metric: W, symmetric positive definite. singular: pivot below which gains are damped.
  void reset(const robot::MassMatrix& metric, double singular);
  void add(const TaskRows& task, const Targets& targets);

  const Solution& solution() const { return x_; }
  std::uint32_t damped_rows() const { return damped_rows_; }

 private:
  double gain(double pivot);

  robot::MassMatrix room_;  // P
  Solution x_;
  double singular_ = 0;
  std::uint32_t damped_rows_ = 0;
};

}  // namespace surefoot::control
