#include "core/control/foot_force_qp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "core/base/random.h"
#include "core/control/friction_pyramid.h"
#include "tests/support/samples.h"

namespace surefoot::control {
namespace {

using Forces = FootForceQp::Forces;
using Hessian = FootForceQp::Hessian;

struct Problem {
  Hessian hessian = Hessian::Zero();
  Forces linear = Forces::Zero();
  double smallest = 0;
  std::array<bool, 4> in_contact{};
  FootForceLimits limits;
};

// As whole-body control makes them: f near a reference, six relaxations of a trunk.
Problem random_problem(Random& random, std::size_t contacts, double relaxation_weight) {
  Problem p;
  p.smallest = 1.0;
  p.limits = {random.uniform(0.2, 0.9), random.below(2) == 0 ? 0.0 : 5.0, 150.0};
  Eigen::Matrix<double, 6, 12> b = Eigen::Matrix<double, 6, 12>::Zero();
  std::array<std::size_t, 4> order{0, 1, 2, 3};
  for (std::uint32_t i = 3; i > 0; --i) std::swap(order[i], order[random.below(i + 1)]);
  for (std::size_t i = 0; i < contacts; ++i) p.in_contact[order[i]] = true;
  Forces reference = Forces::Zero();
  for (std::size_t leg = 0; leg < 4; ++leg) {
    if (!p.in_contact[leg]) continue;
    const auto column = static_cast<Eigen::Index>(3 * leg);
    const double x = robot::front_sign(leg) * 0.19 + random.uniform(-0.1, 0.1);
    const double y = robot::left_sign(leg) * 0.11 + random.uniform(-0.05, 0.05);
    const double z = random.uniform(-0.35, -0.2);
    const Vector3 r(x, y, z);
    const Vector3 inverse_inertia(1 / 0.07, 1 / 0.26, 1 / 0.242);
    for (int i = 0; i < 3; ++i) {
      b.block<3, 1>(0, column + i) =
          r.cross(Vector3(Vector3::Unit(i))).cwiseProduct(inverse_inertia);
      b(3 + i, column + i) = 1 / 8.9;
    }
    reference.segment<3>(column) =
        Vector3{random.uniform(-30, 30), random.uniform(-30, 30), random.uniform(-30, 170)};
  }
  Vector6 d;
  for (int i = 0; i < 6; ++i) d[i] = random.uniform(-30, 30);
  p.hessian = relaxation_weight * b.transpose() * b + Hessian::Identity();
  p.linear = reference + relaxation_weight * b.transpose() * d;
  return p;
}

double cost(const Problem& p, const Forces& f) {
  return 0.5 * f.dot(p.hessian * f) - p.linear.dot(f);
}

double violation(const Problem& p, const Forces& f) {
  double worst = 0;
  for (std::size_t leg = 0; leg < 4; ++leg) {
    const Vector3 x = f.segment<3>(static_cast<Eigen::Index>(3 * leg));
    if (!p.in_contact[leg]) {
      worst = std::max(worst, x.norm());
      continue;
    }
    const double side = p.limits.friction * x[2];
    worst = std::max({worst, std::fabs(x[0]) - side, std::fabs(x[1]) - side,
                      p.limits.min_normal_N - x[2], x[2] - p.limits.max_normal_N});
  }
  return worst;
}

// Exact: every face of the product of pyramids is tried (27 per foot), the best feasible stationary
// point of a face is the solution.
Forces enumerate(const Problem& p) {
  std::vector<std::size_t> feet;
  for (std::size_t leg = 0; leg < 4; ++leg) {
    if (p.in_contact[leg]) feet.push_back(leg);
  }
  std::size_t faces = 1;
  for (std::size_t i = 0; i < feet.size(); ++i) faces *= 27;
  Forces best = Forces::Zero();
  double least = 1e300;
  for (std::size_t face = 0; face < faces; ++face) {
    Eigen::MatrixXd map = Eigen::MatrixXd::Zero(12, 12);
    Forces offset = Forces::Zero();
    int columns = 0;
    std::size_t code = face;
    for (const std::size_t leg : feet) {
      const auto row = static_cast<Eigen::Index>(3 * leg);
      const int x = static_cast<int>(code % 3) - 1;
      const int y = static_cast<int>(code / 3 % 3) - 1;
      const int z = static_cast<int>(code / 9 % 3);
      code /= 27;
      const Vector3 edge(x * p.limits.friction, y * p.limits.friction, 1.0);
      if (x == 0) map(row, columns++) = 1;
      if (y == 0) map(row + 1, columns++) = 1;
      if (z == 0) map.block<3, 1>(row, columns++) = edge;
      if (z == 1) offset.segment<3>(row) = edge * p.limits.min_normal_N;
      if (z == 2) offset.segment<3>(row) = edge * p.limits.max_normal_N;
    }
    const Eigen::MatrixXd t = map.leftCols(columns);
    Forces f = offset;
    if (columns > 0) {
      const Eigen::MatrixXd h = t.transpose() * p.hessian * t;
      const Eigen::VectorXd g = t.transpose() * (p.linear - p.hessian * offset);
      f += t * h.ldlt().solve(g);
    }
    if (violation(p, f) > 1e-9) continue;
    if (cost(p, f) < least) {
      least = cost(p, f);
      best = f;
    }
  }
  return best;
}

// How far f is from the projection of a gradient step from it: 0 exactly at the solution. The error
// of f is at most (1 + step * largest eigenvalue) / (step * smallest) times this.
double natural_residual(const Problem& p, const Forces& f) {
  Forces stepped = f - (p.hessian * f - p.linear);
  for (std::size_t leg = 0; leg < 4; ++leg) {
    auto x = stepped.segment<3>(static_cast<Eigen::Index>(3 * leg));
    if (!p.in_contact[leg]) {
      x.setZero();
      continue;
    }
    FrictionPyramid<double>(p.limits.friction)
        .project(x[0], x[1], x[2], p.limits.min_normal_N, p.limits.max_normal_N);
  }
  return (stepped - f).norm();
}

// The weights of the configuration.
TEST(FootForceQp, AgreesWithTheEnumerationOfAllFaces) {
  Random random(1);
  double worst_N = 0;
  for (int trial = 0; trial < tests::samples(1500, 100); ++trial) {
    const std::size_t contacts = 1 + random.below(2);
    const Problem p = random_problem(random, contacts, 0.1);
    FootForceQp qp;
    qp.reset();
    const Forces f = qp.solve(p.hessian, p.linear, p.smallest, p.in_contact, p.limits);
    worst_N = std::max(worst_N, (f - enumerate(p)).norm());
  }
  std::printf("one or two feet, cold start, worst error %.2e N\n", worst_N);
  EXPECT_LT(worst_N, 1e-4);
}

TEST(FootForceQp, ThreeAndFourFeetAreOptimal) {
  Random random(2);
  double worst_N = 0;
  for (int trial = 0; trial < tests::samples(5000, 500); ++trial) {
    const std::size_t contacts = 3 + random.below(2);
    const Problem p = random_problem(random, contacts, 0.1);
    FootForceQp qp;
    qp.reset();
    const Forces f = qp.solve(p.hessian, p.linear, p.smallest, p.in_contact, p.limits);
    ASSERT_LT(violation(p, f), 1e-9);
    // Eigenvalues 1 to about 25.
    worst_N = std::max(worst_N, 26 * natural_residual(p, f));
  }
  std::printf("three or four feet, cold start, bound of the worst error %.2e N\n", worst_N);
  EXPECT_LT(worst_N, 1e-3);
}

// The trunk's acceleration weighs up to a thousand times more, up to where 50 iterations are too
// few: forces stay feasible, and the residual tells.
TEST(FootForceQp, TheResidualTellsWhenIllConditionedProblemsHaveNotSettled) {
  Random random(3);
  const int trials = tests::samples(300, 30);
  constexpr double kWeights[] = {0.1, 0.4, 1.6, 6.4, 25.6, 100.0};
  int settled = 0;
  for (const double weight : kWeights) {
    double worst_N = 0;
    double trusted_N = 0;
    int low = 0;
    for (int trial = 0; trial < trials; ++trial) {
      const std::size_t contacts = 1 + random.below(2);
      const Problem p = random_problem(random, contacts, weight);
      FootForceQp qp;
      qp.reset();
      const Forces f = qp.solve(p.hessian, p.linear, p.smallest, p.in_contact, p.limits);
      ASSERT_LT(violation(p, f), 1e-9);
      const double error_N = (f - enumerate(p)).norm();
      worst_N = std::max(worst_N, error_N);
      if (qp.residual_N() > 0.1) continue;
      trusted_N = std::max(trusted_N, error_N);
      ++low;
    }
    std::printf("weight %5.1f: worst error %.1e N, of %d with a residual below 0.1 N %.1e N\n",
                weight, worst_N, low, trusted_N);
    settled += low;
  }
  EXPECT_GT(settled, 2 * trials);
  EXPECT_LT(settled, 6 * trials - trials / 3);
}

}  // namespace
}  // namespace surefoot::control
