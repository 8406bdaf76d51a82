// The obstacle of a scenario: where it stands, when it moves, that it is seen and felt.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/base/random.h"
#include "sim_hal/world/obstacle.h"
#include "sim_hal/world/terrain_index.h"
#include "tests/unit/sim_hal/sim_fixture.h"

namespace surefoot::sim {
namespace {

ObstacleConfig cube(std::initializer_list<ObstaclePlace> places) {
  ObstacleConfig config;
  config.length_m = config.width_m = 0.35;
  config.height_m = 0.4;
  for (const ObstaclePlace& place : places) EXPECT_TRUE(ok(config.places.push_back(place)));
  return config;
}

TEST(Obstacle, MovesWhenTheTrunkPassesItsLineEitherWay) {
  Obstacle obstacle(cube({{1.5, 0, 0, 0}, {1.2, 0.1, 0, 2.8}, {1.8, 0, 0, 0.2}}), {}, 1);
  ASSERT_TRUE(obstacle.exists());
  EXPECT_EQ(obstacle.box().x_m, 1.5);
  for (const double x : {0.0, 1.0, 2.7, 2.79}) EXPECT_FALSE(obstacle.follow(x));
  EXPECT_TRUE(obstacle.follow(2.81));
  EXPECT_EQ(obstacle.box().x_m, 1.2);
  EXPECT_EQ(obstacle.box().y_m, 0.1);
  for (const double x : {3.0, 2.79, 1.0, 0.21}) EXPECT_FALSE(obstacle.follow(x));
  EXPECT_TRUE(obstacle.follow(0.19));
  EXPECT_EQ(obstacle.box().x_m, 1.8);
  for (const double x : {0.1, 3.0, 0.1}) EXPECT_FALSE(obstacle.follow(x));
}

TEST(Obstacle, DrawsStayWithinTheirBoundsAndFollowTheSeed) {
  ObstacleConfig config = cube({{1.5, 0, 0, 0}});
  config.shift_m = 0.1;
  config.turn_rad = 0.5;
  std::set<double> places;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const TerrainBox box = Obstacle(config, {}, seed).box();
    EXPECT_LE(std::fabs(box.x_m - 1.5), 0.1);
    EXPECT_LE(std::fabs(box.y_m), 0.1);
    EXPECT_LE(std::fabs(std::atan2(box.sin_yaw, box.cos_yaw)), 0.5);
    EXPECT_EQ(Obstacle(config, {}, seed).box().x_m, box.x_m);
    places.insert(box.x_m);
  }
  EXPECT_GT(places.size(), 40U);
  EXPECT_FALSE(Obstacle(ObstacleConfig{}, {}, 1).exists());
}

// The same box as part of the terrain gives the same rays.
TEST(Obstacle, RaysMeetItLikeABoxOfTheTerrain) {
  ObstacleConfig config = cube({{1.0, 0.1, 0.4, 0}});
  const Obstacle obstacle(config, {}, 1);
  Terrain bare;
  Terrain with_box;
  with_box.boxes.push_back(obstacle.box());
  TerrainIndex shown(bare);
  shown.show(&obstacle.box());
  const TerrainIndex built(with_box);
  Random random(21);
  int hits = 0;
  for (int i = 0; i < 5000; ++i) {
    Vector3 origin;
    origin.x() = random.uniform(-0.5, 0.5);
    origin.y() = random.uniform(-0.5, 0.5);
    origin.z() = random.uniform(0.1, 0.6);
    Vector3 direction;
    direction.x() = random.uniform(0.2, 1.0);
    direction.y() = random.uniform(-0.5, 0.5);
    direction.z() = random.uniform(-0.5, 0.1);
    const double expected = built.cast(origin, direction, 3.0);
    const double got = shown.cast(origin, direction, 3.0);
    if (expected == kNoHit) {
      EXPECT_EQ(got, kNoHit);
      continue;
    }
    EXPECT_NEAR(got, expected, 1e-12);
    if (origin.z() + got * direction.z() > 1e-6) ++hits;
  }
  EXPECT_GT(hits, 500);
}

TEST(Obstacle, ATouchIsCountedAndItIsNoGround) {
  SimulatorConfig config;
  config.scenario.obstacle = cube({{0.37, 0, 0, 0}});  // 0.195 m ahead of the trunk's centre
  Rig near({}, config);
  near.stand(0.5);
  EXPECT_GT(near.simulator->truth().obstacle_steps, 0U);
  EXPECT_EQ(near.simulator->terrain_height_m(0.37, 0), 0.4);
  EXPECT_EQ(near.simulator->terrain_figures().max_step_m, 0);
  config.scenario.obstacle = cube({{1.0, 0, 0, 0}});
  Rig far({}, config);
  far.stand(0.5);
  EXPECT_EQ(far.simulator->truth().obstacle_steps, 0U);
}

}  // namespace
}  // namespace surefoot::sim
