#include "core/control/foot_force_qp.h"

#include "core/control/friction_pyramid.h"
#include "core/math/elementary.h"

namespace surefoot::control {
namespace {

constexpr double kOverRelaxation = 1.6;

// Gauss-Jordan in place, without pivoting: positive definite and well conditioned.
void invert(FootForceQp::Hessian& a) {
  for (int k = 0; k < 12; ++k) {
    const double scale = 1.0 / a(k, k);
    a(k, k) = 1.0;
    a.col(k) *= scale;
    for (int j = 0; j < 12; ++j) {
      if (j == k) continue;
      const double factor = a(k, j);
      a(k, j) = 0.0;
      a.col(j) -= factor * a.col(k);
    }
  }
}

}  // namespace

void FootForceQp::reset() {
  split_.setZero();
  dual_.setZero();
  residual_N_ = 0;
}

const FootForceQp::Forces& FootForceQp::solve(const Hessian& hessian, const Forces& linear,
                                              double smallest_eigenvalue,
                                              const std::array<bool, robot::kLegs>& in_contact,
                                              const FootForceLimits& limits) {
  // The Frobenius norm of what exceeds the smallest eigenvalue bounds the largest one.
  Hessian inverse = hessian;
  for (int i = 0; i < 12; ++i) inverse(i, i) -= smallest_eigenvalue;
  const double largest = smallest_eigenvalue + math::sqrt(inverse.squaredNorm());
  const double penalty = math::sqrt(smallest_eigenvalue * largest);
  for (int i = 0; i < 12; ++i) inverse(i, i) += smallest_eigenvalue + penalty;
  invert(inverse);
  const Forces offset = inverse * linear;
  const FrictionPyramid<double> pyramid(limits.friction);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    if (in_contact[leg]) continue;
    split_.segment<3>(static_cast<Eigen::Index>(3 * leg)).setZero();
    dual_.segment<3>(static_cast<Eigen::Index>(3 * leg)).setZero();
  }
  Forces forces = split_;
  Forces last = split_;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    last = split_;
    forces = offset + inverse * ((split_ - dual_) * penalty);
    const Forces point = forces * kOverRelaxation + split_ * (1.0 - kOverRelaxation) + dual_;
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      if (!in_contact[leg]) continue;
      const auto row = static_cast<Eigen::Index>(3 * leg);
      Vector3 nearest = point.segment<3>(row);
      pyramid.project(nearest[0], nearest[1], nearest[2], limits.min_normal_N, limits.max_normal_N);
      dual_.segment<3>(row) = point.segment<3>(row) - nearest;
      split_.segment<3>(row) = nearest;
    }
  }
  const double gap = math::sqrt((forces - split_).squaredNorm());
  const double change = math::sqrt((split_ - last).squaredNorm());
  residual_N_ = gap > change ? gap : change;
  return split_;
}

}  // namespace surefoot::control
