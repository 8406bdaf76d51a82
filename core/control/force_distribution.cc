#include "core/control/force_distribution.h"

#include <Eigen/Cholesky>

#include "core/control/friction_pyramid.h"
#include "core/math/elementary.h"

namespace surefoot::control {
namespace {

// Penalty of the split. The Hessian's eigenvalues lie between effort + change (about 0.02) and
// about 10; their geometric mean converges fastest (measured in tests/unit/control).
constexpr double kPenalty = 0.4;
constexpr double kOverRelaxation = 1.6;

Eigen::Matrix<double, 6, 12> wrench_matrix(const ForceProblem& problem) {
  Eigen::Matrix<double, 6, 12> a;
  a.setZero();
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    if (!problem.in_contact[leg]) continue;
    const auto column = static_cast<Eigen::Index>(3 * leg);
    const Vector3& r = problem.lever_O_m[leg];
    a.block<3, 3>(0, column).setIdentity();
    a(3, column + 1) = -r[2];
    a(3, column + 2) = r[1];
    a(4, column) = r[2];
    a(4, column + 2) = -r[0];
    a(5, column) = -r[1];
    a(5, column + 1) = r[0];
  }
  return a;
}

}  // namespace

Vector3 project_onto_pyramid(const Vector3& f, double mu, double low, double high) {
  Vector3 nearest = f;
  FrictionPyramid<double>(mu).project(nearest[0], nearest[1], nearest[2], low, high);
  return nearest;
}

void ForceDistribution::reset(const ForceConfig& config) {
  config_ = config;
  split_.setZero();
  dual_.setZero();
  solution_ = ForceSolution{};
}

const ForceSolution& ForceDistribution::solve(const ForceProblem& problem) {
  const Eigen::Matrix<double, 6, 12> a = wrench_matrix(problem);
  Vector6 weight;
  weight << config_.force_weight[0], config_.force_weight[1], config_.force_weight[2],
      config_.moment_weight[0], config_.moment_weight[1], config_.moment_weight[2];
  const Eigen::Matrix<double, 12, 6> weighted = a.transpose() * weight.asDiagonal();
  Hessian hessian = weighted * a;
  const double regularisation = config_.effort_weight + config_.change_weight;
  for (int i = 0; i < 12; ++i) hessian(i, i) += regularisation + kPenalty;
  Forces last = Forces::Zero();
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    last.segment<3>(static_cast<Eigen::Index>(3 * leg)) = solution_.force_O_N[leg];
  }
  const Forces linear = weighted * problem.wrench_O + last * config_.change_weight;
  const Eigen::LLT<Hessian> factor(hessian);

  Forces forces = split_;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    forces = factor.solve(linear + (split_ - dual_) * kPenalty);
    const Forces relaxed = forces * kOverRelaxation + split_ * (1.0 - kOverRelaxation);
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      const auto row = static_cast<Eigen::Index>(3 * leg);
      if (!problem.in_contact[leg]) {
        split_.segment<3>(row).setZero();
        dual_.segment<3>(row).setZero();
        continue;
      }
      const Vector3 point = relaxed.segment<3>(row) + dual_.segment<3>(row);
      split_.segment<3>(row) =
          project_onto_pyramid(point, config_.friction, config_.min_normal_N, config_.max_normal_N);
      dual_.segment<3>(row) = point - split_.segment<3>(row);
    }
  }
  solution_.residual_N = 0;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const auto row = static_cast<Eigen::Index>(3 * leg);
    solution_.force_O_N[leg] = split_.segment<3>(row);
    if (!problem.in_contact[leg]) continue;
    const Vector3 gap = forces.segment<3>(row) - split_.segment<3>(row);
    const double size = math::sqrt(gap.squaredNorm());
    if (size > solution_.residual_N) solution_.residual_N = size;
  }
  return solution_;
}

}  // namespace surefoot::control
