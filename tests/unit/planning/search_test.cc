// The beam search against every sequence there is.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <vector>

#include "tests/support/rough_footsteps.h"
#include "tests/support/samples.h"
#include "tests/unit/planning/footstep_oracle.h"

namespace surefoot::planning {
namespace {

using tests::rough_problem;
using tests::rough_terrain;

constexpr double kNoBound = std::numeric_limits<double>::infinity();

struct Search {
  robot::RobotModel model = robot::little_dog();
  FootstepConfig config = tests::footstep_config();
  StanceShape shape = tests::footstep_shape();
  std::unique_ptr<FootstepPlanner> planner = std::make_unique<FootstepPlanner>();

  Status plan(const FootstepProblem& problem, const terrain::TerrainMap& map, FootstepPlan& out) {
    planner->reset(config, model, shape);
    return planner->plan(problem, map, out);
  }
};

// The oracle asks inverse kinematics, which knows no margin.
Search exact_search() {
  Search search;
  search.config.reach_margin_m = 0;
  return search;
}

// Stepping stones: of every square so few cells that the beam holds all sequences.
std::unique_ptr<terrain::TerrainMap> stones(std::uint64_t seed, double share) {
  Random random(seed, 5);
  std::vector<tests::GroundCell> cells(10000);
  for (tests::GroundCell& cell : cells) {
    cell.known = random.uniform() < share;
    cell.height_m = random.uniform(0.0, 0.07);
    cell.cost = random.uniform(0.0, 0.8);
    cell.spread_m = random.uniform() < 0.3 ? random.uniform(0.0, 0.02) : 0.0;
  }
  return tests::terrain_of([&](mapping::CellIndex i) {
    return cells[100 * static_cast<std::size_t>(i.iy + 50) + static_cast<std::size_t>(i.ix + 40)];
  });
}

// Where the first step would have gone there was no ground.
void avoid_best_place(Search& search, const terrain::TerrainMap& map, FootstepProblem& problem) {
  FootstepPlan plan;
  if (!ok(search.plan(problem, map, plan))) return;
  const Vector2 place = plan.steps[0].position_O_m.head<2>();
  static_cast<void>(problem.avoided_O_m.push_back(place));
}

TEST(FootstepSearch, FindsTheBestOfAllSequencesWhereTheBeamHoldsThem) {
  constexpr int kStones = tests::samples(600, 120);
  Search search = exact_search();
  search.config.beam = 32;
  int full = 0;
  int cut_short = 0;
  int none = 0;
  for (int seed = 1; seed <= kStones; ++seed) {
    search.config.radius_cells = seed % 2 == 0 ? 1 : 2;
    const auto map = stones(seed, seed % 2 == 0 ? 0.2 : 0.07);
    FootstepProblem problem = rough_problem(seed, search.model, *map);
    problem.centre_offset_O_m = Vector2(0.004, -0.003);
    if (seed % 3 == 0) avoid_best_place(search, *map, problem);
    FootstepPlan plan;
    const Status status = search.plan(problem, *map, plan);
    FootstepOracle oracle(search.config, search.model, search.shape, problem, *map);
    const double best = oracle.search(kNoBound);
    ASSERT_EQ(status == Status::kNotFound, oracle.steps().empty()) << seed;
    if (!ok(status)) {
      ++none;
      continue;
    }
    ASSERT_EQ(plan.steps.size(), oracle.steps().size()) << seed;
    EXPECT_NEAR(plan.cost, best, 1e-9) << seed;
    for (std::size_t i = 0; i < plan.steps.size(); ++i) {
      EXPECT_EQ(plan.steps[i].cell, oracle.steps()[i].cell) << seed << " step " << i;
    }
    ++(plan.steps.size() == 4 ? full : cut_short);
  }
  EXPECT_GE(full, kStones / 12);
  EXPECT_GE(cut_short, kStones / 12);
  EXPECT_GE(none, kStones / 12);
  RecordProperty("full", full);
  RecordProperty("cut_short", cut_short);
}

constexpr std::array<int, 3> kBeams{1, 4, 16};

constexpr std::size_t kTerrains = tests::samples(50, 2);
constexpr std::uint64_t kWalks = tests::samples(200, 10);
constexpr bool kInFull = kTerrains == 50;  // what is said of many terrains is said then

// By how much of the best each beam's plans cost more, sorted, on rough terrains.
std::array<std::vector<double>, kBeams.size()> excess_of_beams(int steps) {
  Search search = exact_search();
  search.config.steps = steps;
  std::array<std::vector<double>, kBeams.size()> excess;
  for (std::uint64_t seed = 1; excess[0].size() < kTerrains && seed < 200; ++seed) {
    const auto map = rough_terrain(seed);
    const FootstepProblem problem = rough_problem(seed, search.model, *map);
    std::array<FootstepPlan, kBeams.size()> plans;
    bool found = true;
    for (std::size_t i = 0; i < kBeams.size(); ++i) {
      search.config.beam = kBeams[i];
      found = ok(search.plan(problem, *map, plans[i])) && found;
    }
    if (!found) continue;
    FootstepOracle oracle(search.config, search.model, search.shape, problem, *map);
    const double best = oracle.search(plans.back().cost + 1e-12);
    for (std::size_t i = 0; i < kBeams.size(); ++i) {
      excess[i].push_back(plans[i].cost / best - 1.0);
    }
  }
  for (std::vector<double>& of_beam : excess) std::sort(of_beam.begin(), of_beam.end());
  return excess;
}

// The figures are in core/planning/README.md.
TEST(FootstepSearch, ComesCloseToTheBestOnRoughGround) {
  for (const int steps : {3, 4}) {
    const auto excess = excess_of_beams(steps);
    for (std::size_t i = 0; i < kBeams.size(); ++i) {
      const std::vector<double>& e = excess[i];
      ASSERT_EQ(e.size(), kTerrains);
      if (!kInFull) continue;
      const auto exact = std::count_if(e.begin(), e.end(), [](double x) { return x < 1e-6; });
      std::printf("steps %d, beam %2d: median %.4f, 90 %% %.4f, worst %.4f, exact %td\n", steps,
                  kBeams[i], e[25], e[45], e[49], exact);
    }
    EXPECT_LT(excess.back()[kTerrains / 2], 0.25);
    if (!kInFull) continue;
    EXPECT_LT(excess.back()[25], 0.001);
    EXPECT_LT(excess.back()[45], 0.06);
    EXPECT_LT(excess.back()[49], 0.25);   // where the bound of the work is met
    EXPECT_GT(excess.front()[49], 0.02);  // the ground is not so plain that any search would do
  }
}

struct Walked {
  int stuck = 0;
  int steps = 0;
  double cost = 0;
};

Walked walk_rough_ground(const FootstepConfig& config) {
  Search search;
  search.config = config;
  Walked walked;
  for (std::uint64_t seed = 1; seed <= kWalks; ++seed) {
    const auto map = rough_terrain(seed);
    FootstepProblem problem = rough_problem(seed, search.model, *map);
    problem.stride_O_m = Vector2(0.08, 0.0);
    problem.yaw_rad = 0;
    for (int i = 0; i < 16; ++i) {
      FootstepPlan plan;
      if (!ok(search.plan(problem, *map, plan))) {
        ++walked.stuck;
        break;
      }
      const Footstep& first = plan.steps[0];
      problem.feet_O_m[first.leg] = first.position_O_m;
      problem.turn = (problem.turn + 1) % 4;
      walked.cost += first.cost;
      ++walked.steps;
    }
  }
  return walked;
}

// Sixteen steps on each of 200 terrains. The figures are in core/planning/README.md.
TEST(FootstepSearch, LookingAheadGetsStuckLessOften) {
  FootstepConfig config = tests::footstep_config();
  const Walked far = walk_rough_ground(config);
  config.steps = 1;
  const Walked near = walk_rough_ground(config);
  for (const Walked& walked : {near, far}) {
    std::printf("stuck %d, %.5f m per step\n", walked.stuck, walked.cost / walked.steps);
    EXPECT_GT(walked.steps, 0);
  }
  if (!kInFull) return;
  EXPECT_LT(far.stuck, near.stuck);
  EXPECT_LT(far.cost / far.steps, 0.99 * near.cost / near.steps);
}

TEST(FootstepSearch, CountsWhatItsStepsCost) {
  Search search = exact_search();
  int steps = 0;
  int touching = 0;
  int exact = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto map = rough_terrain(seed);
    const FootstepProblem problem = rough_problem(seed, search.model, *map);
    FootstepPlan plan;
    if (!ok(search.plan(problem, *map, plan))) continue;
    FootstepOracle oracle(search.config, search.model, search.shape, problem, *map);
    Feet feet = problem.feet_O_m;
    double sum = 0;
    for (std::size_t i = 0; i < plan.steps.size(); ++i) {
      Footstep again = plan.steps[i];
      const std::optional<double> deep_m = oracle.deepest_m(feet, i, again.position_O_m);
      ASSERT_TRUE(deep_m) << seed << " step " << i;
      const double cost = oracle.step_cost(feet, i, oracle.nominal(feet, i), again) +
                          search.config.collision_weight * *deep_m;
      // Late in a dear search not all poses are tried: more is counted then, never less.
      const bool same = std::abs(cost - plan.steps[i].cost) < 1e-9;
      EXPECT_TRUE(same || (i > 0 && cost < plan.steps[i].cost)) << seed << " step " << i;
      exact += same ? 1 : 0;
      touching += *deep_m > 0 ? 1 : 0;
      EXPECT_NEAR(again.position_O_m[2], plan.steps[i].position_O_m[2], 1e-12);
      feet[again.leg] = again.position_O_m;
      sum += plan.steps[i].cost;
      ++steps;
    }
    const auto missing = static_cast<double>(4 - plan.steps.size());
    EXPECT_NEAR(sum + missing * search.config.missing_step_m, plan.cost, 1e-9);
  }
  EXPECT_GE(steps, 200);
  EXPECT_GE(exact, steps * 95 / 100);
  EXPECT_GE(touching, 10);  // what touches the ground is in the sums
}

TEST(FootstepSearch, EveryLegReachesByInverseKinematics) {
  Search search;
  int steps = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const auto map = rough_terrain(seed);
    const FootstepProblem problem = rough_problem(seed, search.model, *map);
    FootstepPlan plan;
    if (!ok(search.plan(problem, *map, plan))) continue;
    const FootstepOracle oracle(search.config, search.model, search.shape, problem, *map);
    Feet feet = problem.feet_O_m;
    for (std::size_t i = 0; i < plan.steps.size(); ++i) {
      EXPECT_TRUE(oracle.deepest_m(feet, i, plan.steps[i].position_O_m)) << seed << " step " << i;
      feet[plan.steps[i].leg] = plan.steps[i].position_O_m;
      ++steps;
    }
  }
  EXPECT_GE(steps, 400);
}

}  // namespace
}  // namespace surefoot::planning
