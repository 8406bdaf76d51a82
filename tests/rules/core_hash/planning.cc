// Workload of core/planning: plans on rough ground, each from where the last one's steps lead to.
#include <memory>

#include "tests/rules/core_hash/workloads.h"
#include "tests/support/rough_footsteps.h"

namespace surefoot::tests {

void hash_planning(Fnv64& hash) {
  const robot::RobotModel model = robot::little_dog();
  const auto planner = std::make_unique<planning::FootstepPlanner>();
  planner->reset(footstep_config(), model, footstep_shape());
  planning::FootstepPlan plan;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto map = rough_terrain(seed);
    planning::FootstepProblem problem = rough_problem(seed, model, *map);
    for (int i = 0; i < 4; ++i) {
      hash.byte(static_cast<std::uint8_t>(planner->plan(problem, *map, plan)));
      mix(hash, plan.cost);
      for (const planning::Footstep& step : plan.steps) {
        mix(hash, step.position_O_m);
        problem.feet_O_m[step.leg] = step.position_O_m;
        problem.turn = (problem.turn + 1) % robot::kLegs;
      }
    }
  }
}

}  // namespace surefoot::tests
