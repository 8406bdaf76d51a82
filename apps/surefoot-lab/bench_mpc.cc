#include "apps/surefoot-lab/bench_mpc.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "apps/common/config_root.h"
#include "apps/common/run.h"
#include "core/control/convex_mpc.h"
#include "tests/support/mpc_oracle.h"
#include "tests/support/mpc_problems.h"

namespace surefoot::apps {
namespace {

constexpr std::size_t kCalls = 1000;
constexpr std::size_t kCompared = 100;  // of the calls: the exact solver takes milliseconds
constexpr double kMaxError_N = 1.0;
constexpr double kMaxViolation_N = 1e-12;  // rounding
constexpr double kDisturbed = 1.0;         // sigma 0.25 rad, 0.5 m/s, 1 rad/s, 0.05 m

struct Outcome {
  std::vector<double> spent_us;
  double error_N = 0;  // of the forces of the first step, the ones that are used
  double residual_N = 0;
  double violation_N = 0;
  std::size_t fallbacks = 0;
};

double first_step_error_N(const control::MpcProblem& problem, const control::MpcConfig& config,
                          const control::MpcSolution& solution) {
  const tests::MpcOracleSolution exact = tests::solve_exactly(problem, config);
  double worst = 0;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const Vector3 error = solution.force_O_N[0][leg] - exact.force_O_N[0][leg];
    worst = std::max(worst, error.norm());
  }
  return worst;
}

Outcome bench_gait(const tests::MpcGait& gait, const control::MpcConfig& config) {
  Random random(1);
  const auto mpc = std::make_unique<control::ConvexMpc>();
  mpc->reset(config);
  Outcome outcome;
  for (std::size_t i = 0; i < kCalls; ++i) {
    control::MpcProblem problem = tests::random_mpc_problem(random, gait, config, kDisturbed);
    problem.steps_since_last = control::kMpcHorizon;  // a cold start is the hardest
    const auto begin = std::chrono::steady_clock::now();
    const control::MpcSolution& solution = mpc->solve(problem);
    const std::chrono::duration<double, std::micro> spent =
        std::chrono::steady_clock::now() - begin;
    outcome.spent_us.push_back(spent.count());
    outcome.residual_N = std::max(outcome.residual_N, solution.residual_N);
    outcome.violation_N =
        std::max(outcome.violation_N, tests::violation_N(problem, solution, config));
    if (i % (kCalls / kCompared) != 0) continue;
    outcome.error_N = std::max(outcome.error_N, first_step_error_N(problem, config, solution));
  }
  outcome.fallbacks = mpc->solution().fallbacks;
  std::sort(outcome.spent_us.begin(), outcome.spent_us.end());
  return outcome;
}

void print(const std::string& text) { std::fputs(text.c_str(), stdout); }

}  // namespace

int bench_mpc() {
  ConfigIssues issues;
  const Config config =
      load_config({"mini_cheetah", "flat", "cross", "sim", 1, {}}, config_folder(), issues);
  if (!issues.empty()) return refuse(issues);
  print(
      fmt::format("mpc: {} cold starts from disturbed states per gait, {} of them solved exactly\n",
                  kCalls, kCompared));
  print(fmt::format("  {:<10} {:>10} {:>10} {:>10} {:>12} {:>12} {:>10}\n", "gait", "median us",
                    "99 % us", "max us", "error N", "residual N", "fallbacks"));
  bool good = true;
  for (const tests::MpcGait& gait : tests::kMpcGaits) {
    const Outcome outcome = bench_gait(gait, config.autonomy.control.mpc);
    print(fmt::format("  {:<10} {:>10.0f} {:>10.0f} {:>10.0f} {:>12.4f} {:>12.4f} {:>10}\n",
                      gait.name, outcome.spent_us[kCalls / 2], outcome.spent_us[kCalls * 99 / 100],
                      outcome.spent_us.back(), outcome.error_N, outcome.residual_N,
                      outcome.fallbacks));
    good = good && outcome.error_N < kMaxError_N && outcome.violation_N <= kMaxViolation_N;
  }
  return good ? 0 : 3;
}

}  // namespace surefoot::apps
