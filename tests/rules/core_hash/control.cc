// Workloads of core/control.
#include "core/base/random.h"
#include "core/control/convex_mpc.h"
#include "core/control/force_distribution.h"
#include "core/control/gait.h"
#include "core/control/swing.h"
#include "tests/rules/core_hash/workloads.h"
#include "tests/support/mpc_problems.h"

namespace surefoot::tests {

void hash_swing(Fnv64& hash) {
  control::GaitConfig config;
  config.period_s = 0.4;
  config.stance_share = 0.6;
  config.offset = {0.0, 0.5, 0.5, 0.0};
  control::Gait gait;
  gait.reset(config);
  Random random(8);
  control::SwingPath path;
  for (int i = 0; i < 5000; ++i) {
    gait.advance(0.002);
    for (const control::LegPhase& leg : gait.legs()) {
      hash.byte(leg.stance ? 1 : 0);
      mix(hash, leg.progress);
      mix(hash, leg.remaining_s);
    }
    for (int axis = 0; axis < 3; ++axis) path.landing_O_m[axis] = random.uniform(-0.1, 0.1);
    path.apex_O_m = random.uniform(0.1, 0.2);
    const control::SwingPoint point = control::evaluate(path, random.uniform(), 0.16);
    mix(hash, point.position_O_m);
    mix(hash, point.velocity_O_m_s);
  }
}

void hash_force_distribution(Fnv64& hash) {
  control::ForceConfig config;
  config.friction = 0.5;
  config.min_normal_N = 3;
  config.max_normal_N = 150;
  config.force_weight = {1, 1, 1};
  config.moment_weight = {20, 20, 20};
  config.effort_weight = 1e-3;
  config.change_weight = 1e-3;
  control::ForceDistribution forces;
  forces.reset(config);
  Random random(9);
  for (int i = 0; i < 500; ++i) {
    control::ForceProblem problem;
    for (int axis = 0; axis < 6; ++axis) problem.wrench_O[axis] = random.uniform(-5, 5);
    problem.wrench_O[2] += 88;
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      const double x = robot::front_sign(leg) * 0.2 + random.uniform(-0.05, 0.05);
      const double y = robot::left_sign(leg) * 0.11 + random.uniform(-0.05, 0.05);
      problem.lever_O_m[leg] = {x, y, -0.28};
      problem.in_contact[leg] = (i / 100) % 2 == 0 || leg == 0 || leg == 3;
    }
    const control::ForceSolution& solution = forces.solve(problem);
    for (const Vector3& force : solution.force_O_N) mix(hash, force);
    mix(hash, solution.residual_N);
  }
}

void hash_convex_mpc(Fnv64& hash) {
  static control::ConvexMpc mpc;
  const control::MpcConfig config = mpc_config();
  mpc.reset(config);
  Random random(10);
  for (int i = 0; i < 140; ++i) {
    const MpcGait& gait = kMpcGaits[static_cast<std::size_t>(i) % kMpcGaits.size()];
    control::MpcProblem problem = random_mpc_problem(random, gait, config, i % 2 == 0 ? 0.0 : 1.0);
    problem.steps_since_last = i % 3 == 0 ? 1 : 100;
    const control::MpcSolution& solution = mpc.solve(problem);
    for (std::size_t k = 0; k < control::kMpcHorizon; ++k) {
      for (const Vector3& force : solution.force_O_N[k]) mix(hash, force);
      mix(hash, solution.predicted[k].p_OB_m);
      mix(hash, solution.predicted[k].roll_pitch_yaw_rad);
    }
    mix(hash, solution.residual_N);
  }
}

}  // namespace surefoot::tests
