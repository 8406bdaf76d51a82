// Whole runs in a flat world: does the robot arrive, touch nothing, and give up only when it must?
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/samples.h"
#include "tests/unit/navigation/parts.h"
#include "tests/unit/navigation/world.h"

namespace surefoot::navigation {
namespace {

using test::RunOptions;
using test::RunResult;
using test::Simulation;
using test::World;

RunOptions options(const Vector2& goal, std::uint64_t seed = 1) {
  RunOptions made;
  made.config = test::small_robot();
  made.goal = goal;
  made.seed = seed;
  return made;
}

RunResult run(const World& world, const RunOptions& options) {
  return Simulation(world, options).run();
}

World forest(std::uint64_t seed, double length_m, double per_m2) {
  Random random(seed, 11);
  World world;
  const int posts = static_cast<int>(length_m * 30 * per_m2);
  for (int i = 0; i < posts; ++i) {
    test::Circle post;
    post.p[0] = random.uniform(1.5, length_m - 1.5);
    post.p[1] = random.uniform(-15, 15);
    post.r = random.uniform(0.06, 0.3);
    world.circles.push_back(post);
  }
  return world;
}

TEST(Runs, CrossesForests) {
  for (int seed = 0; seed < tests::samples(6, 2); ++seed) {
    const auto number = static_cast<std::uint64_t>(seed);
    const RunResult result = run(forest(number, 40, 0.15), options(Vector2(40, 0), number));
    EXPECT_EQ(result.state, NavigationState::kArrived) << seed << to_string(result.reason);
    EXPECT_GT(result.least_gap_m, 0.0) << seed;
    EXPECT_LT(result.length_m, 60) << seed;
    EXPECT_LE(result.largest_step_m_s, 0.05);
    EXPECT_LE(result.largest_yaw_step_rad_s, 0.05);
  }
}

TEST(Runs, GoesRoundWideWalls) {
  for (int seed = 0; seed < tests::samples(12, 1); ++seed) {
    Random random(static_cast<std::uint64_t>(seed), 12);
    const double width_m = seed < 10 ? random.uniform(8, 25) : (seed == 10 ? 40 : 60);
    const double aside_m = seed < 10 ? random.uniform(-3, 3) : 0;
    World world;
    world.walls.push_back({Vector2(10, aside_m - width_m / 2), Vector2(10, aside_m + width_m / 2)});
    RunOptions o = options(Vector2(25, 0), static_cast<std::uint64_t>(seed));
    o.limit_s = 500;
    const RunResult result = run(world, o);
    EXPECT_EQ(result.state, NavigationState::kArrived) << width_m << to_string(result.reason);
    EXPECT_GT(result.least_gap_m, 0.0) << seed;
    EXPECT_LT(result.length_m, width_m + 40) << width_m;
  }
}

TEST(Runs, LeavesCulDeSacs) {
  for (int seed = 0; seed < tests::samples(10, 1); ++seed) {
    Random random(static_cast<std::uint64_t>(seed), 13);
    const double half_m = random.uniform(2, 5);
    const double depth_m = random.uniform(5, 15);
    World world;
    world.walls.push_back({Vector2(5, half_m), Vector2(5 + depth_m, half_m)});
    world.walls.push_back({Vector2(5, -half_m), Vector2(5 + depth_m, -half_m)});
    world.walls.push_back({Vector2(5 + depth_m, -half_m), Vector2(5 + depth_m, half_m)});
    RunOptions o = options(Vector2(30, 0), static_cast<std::uint64_t>(seed));
    o.start.p_O_m = Vector2(5 + depth_m - 2, 0);
    const RunResult result = run(world, o);
    EXPECT_EQ(result.state, NavigationState::kArrived)
        << half_m << " " << depth_m << to_string(result.reason);
    EXPECT_GT(result.least_gap_m, 0.0) << seed;
  }
}

TEST(Runs, SaysThatThereIsNoPathWhenEnclosed) {
  for (const double radius_m : {3.0, 8.0}) {
    for (const bool goal_inside : {false, true}) {
      World world;
      const Vector2 middle(goal_inside ? 12.0 : 0.0, 0);
      for (int i = 0; i < 24; ++i) {
        const double a = M_PI / 12 * i;
        const double b = M_PI / 12 * (i + 1);
        world.walls.push_back({middle + Vector2(std::cos(a), std::sin(a)) * radius_m,
                               middle + Vector2(std::cos(b), std::sin(b)) * radius_m});
      }
      RunOptions o = options(Vector2(goal_inside ? 12.0 : 30.0, 0));
      const RunResult result = run(world, o);
      EXPECT_EQ(result.state, NavigationState::kNoPath) << radius_m << to_string(result.reason);
      // As soon as a robot of 0.5 m/s can have looked at it from all sides.
      const double round_m = goal_inside ? 2 * M_PI * (radius_m + 1) : 0;
      EXPECT_LT(result.time_s, 60 + round_m / o.config.follow.cruise_m_s);
      EXPECT_GT(result.least_gap_m, 0.0);
    }
  }
}

int side_changes(const RunResult& result, const Vector2& middle) {
  int changes = 0;
  int side = 0;
  for (const auto& plan : result.plans) {
    for (std::size_t i = 1; i < plan.size(); ++i) {
      if ((plan[i - 1][0] - middle[0]) * (plan[i][0] - middle[0]) > 0) continue;
      const int now = plan[i][1] > middle[1] ? 1 : -1;
      if (side != 0 && now != side) ++changes;
      side = now;
      break;
    }
  }
  return changes;
}

TEST(Runs, KeepsToOneSideOfASymmetricObstacle) {
  int worst = 0;
  for (int seed = 0; seed < tests::samples(100, 3); ++seed) {
    World world;
    world.walls.push_back({Vector2(6, -3), Vector2(6, 3)});
    const RunResult result = run(world, options(Vector2(12, 0), static_cast<std::uint64_t>(seed)));
    EXPECT_EQ(result.state, NavigationState::kArrived) << seed << to_string(result.reason);
    EXPECT_GT(result.least_gap_m, 0.0) << seed;
    worst = std::max(worst, side_changes(result, Vector2(6, 0)));
  }
  EXPECT_LE(worst, 1);
}

// Plans made again and again on the spot before a wall, with 2 cm of noise on all that is seen.
// A goal set anew forgets the paths.
int changes_on_the_spot(bool remember) {
  const auto navigator = std::make_unique<Navigator>();
  const auto objects = std::make_unique<objects::Objects>();
  Random random(1);
  EXPECT_TRUE(ok(navigator->reset(test::small_robot())));
  EXPECT_TRUE(ok(navigator->set_goal(Vector2(12, 0))));
  RunResult result;
  for (int i = 0; i < tests::samples(100, 10); ++i) {
    objects->clear();
    for (double y = -3; y <= 3; y += 1.5) {
      objects::Object piece;
      piece.centre_O_m = Vector2(6, y);
      for (int k = -5; k <= 5; ++k) {
        const double x = 6 + 0.02 * random.normal();
        static_cast<void>(piece.points_O_m.push_back(Vector2(x, y + 0.15 * k)));
      }
      static_cast<void>(objects->push_back(piece));
    }
    RobotPose robot;
    robot.p_O_m[1] = 0.02 * random.normal();
    if (!remember) {
      EXPECT_TRUE(ok(navigator->set_goal(Vector2(12, 0))));
    }
    navigator->plan(*objects, robot, milliseconds(1000) * i);
    std::vector<Vector2> plan;
    for (const PathPoint& point : navigator->path()) plan.push_back(point.p_O_m);
    result.plans.push_back(plan);
  }
  return side_changes(result, Vector2(6, 0));
}

TEST(Runs, ChangesSidesMoreOftenWithoutMemoryOfThePath) {
  const int with = changes_on_the_spot(true);
  const int without = changes_on_the_spot(false);
  std::printf("changes of side in 100 plans: %d, without memory of the path %d\n", with, without);
  EXPECT_LE(with, 1);
  EXPECT_GT(without, tests::samples(5, 0));
}

// Two walls with a gate 6 m ahead that closes while the robot is on its way to it.
TEST(Runs, GoesRoundWhenAGateCloses) {
  for (int seed = 0; seed < tests::samples(10, 1); ++seed) {
    World world;
    world.walls.push_back({Vector2(6, -6), Vector2(6, -1)});
    world.walls.push_back({Vector2(6, 1), Vector2(6, 6)});
    RunOptions o = options(Vector2(12, 0), static_cast<std::uint64_t>(seed));
    o.change = [seed](World& changed, double t_s) {
      if (t_s < 3.0 + 0.5 * seed || changed.walls.size() > 2) return;
      changed.walls.push_back({Vector2(6, -1), Vector2(6, 1)});
    };
    const RunResult result = run(world, o);
    EXPECT_EQ(result.state, NavigationState::kArrived) << seed << to_string(result.reason);
    EXPECT_GT(result.least_gap_m, 0.0) << seed;
  }
}

}  // namespace
}  // namespace surefoot::navigation
