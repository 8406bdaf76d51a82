// An exact solution of the predictive controller's program, made independently of core: thirteen
// states with gravity as one of them, a matrix exponential by its series, dense condensing over the
// forces of the standing feet, and a primal-dual interior point method (Mehrotra) down to 1e-9.
#pragma once

#include "core/control/convex_mpc.h"

namespace surefoot::tests {

struct MpcOracleSolution {
  std::array<std::array<Vector3, robot::kLegs>, control::kMpcHorizon> force_O_N;
  double optimality = 0;  // largest violation of the KKT conditions, scaled
};

MpcOracleSolution solve_exactly(const control::MpcProblem& problem,
                                const control::MpcConfig& config);

// The objective of these forces, by simulating the thirteen states.
double mpc_cost(const control::MpcProblem& problem, const control::MpcConfig& config,
                const std::array<std::array<Vector3, robot::kLegs>, control::kMpcHorizon>& force);

}  // namespace surefoot::tests
