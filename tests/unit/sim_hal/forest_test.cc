// Worlds with solids keep what contract.md "The worlds" says, on twenty seeds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <set>
#include <vector>

#include "sim_hal/world/passage.h"
#include "sim_hal/world/terrain.h"
#include "tests/unit/sim_hal/sim_fixture.h"

namespace surefoot::sim {
namespace {

constexpr std::uint64_t kSeeds = 20;

Terrain world(Generator generator, std::uint64_t seed, double length_m = 0, bool enclosed = false) {
  WorldSpec spec;
  spec.generator = generator;
  spec.length_to_goal_m = length_m;
  spec.enclosed = enclosed;
  spec.goal_x_m = 14;
  return make_terrain(spec, seed);
}

double count(const Terrain& terrain, SolidKind kind) {
  return static_cast<double>(
      std::count_if(terrain.solids.begin(), terrain.solids.end(),
                    [kind](const Solid& solid) { return solid.kind == kind; }));
}

// The mean over 2 m x 2 m: the hills without the roughness.
double smoothed_m(const Terrain& terrain, double x, double y) {
  double sum = 0;
  for (int j = -10; j <= 10; ++j) {
    for (int i = -10; i <= 10; ++i) sum += terrain.height_m(x + 0.1 * i, y + 0.1 * j);
  }
  return sum / 441;
}

TEST(Forest, DensitiesAndSizesAreThoseOfTheContract) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Terrain terrain = world(Generator::kForest, seed, 25);
    const double area = terrain.spread.area_m2;
    EXPECT_GE(count(terrain, SolidKind::kTrunk) / area, 0.04) << seed;
    EXPECT_LE(count(terrain, SolidKind::kTrunk) / area, 0.12) << seed;
    EXPECT_GE(count(terrain, SolidKind::kBoulder) / area, 0.01) << seed;
    EXPECT_LE(count(terrain, SolidKind::kBoulder) / area, 0.03) << seed;
    EXPECT_NEAR(count(terrain, SolidKind::kLog) / area, 0.005, 0.001) << seed;
    EXPECT_NEAR(static_cast<double>(terrain.saplings.size()) / area, 0.1, 0.001) << seed;
    for (const Sapling& sapling : terrain.saplings) EXPECT_LE(2 * sapling.radius_m, 0.03);
    for (const Solid& solid : terrain.solids) {
      const Vector3 axis = solid.capsule.b_m - solid.capsule.a_m;
      const double d = 2 * solid.capsule.radius_m;
      switch (solid.kind) {
        case SolidKind::kTrunk: EXPECT_TRUE(d >= 0.08 && d <= 0.6) << d; break;
        case SolidKind::kBoulder: EXPECT_TRUE(d >= 0.3 && d <= 1.2) << d; break;
        default:
          EXPECT_TRUE(d >= 0.2 && d <= 0.5) << d;
          EXPECT_GE(std::hypot(axis.x(), axis.y()) + d, 2.0 - 1e-9);
          EXPECT_LE(std::hypot(axis.x(), axis.y()) + d, 5.0 + 1e-9);
      }
    }
  }
}

TEST(Forest, GroundIsHillyRoughAndLevelAtTheStart) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Terrain terrain = world(Generator::kForest, seed, 15);
    double steepest = 0;
    double squares = 0;
    int places = 0;
    for (double x = 3; x <= 18; x += 0.5) {
      for (double y = -14; y <= 14; y += 0.5) {
        const double here = smoothed_m(terrain, x, y);
        const double along = smoothed_m(terrain, x + 0.5, y) - here;
        const double across = smoothed_m(terrain, x, y + 0.5) - here;
        steepest = std::max(steepest, std::hypot(along, across) / 0.5);
        const double rough = terrain.height_m(x, y) - here;
        squares += rough * rough;
        ++places;
      }
    }
    EXPECT_LE(steepest, std::tan(11.0 * 3.14159265 / 180) + 0.05) << seed;
    EXPECT_NEAR(std::sqrt(squares / places), 0.03, 0.006) << seed;
    for (double a = 0; a < 6.28; a += 0.1) {
      EXPECT_NEAR(terrain.height_m(0.9 * std::cos(a), 0.9 * std::sin(a)), 0.0, 1e-3) << seed;
    }
  }
}

// With another raster than the generator's.
TEST(Forest, StartAndGoalAreFreeAndAWayLeadsThere) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Terrain terrain = world(Generator::kForest, seed, 30);
    const Vector2 start(0, 0);
    const Vector2 goal(30, 0);
    Vector2 away;
    for (const Solid& solid : terrain.solids) {
      EXPECT_GE(plan_distance_m(solid, start, start, away), 2.0) << seed;
      EXPECT_GE(plan_distance_m(solid, goal, goal, away), 1.5) << seed;
    }
    EXPECT_GE(terrain.spread.passage_width_m, 0.6 - 1e-9);
    EXPECT_TRUE(passage_exists(terrain.solids, {-8.03, -19.97, 38.02, 19.96}, start, goal, 0.55));
  }
}

TEST(Forest, GoalsAreThoseOfThePapersTests) {
  WorldSpec spec;
  spec.generator = Generator::kForest;
  std::set<double> drawn;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const double goal = goal_of(spec, seed);
    EXPECT_GE(goal, 7.0);
    EXPECT_LE(goal, 130.0);
    drawn.insert(goal);
  }
  EXPECT_GT(drawn.size(), 20U);
  spec.length_to_goal_m = 40;
  EXPECT_EQ(goal_of(spec, 1), 40.0);
}

TEST(Forest, IsMadeQuicklyAndTheSameTwice) {
  const std::clock_t begin = std::clock();
  const Terrain a = world(Generator::kForest, 5, 40);
  const double took_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  RecordProperty("make_ms", static_cast<int>(took_s * 1e3));
  EXPECT_LT(took_s, 1.0);
  const Terrain b = world(Generator::kForest, 5, 40);
  EXPECT_EQ(a.grid.z_m, b.grid.z_m);
  ASSERT_EQ(a.solids.size(), b.solids.size());
  for (std::size_t i = 0; i < a.solids.size(); ++i) {
    EXPECT_EQ(a.solids[i].capsule.a_m, b.solids[i].capsule.a_m);
  }
}

TEST(Wall, IsWideAcrossTheWayAndOneEndIsOpen) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Terrain terrain = world(Generator::kWall, seed);
    ASSERT_EQ(terrain.solids.size(), 2U);
    const PlanBounds b = plan_bounds(terrain.solids[0]);
    EXPECT_GE(b.y1 - b.y0, 25.0 - 1e-9) << seed;
    EXPECT_LE(b.y1 - b.y0, 60.0 + 1e-9) << seed;
    EXPECT_TRUE(b.y0 < -5 && b.y1 > 5) << seed;
    EXPECT_TRUE(b.x0 > 3 && b.x1 < 12) << seed;
    // Round the open end, and not between wall and wing.
    EXPECT_TRUE(
        passage_exists(terrain.solids, {-10, -70, 20, 70}, Vector2(0, 0), Vector2(14, 0), 0.6));
    const PlanBounds inside{-10, b.y0 + 0.05, 20, b.y1 - 0.05};
    EXPECT_FALSE(passage_exists(terrain.solids, inside, Vector2(0, 0), Vector2(14, 0), 0.6));
  }
}

TEST(Wall, AllAroundLeavesNoWay) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Terrain terrain = world(Generator::kWall, seed, 0, true);
    EXPECT_FALSE(
        passage_exists(terrain.solids, {-20, -20, 20, 20}, Vector2(0, 0), Vector2(14, 0), 0.05));
  }
}

TEST(Culdesac, IsAUThatOpensTowardsTheRobot) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Terrain terrain = world(Generator::kCuldesac, seed);
    ASSERT_EQ(terrain.solids.size(), 3U);
    const PlanBounds bottom = plan_bounds(terrain.solids[0]);
    const PlanBounds left = plan_bounds(terrain.solids[1]);
    const PlanBounds right = plan_bounds(terrain.solids[2]);
    const double width = left.y0 - right.y1;
    const double depth = bottom.x0 - left.x0;
    EXPECT_TRUE(width >= 4.0 - 1e-9 && width <= 10.0 + 1e-9) << width;
    EXPECT_TRUE(depth >= 5.0 - 1e-9 && depth <= 15.0 + 1e-9) << depth;
    EXPECT_GT(left.x0, 1.5);
    EXPECT_LT(bottom.x1, 20.0);
    const Vector2 inside(bottom.x0 - 0.5, 0);
    EXPECT_TRUE(passage_exists(terrain.solids, {-10, -20, 30, 20}, Vector2(0, 0), inside, 0.6));
    EXPECT_FALSE(
        passage_exists(terrain.solids, {left.x0, -20, 30, 20}, Vector2(24, 0), inside, 0.6));
  }
}

TEST(Walkers, CrossAtTheirSpeedAndStayClearOfStartAndTrees) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Terrain terrain = world(Generator::kWalkers, seed);
    EXPECT_GE(terrain.walkers.size(), 3U);
    EXPECT_LE(terrain.walkers.size(), 8U);
    Walkers walkers(terrain);
    std::vector<Vector2> last;
    std::vector<bool> above(8);
    std::vector<bool> below(8);
    for (double t = 0; t < 60; t += 0.05) {
      walkers.place(t);
      for (std::size_t i = 0; i < walkers.solids().size(); ++i) {
        const Capsule& c = walkers.solids()[i].capsule;
        const Vector2 p(c.a_m.x(), c.a_m.y());
        EXPECT_GE(p.norm(), 3.0);
        EXPECT_NEAR(c.b_m.z() + c.radius_m - terrain.height_m(p.x(), p.y()), 1.75, 1e-9);
        above[i] = above[i] || p.y() > 1;
        below[i] = below[i] || p.y() < -1;
        Vector2 away;
        for (const Solid& solid : terrain.solids) {
          EXPECT_GT(plan_distance_m(solid, p, p, away), 0.25);
        }
      }
    }
    for (std::size_t i = 0; i < terrain.walkers.size(); ++i) {
      const double speed = terrain.walkers[i].velocity_m_s(1.0).norm();
      EXPECT_TRUE(speed >= 0.5 && speed <= 1.5);
      const Vector2 moved =
          terrain.walkers[i].place_m(1.0 + 1e-4) - terrain.walkers[i].place_m(1.0);
      EXPECT_NEAR(moved.norm(), 1e-4 * speed, 1e-6);
      EXPECT_TRUE(above[i] && below[i]) << seed;
    }
  }
}

// On its legs: a trunk holds it, counts, and can be asked for.
TEST(Solids, StopARobotOnItsLegs) {
  WorldSpec spec;
  spec.generator = Generator::kWall;
  Rig rig(spec);
  rig.stand(1.2);
  EXPECT_EQ(rig.simulator->truth().obstacle_steps, 0U);
  EXPECT_EQ(rig.simulator->solids().size(), 2U);
  EXPECT_EQ(rig.simulator->truth().clearance_m, kMaxClearance_m);
  rig.simulator->set_trunk_force({60, 0, 0});
  for (int i = 0; i < 3000; ++i) rig.tick();
  const Truth truth = rig.simulator->truth();
  EXPECT_GT(truth.obstacle_steps, 0U);
  EXPECT_LT(truth.p_WB_m[0], 7.0);
  EXPECT_LT(truth.clearance_m, 0.3);
}

}  // namespace
}  // namespace surefoot::sim
