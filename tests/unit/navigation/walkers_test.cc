// Walkers of 1.5 m/s who do not look, across the way of a robot of 0.5 m/s.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/samples.h"
#include "tests/unit/navigation/parts.h"
#include "tests/unit/navigation/walker_judge.h"

namespace surefoot::navigation {
namespace {

// 3 to 8 of them, each aimed at where the robot would be when it gets there.
test::World crossing(std::uint64_t seed) {
  Random random(seed, 5);
  test::World world;
  const auto count = 3 + seed % 6;
  for (std::uint64_t i = 0; i < count; ++i) {
    const double side = random.below(2) == 0 ? 1 : -1;
    const double x = random.uniform(2.0, 8.0);
    const double meet_s = (x + random.uniform(-0.5, 0.5)) / 0.45;
    test::Walker walker;
    walker.v = Vector2(0, -side * 1.5);
    walker.p = Vector2(x, side * 1.5 * meet_s);
    world.walkers.push_back(walker);
  }
  return world;
}

// The same from all sides.
test::World from_all_sides(std::uint64_t seed) {
  Random random(seed, 6);
  test::World world;
  const auto count = 3 + seed % 6;
  for (std::uint64_t i = 0; i < count; ++i) {
    const double angle = random.uniform(-M_PI, M_PI);
    const double x = random.uniform(2.0, 8.0);
    const double meet_s = (x + random.uniform(-0.5, 0.5)) / 0.45;
    test::Walker walker;
    walker.v = Vector2(std::cos(angle), std::sin(angle)) * 1.5;
    walker.p = Vector2(x, 0) - walker.v * meet_s;
    world.walkers.push_back(walker);
  }
  return world;
}

struct Count {
  int runs = 0;
  int arrived = 0;
  int avoidable = 0;
  int unavoidable = 0;
  int unseen = 0;  // of these
};

Count meet(const NavigationConfig& config, test::World (*world_of)(std::uint64_t), int runs) {
  Count count;
  for (count.runs = 0; count.runs < runs; ++count.runs) {
    const auto seed = static_cast<std::uint64_t>(count.runs);
    const test::World world = world_of(seed);
    test::RunOptions options;
    options.config = config;
    options.goal = Vector2(10, 0);
    options.seed = seed;
    const test::RunResult result = test::Simulation(world, options).run();
    const test::WalkerJudge judge(world, config);
    if (result.state == NavigationState::kArrived) ++count.arrived;
    for (const test::Collision& collision : result.collisions) {
      const bool avoidable = judge.avoidable(result, collision);
      ++(avoidable ? count.avoidable : count.unavoidable);
      if (collision.first_seen_s > collision.t_s) ++count.unseen;
    }
  }
  std::printf("%d runs: %d arrived, collisions: %d avoidable, %d not (%d never seen)\n", count.runs,
              count.arrived, count.avoidable, count.unavoidable, count.unseen);
  return count;
}

TEST(Walkers, NoneIsRunIntoWhoCouldBeAvoided) {
  const Count count = meet(test::small_robot(), crossing, tests::samples(100, 3));
  EXPECT_EQ(count.avoidable, 0);
  EXPECT_EQ(count.arrived, count.runs);
}

TEST(Walkers, AreAvoidedFromAllSides) {
  const Count count = meet(test::small_robot(), from_all_sides, tests::samples(25, 3));
  EXPECT_LE(count.avoidable, 2);  // who is out of view by the time it comes near
}

TEST(WalkerJudge, TellsWhoComesTooLateToBeAvoided) {
  const NavigationConfig config = test::small_robot();
  test::World world;
  world.walkers.push_back({Vector2(0, 6.0), Vector2(0, -1.5)});  // over the robot at 3.3 s
  test::RunResult result;
  for (int i = 0; i < 40; ++i) result.states.push_back({0.1 * i, RobotPose{}, VelocityCommand{}});
  const test::WalkerJudge judge(world, config);
  EXPECT_TRUE(judge.avoidable(result, {3.6, 0.5}));
  EXPECT_FALSE(judge.avoidable(result, {3.6, 3.0}));
  EXPECT_FALSE(judge.avoidable(result, {3.6, 1e9}));  // never seen
}

TEST(Walkers, AreRunIntoWithoutPrediction) {
  NavigationConfig config = test::small_robot();
  config.map.walker_horizon_s = 0;
  config.follow.walker_horizon_s = 0;
  const Count count = meet(config, crossing, tests::samples(20, 3));
  EXPECT_GT(count.avoidable, count.runs);
}

}  // namespace
}  // namespace surefoot::navigation
