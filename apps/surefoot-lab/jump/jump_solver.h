// Ipopt on a JumpProblem.
#pragma once

#include <string>
#include <vector>

#include "apps/surefoot-lab/jump/jump_problem.h"

namespace surefoot::apps::jump {

struct JumpSolution {
  bool solved = false;
  std::string verdict;  // the solver's
  int iterations = 0;
  double cost = 0;
  double violation = 0;  // largest, of the scaled constraints
  std::vector<double> x;
};

// verbose: the solver prints its iterations.
JumpSolution solve(const JumpProblem& problem, const std::vector<double>& guess, int max_iterations,
                   bool verbose);

}  // namespace surefoot::apps::jump
