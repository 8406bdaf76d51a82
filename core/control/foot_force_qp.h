// A small convex QP over the forces of four feet, each inside its friction pyramid:
//
//   minimise  1/2 f' H f - g' f
//   subject to, per foot:  |fx| <= mu fz, |fy| <= mu fz, fz_min <= fz <= fz_max
//
// ADMM with the split on a copy of the forces that is projected exactly onto each foot's truncated
// pyramid (Boyd et al. 2011, section 5.2): the copy that is returned is feasible after any
// iteration, one inverse per call, a fixed number of iterations, no branch on convergence. The
// penalty is the geometric mean of the ends of H's spectrum, where the iteration contracts by
// (sqrt(k) - 1) / (sqrt(k) + 1) or better, k the condition number.
//
// Feet without contact get zero force; their rows of H must couple with no other foot and their g
// must be zero. Warm start: the last solution. Memory: < 2 kB. Units: N.
#pragma once

#include <array>

#include "core/math/linear.h"
#include "core/robot/robot_model.h"

namespace surefoot::control {

struct FootForceLimits {
  double friction = 0;
  double min_normal_N = 0;
  double max_normal_N = 0;
};

class FootForceQp {
 public:
  static constexpr int kIterations = 50;
  using Forces = Eigen::Matrix<double, 12, 1>;
  using Hessian = Eigen::Matrix<double, 12, 12>;

  void reset();
  // hessian: symmetric, smallest_eigenvalue > 0 a lower bound of its spectrum.
  const Forces& solve(const Hessian& hessian, const Forces& linear, double smallest_eigenvalue,
                      const std::array<bool, robot::kLegs>& in_contact,
                      const FootForceLimits& limits);

  // How far the two copies, and the last two iterates, are apart: 0 at the solution.
  double residual_N() const { return residual_N_; }

 private:
  Forces split_ = Forces::Zero();  // feasible copy, kept as warm start
  Forces dual_ = Forces::Zero();
  double residual_N_ = 0;
};

}  // namespace surefoot::control
