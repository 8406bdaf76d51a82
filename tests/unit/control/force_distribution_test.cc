#include "core/control/force_distribution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "tests/support/samples.h"

namespace surefoot::control {
namespace {

ForceConfig config() {
  ForceConfig c;
  c.friction = 0.4;
  c.min_normal_N = 8.0;
  c.max_normal_N = 150.0;
  c.force_weight = {1.0, 1.0, 2.0};
  c.moment_weight = {40.0, 40.0, 20.0};
  c.effort_weight = 0.005;
  c.change_weight = 0.01;
  return c;
}

bool feasible(const Vector3& f, const ForceConfig& c) {
  constexpr double kRounding = 1e-9;
  return std::fabs(f[0]) <= c.friction * f[2] + kRounding &&
         std::fabs(f[1]) <= c.friction * f[2] + kRounding && f[2] >= c.min_normal_N - kRounding &&
         f[2] <= c.max_normal_N + kRounding;
}

double cost(const ForceProblem& problem, const ForceConfig& c,
            const std::array<Vector3, 4>& forces) {
  Vector6 error = -problem.wrench_O;
  double effort = 0;
  for (std::size_t leg = 0; leg < 4; ++leg) {
    if (!problem.in_contact[leg]) continue;
    error.head<3>() += forces[leg];
    error.tail<3>() += problem.lever_O_m[leg].cross(forces[leg]);
    effort += forces[leg].squaredNorm();
  }
  double sum = (c.effort_weight + c.change_weight) * effort;
  for (std::size_t i = 0; i < 3; ++i) {
    sum += c.force_weight[i] * error[static_cast<Eigen::Index>(i)] *
           error[static_cast<Eigen::Index>(i)];
    sum += c.moment_weight[i] * error[static_cast<Eigen::Index>(i + 3)] *
           error[static_cast<Eigen::Index>(i + 3)];
  }
  return sum;
}

ForceProblem random_problem(Random& random) {
  ForceProblem problem;
  for (int i = 0; i < 6; ++i)
    problem.wrench_O[i] = random.uniform(-30.0, 30.0) * (i < 3 ? 1.0 : 0.3);
  problem.wrench_O[2] += 87.0;
  const int trot = static_cast<int>(random.below(3));
  for (std::size_t leg = 0; leg < 4; ++leg) {
    const bool diagonal = leg == 0 || leg == 3;
    problem.in_contact[leg] = trot == 0 || (trot == 1) == diagonal;
    const double x = random.uniform(-0.08, 0.08);
    const double y = random.uniform(-0.05, 0.05);
    const double z = random.uniform(-0.34, -0.22);
    problem.lever_O_m[leg] =
        Vector3(robot::front_sign(leg) * 0.19 + x, robot::left_sign(leg) * 0.115 + y, z);
  }
  return problem;
}

// An independent oracle: accelerated projected gradient with a tiny step until it stands still, its
// projection by bisection on z instead of the closed form.
Vector3 project_by_bisection(const Vector3& f, const ForceConfig& c) {
  double low = c.min_normal_N;
  double high = c.max_normal_N;
  const auto distance_slope = [&](double z) {
    const double x = std::max(0.0, std::fabs(f[0]) - c.friction * z);
    const double y = std::max(0.0, std::fabs(f[1]) - c.friction * z);
    return (z - f[2]) - c.friction * (x + y);
  };
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (distance_slope(middle) > 0.0 ? high : low) = middle;
  }
  const double z = 0.5 * (low + high);
  const double side = c.friction * z;
  return {std::clamp(f[0], -side, side), std::clamp(f[1], -side, side), z};
}

std::array<Vector3, 4> oracle(const ForceProblem& problem, const ForceConfig& c) {
  std::array<Vector3, 4> f;
  f.fill(Vector3::Zero());
  std::array<Vector3, 4> momentum = f;
  constexpr double kStep = 1.0 / 60.0;  // below 1 / (2 * largest eigenvalue)
  double t = 1.0;
  for (int iteration = 0; iteration < 20000; ++iteration) {
    Vector6 error = -problem.wrench_O;
    for (std::size_t leg = 0; leg < 4; ++leg) {
      if (!problem.in_contact[leg]) continue;
      error.head<3>() += momentum[leg];
      error.tail<3>() += problem.lever_O_m[leg].cross(momentum[leg]);
    }
    Vector3 force_error(error[0] * c.force_weight[0], error[1] * c.force_weight[1],
                        error[2] * c.force_weight[2]);
    Vector3 moment_error(error[3] * c.moment_weight[0], error[4] * c.moment_weight[1],
                         error[5] * c.moment_weight[2]);
    const double next_t = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * t * t));
    for (std::size_t leg = 0; leg < 4; ++leg) {
      if (!problem.in_contact[leg]) continue;
      const Vector3 gradient = force_error + moment_error.cross(problem.lever_O_m[leg]) +
                               momentum[leg] * (c.effort_weight + c.change_weight);
      const Vector3 next = project_by_bisection(momentum[leg] - gradient * kStep, c);
      momentum[leg] = next + (next - f[leg]) * ((t - 1.0) / next_t);
      f[leg] = next;
    }
    t = next_t;
  }
  return f;
}

TEST(Projection, IsTheNearestPointOfThePyramid) {
  const ForceConfig c = config();
  Random random(7);
  for (int trial = 0; trial < 20000; ++trial) {
    Vector3 f;
    for (int i = 0; i < 3; ++i) f[i] = random.uniform(-200.0, 200.0);
    const Vector3 p = project_onto_pyramid(f, c.friction, c.min_normal_N, c.max_normal_N);
    ASSERT_TRUE(feasible(p, c)) << f.transpose();
    ASSERT_LT((p - project_by_bisection(f, c)).norm(), 1e-9) << f.transpose();
  }
}

TEST(ForceDistribution, AgreesWithAnExactSolver) {
  ForceConfig c = config();
  Random random(11);
  double worst_N = 0;
  for (int trial = 0; trial < tests::samples(60, 4); ++trial) {
    const ForceProblem problem = random_problem(random);
    ForceDistribution distribution;
    distribution.reset(c);
    const ForceSolution& solution = distribution.solve(problem);
    const auto exact = oracle(problem, c);
    for (std::size_t leg = 0; leg < 4; ++leg) {
      worst_N = std::max(worst_N, (solution.force_O_N[leg] - exact[leg]).norm());
    }
    EXPECT_LE(cost(problem, c, exact), cost(problem, c, solution.force_O_N) + 1e-6);
  }
  RecordProperty("worst_N", std::to_string(worst_N));
  std::printf("cold start, worst force error %.3f N\n", worst_N);
  EXPECT_LT(worst_N, 1.0);
}

TEST(ForceDistribution, IsAlwaysFeasibleAndSilentWithoutContact) {
  const ForceConfig c = config();
  Random random(13);
  ForceDistribution distribution;
  distribution.reset(c);
  for (int trial = 0; trial < 10000; ++trial) {
    ForceProblem problem = random_problem(random);
    for (std::size_t leg = 0; leg < 4; ++leg) {
      if (random.below(4) == 0) problem.in_contact[leg] = false;
    }
    const ForceSolution& solution = distribution.solve(problem);
    for (std::size_t leg = 0; leg < 4; ++leg) {
      if (problem.in_contact[leg]) {
        ASSERT_TRUE(feasible(solution.force_O_N[leg], c));
      } else {
        ASSERT_EQ(solution.force_O_N[leg].norm(), 0.0);
      }
    }
  }
}

TEST(ForceDistribution, StandingStillSharesTheWeightEvenly) {
  ForceDistribution distribution;
  distribution.reset(config());
  ForceProblem problem;
  problem.wrench_O << 0, 0, 87.4, 0, 0, 0;
  for (std::size_t leg = 0; leg < 4; ++leg) {
    problem.in_contact[leg] = true;
    problem.lever_O_m[leg] =
        Vector3(robot::front_sign(leg) * 0.19, robot::left_sign(leg) * 0.115, -0.29);
  }
  ForceSolution solution;
  for (int i = 0; i < 50; ++i) solution = distribution.solve(problem);
  for (const Vector3& force : solution.force_O_N) EXPECT_NEAR(force[2], 87.4 / 4, 0.1);
}

}  // namespace
}  // namespace surefoot::control
