#include "core/control/convex_mpc.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "core/math/elementary.h"
#include "tests/support/mpc_oracle.h"
#include "tests/support/mpc_problems.h"
#include "tests/support/samples.h"

namespace surefoot::control {
namespace {

using tests::kMpcGaits;
using tests::mpc_config;
using tests::MpcGait;
using tests::random_mpc_problem;
using tests::samples;
using tests::violation_N;

std::unique_ptr<ConvexMpc> make(const MpcConfig& config) {
  auto mpc = std::make_unique<ConvexMpc>();
  mpc->reset(config);
  return mpc;
}

struct Comparison {
  double worst_N = 0;
  double worst_violation_N = 0;
  double worst_residual_N = 0;
  double worst_optimality = 0;  // of the oracle
  std::size_t fallbacks = 0;
};

Comparison compare(const MpcGait& gait, const MpcConfig& config, double disturbed, int count,
                   std::uint64_t seed) {
  Comparison result;
  Random random(seed);
  const auto mpc = make(config);
  for (int trial = 0; trial < count; ++trial) {
    MpcProblem problem = random_mpc_problem(random, gait, config, disturbed);
    problem.steps_since_last = kMpcHorizon;  // from a cold start: the hardest
    const MpcSolution& solution = mpc->solve(problem);
    const tests::MpcOracleSolution exact = tests::solve_exactly(problem, config);
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      const double error = (solution.force_O_N[0][leg] - exact.force_O_N[0][leg]).norm();
      result.worst_N = std::max(result.worst_N, error);
    }
    result.worst_violation_N =
        std::max(result.worst_violation_N, violation_N(problem, solution, config));
    result.worst_residual_N = std::max(result.worst_residual_N, solution.residual_N);
    result.worst_optimality = std::max(result.worst_optimality, exact.optimality);
  }
  result.fallbacks = mpc->solution().fallbacks;
  return result;
}

class EveryGait : public testing::TestWithParam<std::size_t> {};

// 7 gaits x 2 x 715 = 10,010 states.
TEST_P(EveryGait, AgreesWithAnExactSolver) {
  const MpcGait& gait = kMpcGaits[GetParam()];
  const MpcConfig config = mpc_config();
  for (const double disturbed : {0.0, 1.0}) {
    const Comparison result = compare(gait, config, disturbed, samples(715, 4), 100 + GetParam());
    std::printf("%-9s %s: worst error %.4f N, residual %.4f N\n", gait.name,
                disturbed > 0 ? "disturbed" : "nominal  ", result.worst_N, result.worst_residual_N);
    EXPECT_LT(result.worst_optimality, 1e-8) << "the oracle is not exact";
    EXPECT_LT(result.worst_N, 0.5);  // the bar is 1 N
    EXPECT_LE(result.worst_violation_N, 1e-12);
    EXPECT_EQ(result.fallbacks, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(Mpc, EveryGait, testing::Range<std::size_t>(0, kMpcGaits.size()),
                         [](const auto& entry) { return kMpcGaits[entry.param].name; });

TEST(ConvexMpc, AgreesForOtherStepsFrictionAndEffort) {
  struct Variant {
    double step_s;
    double friction;
    double effort;
  };
  for (const Variant& variant : {Variant{0.026, 0.6, 4e-5}, Variant{0.04, 0.4, 4e-5},
                                 Variant{0.03, 0.4, 1e-5}, Variant{0.03, 0.4, 2e-4}}) {
    MpcConfig config = mpc_config(variant.step_s);
    config.friction = variant.friction;
    config.effort_weight = variant.effort;
    for (const MpcGait& gait : kMpcGaits) {
      const Comparison result = compare(gait, config, 1.0, samples(20, 1), 7);
      EXPECT_LT(result.worst_N, 1.0)
          << gait.name << " " << variant.step_s << " " << variant.friction << " " << variant.effort;
      EXPECT_LE(result.worst_violation_N, 1e-12);
    }
  }
}

TEST(ConvexMpc, NoFeasiblePlanIsCheaper) {
  const MpcConfig config = mpc_config();
  const auto mpc = make(config);
  Random random(21);
  for (const MpcGait& gait : kMpcGaits) {
    const MpcProblem problem = random_mpc_problem(random, gait, config, 1.0);
    const MpcSolution solution = mpc->solve(problem);
    const double cost = tests::mpc_cost(problem, config, solution.force_O_N);
    for (int trial = 0; trial < samples(200, 4); ++trial) {
      MpcSolution other = solution;
      for (std::size_t k = 0; k < kMpcHorizon; ++k) {
        for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
          if (!problem.stands[k][leg]) continue;
          Vector3& f = other.force_O_N[k][leg];
          f += tests::normal_vector(random, 2.0, 2.0, 4.0);
          f[2] = std::clamp(f[2], config.min_normal_N, config.max_normal_N);
          const double side = config.friction * f[2];
          f[0] = std::clamp(f[0], -side, side);
          f[1] = std::clamp(f[1], -side, side);
        }
      }
      EXPECT_GE(tests::mpc_cost(problem, config, other.force_O_N), cost - 1e-9) << gait.name;
    }
  }
}

MpcProblem standing() {
  MpcProblem problem;
  problem.mass_kg = 9.0;
  problem.inertia_B_kg_m2 = Vector3(0.07, 0.26, 0.242).asDiagonal();
  problem.p_OB_m = Vector3(0.0, 0.0, 0.29);
  for (std::size_t k = 0; k < kMpcHorizon; ++k) {
    problem.reference[k].p_OB_m = problem.p_OB_m;
    problem.stands[k].fill(true);
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      problem.contact_O_m[k][leg] =
          Vector3(robot::front_sign(leg) * 0.19, robot::left_sign(leg) * 0.115, 0.0);
    }
  }
  return problem;
}

TEST(ConvexMpc, StandingStillCarriesTheWeight) {
  MpcConfig config = mpc_config();
  config.effort_weight = 1e-6;  // effort is what leaves a part of the weight uncarried
  const auto mpc = make(config);
  const MpcSolution& solution = mpc->solve(standing());
  EXPECT_EQ(solution.source, MpcSource::kSolved);
  for (const Vector3& force : solution.force_O_N[0]) {
    EXPECT_NEAR(force[2], 9.0 * 9.81 / 4.0, 0.3);
    EXPECT_NEAR(force.head<2>().norm(), 0.0, 0.2);
  }
  EXPECT_NEAR(solution.predicted[9].p_OB_m[2], 0.29, 0.002);
}

// Everything turned about z by a right angle gives the forces turned by it: weights are the same
// for x and y and the pyramids look the same, so nothing knows where north is.
TEST(ConvexMpc, DoesNotKnowWhereNorthIs) {
  const MpcConfig config = mpc_config();
  Random random(31);
  for (const MpcGait& gait : kMpcGaits) {
    const MpcProblem problem = random_mpc_problem(random, gait, config, 1.0);
    const double angle = 0.5 * math::kPi * (1.0 + random.below(3));
    const Matrix3 turn = geometry::rotation_z(angle);
    MpcProblem turned = problem;
    turned.R_OB = turn * problem.R_OB;
    turned.p_OB_m = turn * problem.p_OB_m;
    turned.v_OB_m_s = turn * problem.v_OB_m_s;
    turned.angular_velocity_O_rad_s = turn * problem.angular_velocity_O_rad_s;
    for (std::size_t k = 0; k < kMpcHorizon; ++k) {
      MpcState& reference = turned.reference[k];
      reference.p_OB_m = turn * reference.p_OB_m;
      reference.v_OB_m_s = turn * reference.v_OB_m_s;
      reference.roll_pitch_yaw_rad[2] += angle;
      for (Vector3& contact : turned.contact_O_m[k]) contact = turn * contact;
    }
    const MpcSolution a = make(config)->solve(problem);
    const MpcSolution b = make(config)->solve(turned);
    for (std::size_t k = 0; k < kMpcHorizon; ++k) {
      for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
        EXPECT_LT((turn * a.force_O_N[k][leg] - b.force_O_N[k][leg]).norm(), 0.02) << gait.name;
      }
    }
  }
}

// The predicted states are what Newton and Euler make of the forces, integrated in small steps.
TEST(ConvexMpc, PredictsWhatTheForcesDo) {
  const MpcConfig config = mpc_config();
  const auto mpc = make(config);
  Random random(41);
  for (const MpcGait& gait : kMpcGaits) {
    const MpcProblem problem = random_mpc_problem(random, gait, config, 0.3);
    const MpcSolution solution = mpc->solve(problem);
    Vector3 p = problem.p_OB_m;
    Vector3 v = problem.v_OB_m_s;
    for (std::size_t k = 0; k < kMpcHorizon; ++k) {
      Vector3 force = Vector3::Zero();
      for (const Vector3& foot : solution.force_O_N[k]) force += foot;
      for (int i = 0; i < 1000; ++i) {
        const double h = config.step_s / 1000.0;
        const Vector3 a = force / problem.mass_kg - Vector3(0.0, 0.0, 9.81);
        p += h * v + 0.5 * h * h * a;
        v += h * a;
      }
      EXPECT_LT((p - solution.predicted[k].p_OB_m).norm(), 1e-9) << gait.name;
      EXPECT_LT((v - solution.predicted[k].v_OB_m_s).norm(), 1e-9) << gait.name;
    }
  }
}

TEST(ConvexMpc, NoFootInTheWholeHorizonGivesNoForce) {
  MpcProblem problem = standing();
  for (auto& step : problem.stands) step.fill(false);
  const MpcConfig config = mpc_config();
  const auto mpc = make(config);
  const MpcSolution& solution = mpc->solve(problem);
  EXPECT_EQ(solution.source, MpcSource::kSolved);
  EXPECT_EQ(violation_N(problem, solution, config), 0.0);
  const double fallen_m = 0.5 * 9.81 * 0.3 * 0.3;
  EXPECT_NEAR(solution.predicted[9].p_OB_m[2], 0.29 - fallen_m, 1e-9);
}

TEST(ConvexMpc, FlightInTheNextStepPreparesTheLanding) {
  MpcProblem problem = standing();
  problem.stands[0].fill(false);
  problem.stands[1].fill(false);
  const MpcConfig config = mpc_config();
  const auto mpc = make(config);
  const MpcSolution& solution = mpc->solve(problem);
  EXPECT_EQ(violation_N(problem, solution, config), 0.0);
  double landing_N = 0;
  for (const Vector3& force : solution.force_O_N[2]) landing_N += force[2];
  EXPECT_GT(landing_N, 9.0 * 9.81);
}

// One foot, two feet, feet on one line, feet on one spot: nothing singular comes out.
TEST(ConvexMpc, AnyContactPlanIsAnswered) {
  const MpcConfig config = mpc_config();
  const auto mpc = make(config);
  Random random(51);
  for (int trial = 0; trial < samples(2000, 100); ++trial) {
    MpcProblem problem = random_mpc_problem(random, kMpcGaits[6], config, 1.0);
    const std::uint32_t kind = random.below(3);
    for (std::size_t k = 0; k < kMpcHorizon; ++k) {
      for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
        problem.stands[k][leg] = random.below(2) == 0;
        if (kind == 1) problem.contact_O_m[k][leg] = problem.contact_O_m[k][0];
        if (kind == 2) problem.contact_O_m[k][leg][1] = problem.contact_O_m[k][0][1];
      }
    }
    problem.steps_since_last = random.below(12);
    const MpcSolution& solution = mpc->solve(problem);
    ASSERT_LE(violation_N(problem, solution, config), 1e-12);
    ASSERT_EQ(solution.source, MpcSource::kSolved) << solution.residual_N;
  }
}

TEST(ConvexMpc, IsFeasibleFarFromAnythingSensible) {
  const MpcConfig config = mpc_config();
  const auto mpc = make(config);
  Random random(61);
  for (int trial = 0; trial < samples(2000, 100); ++trial) {
    const MpcGait& gait = kMpcGaits[static_cast<std::size_t>(trial) % kMpcGaits.size()];
    MpcProblem problem = random_mpc_problem(random, gait, config, 10.0);
    problem.steps_since_last = random.below(12);
    ASSERT_LE(violation_N(problem, mpc->solve(problem), config), 1e-12);
  }
}

// The same step once more begins where the last one ended, and so gets nearer.
TEST(ConvexMpc, TheLastSolutionIsTheStart) {
  MpcConfig config = mpc_config();
  config.effort_weight = 2e-6;  // slow: with the usual one nothing is left to gain
  config.max_residual_N = 1000.0;
  const auto mpc = make(config);
  Random random(71);
  double warm_sum = 0;
  double cold_sum = 0;
  for (int trial = 0; trial < samples(700, 70); ++trial) {
    const MpcGait& gait = kMpcGaits[static_cast<std::size_t>(trial) % kMpcGaits.size()];
    MpcProblem problem = random_mpc_problem(random, gait, config, 1.0);
    problem.steps_since_last = kMpcHorizon;
    cold_sum += mpc->solve(problem).residual_N;
    problem.steps_since_last = 0;
    warm_sum += mpc->solve(problem).residual_N;
  }
  std::printf("residuals: cold %.6f N, again %.6f N\n", cold_sum, warm_sum);
  EXPECT_LT(warm_sum, 0.5 * cold_sum);
}

TEST(ConvexMpc, FallsBackToTheShiftedPlanThenToTheWeight) {
  const MpcConfig config = mpc_config();
  const auto mpc = make(config);
  MpcProblem problem = standing();
  problem.v_OB_m_s = Vector3(0.3, 0.1, 0.0);
  const MpcSolution before = mpc->solve(problem);
  ASSERT_EQ(before.source, MpcSource::kSolved);

  MpcProblem broken = problem;
  broken.v_OB_m_s[1] = std::numeric_limits<double>::quiet_NaN();
  broken.steps_since_last = 1;
  const MpcSolution shifted = mpc->solve(broken);
  EXPECT_EQ(shifted.source, MpcSource::kShifted);
  EXPECT_EQ(shifted.fallbacks, 1u);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    EXPECT_LT((shifted.force_O_N[0][leg] - before.force_O_N[1][leg]).norm(), 1e-9);
  }
  EXPECT_LE(violation_N(broken, shifted, config), 1e-12);
  EXPECT_NEAR(shifted.force_O_N[9][0][2], 9.0 * 9.81 / 4.0, 1e-9);

  // Another contact plan than the last one: the weight.
  broken.stands[0][0] = false;
  const MpcSolution weight = mpc->solve(broken);
  EXPECT_EQ(weight.source, MpcSource::kWeight);
  EXPECT_EQ(weight.fallbacks, 2u);
  EXPECT_EQ(weight.force_O_N[0][0].norm(), 0.0);
  EXPECT_NEAR(weight.force_O_N[0][1][2], 9.0 * 9.81 / 3.0, 1e-9);
  EXPECT_LE(violation_N(broken, weight, config), 1e-12);

  EXPECT_EQ(mpc->solve(problem).source, MpcSource::kSolved);
  EXPECT_EQ(mpc->solution().fallbacks, 2u);
}

TEST(ConvexMpc, RefusesWhatIsNotAProblem) {
  const MpcConfig config = mpc_config();
  const auto mpc = make(config);
  const double bad = std::numeric_limits<double>::quiet_NaN();
  std::vector<MpcProblem> problems(6, standing());
  problems[0].mass_kg = 0.0;
  problems[1].inertia_B_kg_m2(1, 1) = -0.1;
  problems[2].R_OB(0, 1) = bad;
  problems[3].reference[4].p_OB_m[0] = std::numeric_limits<double>::infinity();
  problems[4].contact_O_m[9][2][1] = bad;
  problems[5].mass_kg = bad;
  for (MpcProblem& problem : problems) {
    problem.steps_since_last = kMpcHorizon;
    const MpcSolution& solution = mpc->solve(problem);
    EXPECT_EQ(solution.source, MpcSource::kWeight);
    EXPECT_LE(violation_N(problem, solution, config), 1e-12);
  }
  // A foot in the air may be anywhere.
  MpcProblem fine = standing();
  fine.stands[3][1] = false;
  fine.contact_O_m[3][1][0] = bad;
  EXPECT_EQ(mpc->solve(fine).source, MpcSource::kSolved);
}

TEST(ConvexMpc, AResidualAboveTheBoundIsNotUsed) {
  MpcConfig config = mpc_config();
  config.max_residual_N = 1e-9;
  const auto mpc = make(config);
  Random random(81);
  const MpcProblem problem = random_mpc_problem(random, kMpcGaits[5], config, 1.0);
  const MpcSolution& solution = mpc->solve(problem);
  EXPECT_EQ(solution.source, MpcSource::kWeight);
  EXPECT_GT(solution.residual_N, 0.0);
  EXPECT_LE(violation_N(problem, solution, config), 1e-12);
}

TEST(ConvexMpc, SolvesTheSameProblemToTheSameBits) {
  const MpcConfig config = mpc_config();
  Random random(91);
  const MpcProblem problem = random_mpc_problem(random, kMpcGaits[0], config, 1.0);
  const auto used = make(config);
  for (int i = 0; i < 5; ++i) used->solve(random_mpc_problem(random, kMpcGaits[5], config, 1.0));
  used->reset(config);
  const MpcSolution a = make(config)->solve(problem);
  const MpcSolution b = used->solve(problem);
  for (std::size_t k = 0; k < kMpcHorizon; ++k) {
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      EXPECT_EQ(a.force_O_N[k][leg], b.force_O_N[k][leg]);
    }
    EXPECT_EQ(a.predicted[k].p_OB_m, b.predicted[k].p_OB_m);
  }
}

}  // namespace
}  // namespace surefoot::control
