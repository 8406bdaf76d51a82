// What the search for footsteps does on ground that was made for it.
#include "core/planning/footsteps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>

#include "tests/support/rough_footsteps.h"
#include "tests/support/samples.h"

namespace surefoot::planning {
namespace {

using tests::GroundCell;
using tests::rough_problem;
using tests::rough_terrain;

constexpr double kCell_m = 0.01;
static_assert(sizeof(FootstepPlanner) < 80'000);

// A robot whose feet are where the first step of every plan puts them.
struct Walker {
  explicit Walker(const FootstepConfig& config = tests::footstep_config()) {
    planner->reset(config, model, tests::footstep_shape());
    problem.feet_O_m = tests::standing_feet(model);
    problem.stride_O_m = Vector2(0.10, 0.0);
  }

  // One step on `map`; false: no plan.
  bool step(const terrain::TerrainMap& map) {
    if (!ok(planner->plan(problem, map, plan))) return false;
    const Footstep& first = plan.steps[0];
    EXPECT_EQ(first.leg, step_leg(problem.turn));
    problem.feet_O_m[first.leg] = first.position_O_m;
    problem.turn = (problem.turn + 1) % robot::kLegs;
    return true;
  }
  double middle_x_m() const {
    double sum = 0;
    for (const Vector3& foot : problem.feet_O_m) sum += 0.25 * foot[0];
    return sum;
  }

  robot::RobotModel model = robot::little_dog();
  std::unique_ptr<FootstepPlanner> planner = std::make_unique<FootstepPlanner>();
  FootstepProblem problem;
  FootstepPlan plan;
};

TEST(Footsteps, GoToTheirNominalPlacesOnLevelGround) {
  const auto map = tests::flat_terrain();
  Walker walker;
  for (int i = 0; i < 16; ++i) {
    ASSERT_TRUE(walker.step(*map));
    ASSERT_EQ(walker.plan.steps.size(), 4U);
    for (const Footstep& step : walker.plan.steps) {
      EXPECT_LT((step.position_O_m - step.nominal_O_m).norm(), 1e-12);
    }
  }
  EXPECT_NEAR(walker.middle_x_m(), 0.4, 0.03);
}

TEST(Footsteps, StandOnTheGroundThatTheMapHasPlusItsOffset) {
  const auto map = tests::terrain_of(
      [](mapping::CellIndex i) { return GroundCell{.height_m = 0.001 * i.iy + 0.0005 * i.ix}; });
  Walker walker;
  walker.problem.map_offset_m = 0.013;
  ASSERT_TRUE(ok(walker.planner->plan(walker.problem, *map, walker.plan)));
  for (const Footstep& step : walker.plan.steps) {
    const double ground_m = 0.001 * step.cell.iy + 0.0005 * step.cell.ix + 0.013;
    EXPECT_NEAR(step.position_O_m[2], ground_m + walker.model.foot_radius_m, 1e-6);
  }
}

// The gap is 5 cm long: every foot passes it, none steps into it.
void walk_over(const GroundCell& gap) {
  const auto in_gap = [](std::int32_t ix) { return ix >= 15 && ix < 20; };
  const auto map =
      tests::terrain_of([&](mapping::CellIndex i) { return in_gap(i.ix) ? gap : GroundCell{}; });
  Walker walker;
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(walker.step(*map)) << "step " << i;
    for (const Footstep& step : walker.plan.steps) ASSERT_FALSE(in_gap(step.cell.ix));
  }
  for (const Vector3& foot : walker.problem.feet_O_m) EXPECT_GT(foot[0], 0.2);
}

TEST(Footsteps, StepOverAPit) { walk_over({.height_m = -0.2}); }
TEST(Footsteps, StepOverUnknownGround) { walk_over({.known = false}); }
TEST(Footsteps, StepOverGroundThatIsTooBad) { walk_over({.cost = 0.9}); }
TEST(Footsteps, StepOverACostlyBand) { walk_over({.cost = 0.6}); }

// The right side of the way is bad: the right feet go where it is not.
TEST(Footsteps, SkirtCostlyGround) {
  const auto bad = [](mapping::CellIndex i) { return i.iy < -7 && i.ix > 12; };
  const auto map = tests::terrain_of(
      [&](mapping::CellIndex i) { return GroundCell{.cost = bad(i) ? 0.6 : 0.0}; });
  Walker walker;
  for (int i = 0; i < 16; ++i) {
    ASSERT_TRUE(walker.step(*map));
    EXPECT_FALSE(bad(walker.plan.steps[0].cell));
  }
}

TEST(Footsteps, PreferGroundThatWasSeen) {
  const auto risky = [](mapping::CellIndex i) { return i.ix >= 15 && i.ix < 19; };
  const auto map = tests::terrain_of(
      [&](mapping::CellIndex i) { return GroundCell{.spread_m = risky(i) ? 0.015 : 0.0}; });
  Walker walker;
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(walker.step(*map));
    EXPECT_FALSE(risky(walker.plan.steps[0].cell));
  }
  // Where there is no other they are good enough.
  const auto all =
      tests::terrain_of([](mapping::CellIndex) { return GroundCell{.spread_m = 0.015}; });
  EXPECT_TRUE(walker.step(*all));
}

// A ledge of 2 cm along y, from cell 17 on.
std::unique_ptr<terrain::TerrainMap> ledge() {
  return tests::terrain_of(
      [](mapping::CellIndex i) { return GroundCell{.height_m = i.ix >= 17 ? 0.02 : 0.0}; });
}

// Steps of a walk over it into the two columns below its edge and above it.
struct BesideTheEdge {
  int below = 0;
  int above = 0;
};
BesideTheEdge walk_over_ledge(double wall_weight, double drop_weight) {
  const auto map = ledge();
  FootstepConfig config = tests::footstep_config();
  config.wall_weight = wall_weight;
  config.drop_weight = drop_weight;
  BesideTheEdge beside;
  for (int way = 0; way < 8; ++way) {
    Walker walker(config);
    for (Vector3& foot : walker.problem.feet_O_m) foot[0] += 0.01 * way - 0.04;
    for (int i = 0; i < 16; ++i) {
      if (!walker.step(*map)) {
        ADD_FAILURE() << "step " << i;
        break;
      }
      const std::int32_t ix = walker.plan.steps[0].cell.ix;
      beside.below += ix == 15 || ix == 16 ? 1 : 0;
      beside.above += ix == 17 || ix == 18 ? 1 : 0;
    }
  }
  return beside;
}

TEST(Footsteps, KeepOffEdges) {
  const BesideTheEdge careless = walk_over_ledge(0.0, 0.0);
  EXPECT_GT(careless.below, 0);
  EXPECT_GT(careless.above, 0);
  const BesideTheEdge no_drop = walk_over_ledge(0.0, 2.0);
  EXPECT_EQ(no_drop.above, 0);
  EXPECT_GT(no_drop.below, 0);
  const BesideTheEdge no_wall = walk_over_ledge(2.0, 0.0);
  EXPECT_GT(no_wall.above, 0);
  EXPECT_LT(no_wall.below, careless.below);
}

// A trench of three cells under the nominal place: its walls hold a foot, its edges do not.
TEST(Footsteps, StandInAPitBesideWallsUnlessWallsCost) {
  FootstepConfig config = tests::footstep_config();
  config.steps = 1;
  config.wall_weight = 0.0;
  config.drop_weight = 2.0;
  Walker walker(config);
  ASSERT_TRUE(ok(walker.planner->plan(walker.problem, *tests::flat_terrain(), walker.plan)));
  const std::int32_t middle = walker.plan.steps[0].cell.ix;
  const auto trench = tests::terrain_of([middle](mapping::CellIndex i) {
    return GroundCell{.height_m = std::abs(i.ix - middle) <= 1 ? -0.03 : 0.0};
  });
  ASSERT_TRUE(ok(walker.planner->plan(walker.problem, *trench, walker.plan)));
  EXPECT_EQ(walker.plan.steps[0].cell.ix, middle);
  EXPECT_NEAR(walker.plan.steps[0].position_O_m[2], walker.model.foot_radius_m - 0.03, 1e-6);
  config.wall_weight = 2.0;
  Walker careful(config);
  ASSERT_TRUE(ok(careful.planner->plan(careful.problem, *trench, careful.plan)));
  EXPECT_GT(std::abs(careful.plan.steps[0].cell.ix - middle), 1);
}

// Only the first step: what comes later is planned anew by then.
TEST(Footsteps, TheFirstStepGoesToNoPlaceThatIsAvoided) {
  const auto map = tests::flat_terrain();
  Walker walker;
  walker.problem.turn = 2;
  ASSERT_TRUE(ok(walker.planner->plan(walker.problem, *map, walker.plan)));
  const FootstepPlan free = walker.plan;
  const double avoid_m = tests::footstep_config().avoid_m;
  while (!walker.problem.avoided_O_m.full()) {
    const Vector2 place = walker.plan.steps[0].position_O_m.head<2>();
    ASSERT_TRUE(ok(walker.problem.avoided_O_m.push_back(place)));
    ASSERT_TRUE(ok(walker.planner->plan(walker.problem, *map, walker.plan)));
    for (const Vector2& bad : walker.problem.avoided_O_m) {
      EXPECT_GE((walker.plan.steps[0].position_O_m.head<2>() - bad).norm(), avoid_m);
    }
    EXPECT_GT(walker.plan.cost, free.cost);
  }
  walker.problem.avoided_O_m.clear();
  for (std::size_t i = 1; i < free.steps.size(); ++i) {
    const Vector2 place = free.steps[i].position_O_m.head<2>();
    ASSERT_TRUE(ok(walker.problem.avoided_O_m.push_back(place)));
  }
  ASSERT_TRUE(ok(walker.planner->plan(walker.problem, *map, walker.plan)));
  EXPECT_EQ(walker.plan.cost, free.cost);
}

TEST(Footsteps, NoPlanWhereTheOnlyPlaceIsAvoided) {
  const auto map = tests::flat_terrain();
  FootstepConfig config = tests::footstep_config();
  config.radius_cells = 0;
  Walker walker(config);
  ASSERT_TRUE(ok(walker.planner->plan(walker.problem, *map, walker.plan)));
  const Vector2 place = walker.plan.steps[0].position_O_m.head<2>() + Vector2(0.008, 0.008);
  ASSERT_TRUE(ok(walker.problem.avoided_O_m.push_back(place)));
  EXPECT_EQ(walker.planner->plan(walker.problem, *map, walker.plan), Status::kNotFound);
}

// A rock under the place of a shank or of the belly: another place is chosen.
TEST(Footsteps, WhatTouchesTheGroundCosts) {
  FootstepConfig config = tests::footstep_config();
  config.steps = 1;
  const auto rock = tests::terrain_of([](mapping::CellIndex i) {
    return GroundCell{.height_m = std::abs(i.ix) < 4 && std::abs(i.iy) < 3 ? 0.14 : 0.0};
  });
  const auto cost_m = [&](double weight) {
    config.collision_weight = weight;
    Walker walker(config);
    EXPECT_TRUE(ok(walker.planner->plan(walker.problem, *rock, walker.plan)));
    return walker.plan.cost;
  };
  // Trunk 3 cm below its origin, 13 cm high and 18 mm more.
  EXPECT_NEAR(cost_m(1.0) - cost_m(0.0), 0.14 - (0.13 + 0.018 - 0.03), 0.002);
}

TEST(Footsteps, NeverOnUnknownGround) {
  constexpr int kTerrains = tests::samples(100, 10);
  int steps = 0;
  for (int seed = 1; seed <= kTerrains; ++seed) {
    const auto map = rough_terrain(seed);
    Walker walker;
    walker.problem = rough_problem(seed, walker.model, *map);
    if (!walker.step(*map)) continue;
    for (const Footstep& step : walker.plan.steps) {
      ASSERT_TRUE(map->ground.at(step.cell).has_height());
      ++steps;
    }
  }
  EXPECT_GE(steps, 2 * kTerrains);
}

// What bounds the rise bounds the drop.
TEST(Footsteps, NeitherRiseNorDropByMoreThanIsAllowed) {
  for (const double height_m : {-0.059, -0.061, 0.059, 0.061}) {
    const auto map =
        tests::terrain_of([&](mapping::CellIndex) { return GroundCell{.height_m = height_m}; });
    FootstepConfig config = tests::footstep_config();
    config.steps = 1;
    Walker walker(config);
    EXPECT_EQ(walker.step(*map), std::abs(height_m) < 0.06) << height_m;
  }
}

// The next step's triangle: room below the least is refused, below what is wanted it costs.
TEST(Footsteps, LeaveRoomForTheCentreOfMass) {
  const auto map = tests::flat_terrain();
  FootstepConfig config = tests::footstep_config();
  config.radius_cells = 0;
  config.steps = 1;
  Walker free(config);
  ASSERT_TRUE(ok(free.planner->plan(free.problem, *map, free.plan)));
  Feet landed = free.problem.feet_O_m;
  landed[free.plan.steps[0].leg] = free.plan.steps[0].position_O_m;
  const double room_m = standing_triangle(landed, 1).inradius_m();
  config.wanted_inradius_m = room_m + 0.01;
  Walker cramped(config);
  ASSERT_TRUE(ok(cramped.planner->plan(cramped.problem, *map, cramped.plan)));
  EXPECT_NEAR(cramped.plan.cost - free.plan.cost, config.inradius_weight * 0.01, 1e-9);
  config.min_inradius_m = room_m + 1e-6;
  EXPECT_FALSE(Walker(config).step(*map));
}

// A high step that the legs reach with the trunk lowered only.
TEST(Footsteps, ReckonWithALoweredTrunk) {
  const auto map = tests::flat_terrain();
  FootstepConfig config = tests::footstep_config();
  config.steps = 1;
  config.radius_cells = 0;
  config.min_inradius_m = 0.005;
  config.max_lowering_m = 0.0;
  Walker walker(config);
  double length_m = 0.05;
  for (; length_m < 0.4; length_m += 0.005) {
    walker.problem.stride_O_m = Vector2(length_m, 0.0);
    if (!ok(walker.planner->plan(walker.problem, *map, walker.plan))) break;
  }
  ASSERT_LT(length_m, 0.4);
  config.max_lowering_m = 0.03;
  Walker lowered(config);
  lowered.problem.stride_O_m = walker.problem.stride_O_m;
  EXPECT_TRUE(lowered.step(*map));
}

// The nominal place lies so far ahead that the nearest 24 candidates and more are out of reach: a
// first step is found all the same.
TEST(Footsteps, SearchTheWholeSquareForTheFirstStep) {
  const auto map = tests::flat_terrain();
  FootstepConfig config = tests::footstep_config();
  config.steps = 1;
  config.min_inradius_m = 0.005;
  config.max_lowering_m = 0.0;
  const auto reaches = [&](double length_m, std::int32_t radius_cells) {
    config.radius_cells = radius_cells;
    Walker walker(config);
    walker.problem.stride_O_m = Vector2(length_m, 0.0);
    return walker.step(*map);
  };
  double length_m = 0.05;
  while (length_m < 0.6 && reaches(length_m, 3)) length_m += 0.005;
  ASSERT_LT(length_m, 0.6);
  EXPECT_TRUE(reaches(length_m, 6));
}

// The ground ends ahead: what there is of a plan counts, with a penalty for each missing step.
TEST(Footsteps, APlanThatCannotGoOnIsShort) {
  FootstepConfig config = tests::footstep_config();
  const auto ends = [](std::int32_t last) {
    return tests::terrain_of(
        [=](mapping::CellIndex i) { return GroundCell{.known = i.ix < last}; });
  };
  std::size_t shortest = 4;
  for (std::int32_t last = 8; last < 30; ++last) {
    Walker walker(config);
    walker.problem.turn = 1;
    if (!ok(walker.planner->plan(walker.problem, *ends(last), walker.plan))) {
      EXPECT_TRUE(walker.plan.steps.empty());
      continue;
    }
    double sum = 0;
    for (const Footstep& step : walker.plan.steps) sum += step.cost;
    const auto missing = static_cast<double>(4 - walker.plan.steps.size());
    EXPECT_NEAR(walker.plan.cost, sum + missing * config.missing_step_m, 1e-12);
    shortest = std::min(shortest, walker.plan.steps.size());
  }
  EXPECT_LT(shortest, 4U);
}

TEST(Footsteps, EqualInputsGiveEqualBits) {
  for (int seed = 1; seed <= tests::samples(20, 4); ++seed) {
    const auto map = rough_terrain(seed);
    Walker once;
    Walker again;
    once.problem = rough_problem(seed, once.model, *map);
    again.problem = once.problem;
    FootstepPlan scratch;
    (void)again.planner->plan(again.problem, *rough_terrain(seed + 100), scratch);
    ASSERT_EQ(once.planner->plan(once.problem, *map, once.plan),
              again.planner->plan(again.problem, *map, again.plan));
    ASSERT_EQ(once.plan.steps.size(), again.plan.steps.size());
    EXPECT_EQ(once.plan.cost, again.plan.cost);
    for (std::size_t i = 0; i < once.plan.steps.size(); ++i) {
      EXPECT_EQ(once.plan.steps[i].position_O_m, again.plan.steps[i].position_O_m);
      EXPECT_EQ(once.plan.steps[i].cost, again.plan.steps[i].cost);
    }
  }
}

// By whole cells, far enough for other places in the cache of cells.
TEST(Footsteps, AMovedMapMovesThePlan) {
  const mapping::CellIndex by{173, -2011};
  constexpr int kTerrains = tests::samples(30, 4);
  int steps = 0;
  for (int seed = 1; seed <= kTerrains; ++seed) {
    const auto here = rough_terrain(seed);
    auto there = std::make_unique<terrain::TerrainMap>(*here);
    there->ground.first = here->ground.first + by;
    Walker walker;
    walker.problem = rough_problem(seed, walker.model, *here);
    Walker moved;
    moved.problem = walker.problem;
    const Vector3 way(by.ix * kCell_m, by.iy * kCell_m, 0.0);
    for (Vector3& foot : moved.problem.feet_O_m) foot += way;
    const Status status = walker.planner->plan(walker.problem, *here, walker.plan);
    ASSERT_EQ(moved.planner->plan(moved.problem, *there, moved.plan), status);
    ASSERT_EQ(moved.plan.steps.size(), walker.plan.steps.size());
    EXPECT_NEAR(moved.plan.cost, walker.plan.cost, 1e-9);
    for (std::size_t i = 0; i < walker.plan.steps.size(); ++i) {
      EXPECT_EQ(moved.plan.steps[i].cell, walker.plan.steps[i].cell + by);
      const Vector3 back = moved.plan.steps[i].position_O_m - way;
      EXPECT_LT((back - walker.plan.steps[i].position_O_m).norm(), 1e-9);
      ++steps;
    }
  }
  EXPECT_GE(steps, 2 * kTerrains);
}

TEST(Footsteps, SaysWhyThereIsNoPlan) {
  const auto map = tests::flat_terrain();
  const auto unknown =
      tests::terrain_of([](mapping::CellIndex) { return GroundCell{.known = false}; });
  const auto never = std::make_unique<terrain::TerrainMap>();
  Walker walker;
  const auto plan = [&](const FootstepProblem& problem, const terrain::TerrainMap& on) {
    walker.plan.cost = 1;
    const Status status = walker.planner->plan(problem, on, walker.plan);
    EXPECT_EQ(walker.plan.cost == 0.0 && walker.plan.steps.empty(), !ok(status));
    return status;
  };
  EXPECT_EQ(plan(walker.problem, *map), Status::kOk);
  EXPECT_EQ(plan(walker.problem, *never), Status::kUnavailable);
  EXPECT_EQ(plan(walker.problem, *unknown), Status::kNotFound);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), -1e300}) {
    for (int k = 0; k < 6; ++k) {
      FootstepProblem problem = walker.problem;
      if (k == 0) problem.feet_O_m[3][0] = bad;
      if (k == 1) problem.feet_O_m[0][2] = bad;
      if (k == 2) problem.stride_O_m[1] = bad;
      if (k == 3) problem.yaw_rad = bad;
      if (k == 4) problem.map_offset_m = bad;
      if (k == 5) problem.centre_offset_O_m[0] = bad;
      EXPECT_EQ(plan(problem, *map), Status::kInvalid) << bad << " in " << k;
    }
  }
  FootstepProblem problem = walker.problem;
  problem.turn = 4;
  EXPECT_EQ(plan(problem, *map), Status::kInvalid);
  EXPECT_EQ(plan(walker.problem, *map), Status::kOk);
}

// Half of the candidates lie outside the window; where all do there is no plan.
TEST(Footsteps, StayInsideTheWindow) {
  FootstepConfig config = tests::footstep_config();
  config.steps = 1;
  int inside = 0;
  for (const int edge : {0, 1, 2, 3}) {
    Walker walker(config);
    const mapping::CellIndex first{std::array{-16, -16, -83, -90}[static_cast<std::size_t>(edge)],
                                   std::array{-50, -9, -50, -93}[static_cast<std::size_t>(edge)]};
    const auto map = tests::terrain_of([](mapping::CellIndex) { return GroundCell{}; }, first);
    for (std::size_t turn = 0; turn < 4; ++turn) {
      walker.problem.turn = turn;
      const Status status = walker.planner->plan(walker.problem, *map, walker.plan);
      if (!ok(status)) continue;
      EXPECT_TRUE(map->ground.contains(walker.plan.steps[0].cell));
      ++inside;
    }
  }
  EXPECT_GE(inside, 8);
  Walker walker(config);
  const auto far = tests::terrain_of([](mapping::CellIndex) { return GroundCell{}; }, {500, 500});
  EXPECT_FALSE(walker.step(*far));
}

}  // namespace
}  // namespace surefoot::planning
