// Splits a wanted body wrench over the feet that stand: a small convex QP on fixed memory.
//
//   minimise  |W^(1/2) (A f - w)|^2 + effort |f|^2 + change |f - f_last|^2
//   subject to, per foot:  |fx| <= mu fz, |fy| <= mu fz, fz_min <= fz <= fz_max
//
// with A the sum of forces and of moments about the trunk (Focchi et al., Autonomous Robots 2017,
// eq. 3-6). Solved by ADMM with the split on a copy of the forces that is projected exactly onto
// each foot's truncated pyramid (Boyd et al. 2011, section 5.2): the result is feasible at any
// iteration, one Cholesky factor per call, a fixed number of iterations, no data-dependent branch
// on convergence. Feet without contact get zero force.
//
// Cost: one 12x12 factorisation and kIterations solves. Memory: < 4 kB. Units: N, N m, O axes.
#pragma once

#include <array>

#include "core/control/config.h"
#include "core/math/linear.h"
#include "core/robot/robot_model.h"

namespace surefoot::control {

struct ForceProblem {
  Vector6 wrench_O;  // force on the robot [N], moment about the trunk's origin [N m]
  std::array<Vector3, robot::kLegs> lever_O_m;  // trunk origin to contact point
  std::array<bool, robot::kLegs> in_contact{};
};

struct ForceSolution {
  std::array<Vector3, robot::kLegs> force_O_N;  // ground on foot
  double residual_N = 0;  // largest disagreement of the two copies at the end: convergence measure
};

class ForceDistribution {
 public:
  static constexpr int kIterations = 60;

  void reset(const ForceConfig& config);
  const ForceSolution& solve(const ForceProblem& problem);

 private:
  using Forces = Eigen::Matrix<double, 12, 1>;
  using Hessian = Eigen::Matrix<double, 12, 12>;

  ForceConfig config_;
  Forces split_ = Forces::Zero();  // feasible copy, kept as warm start
  Forces dual_ = Forces::Zero();
  ForceSolution solution_;
};

// The nearest point of { |x|, |y| <= mu z, low <= z <= high } to f (exact).
Vector3 project_onto_pyramid(const Vector3& f, double mu, double low, double high);

}  // namespace surefoot::control
