// The plant without legs: what README.md "The fast plant" says of it.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <ctime>
#include <memory>

#include "core/base/hash.h"
#include "tests/unit/sim_hal/sim_fixture.h"

namespace surefoot::sim {
namespace {

SimulatorConfig fast() {
  SimulatorConfig config;
  config.plant = PlantKind::kFast;
  config.lidar.present = true;
  return config;
}

robot::RobotModel scanning() {
  robot::RobotModel robot = mini_cheetah();
  robot.lidar.mount = {{0.15, 0, 0.12}, {0, 0, 0}};
  robot.lidar.beams = 361;
  robot.lidar.view_rad = 3.14159265;
  robot.lidar.rate_Hz = 75;
  robot.lidar.min_range_m = 0.1;
  robot.lidar.max_range_m = 30;
  robot.lidar.range_noise_m = 0.01;
  robot.lidar.beam_divergence_rad = 0.011;
  return robot;
}

// Pictures take most of the time and change nothing here.
robot::RobotModel blind() {
  robot::RobotModel robot = mini_cheetah();
  robot.depth_camera.rate_Hz = 0;
  return robot;
}

WorldSpec of(Generator generator, double length_m = 20) {
  WorldSpec spec;
  spec.generator = generator;
  spec.length_to_goal_m = length_m;
  spec.goal_x_m = 14;
  return spec;
}

// Walks with one command; integrates what the port tells.
class Walk {
 public:
  explicit Walk(const WorldSpec& world = WorldSpec(), std::uint64_t seed = 1,
                const robot::RobotModel& robot = blind())
      : simulator(robot, world, fast(), seed), board(simulator.board()) {}

  void go(double seconds, const hal::GaitCommand& command, bool send = true) {
    const int ticks = static_cast<int>(seconds / 0.002);
    for (int i = 0; i < ticks; ++i) {
      if (send) sent = ok(board.gait->send(command)) && sent;
      time = time + milliseconds(2);
      EXPECT_TRUE(ok(board.clock->wait_until(time)));
      while (ok(board.gait->receive(sample))) {
        way_m += 0.002 * sample.velocity_B_m_s[0];
        ++samples;
      }
      while (board.imu->receive(imu) > 0) {
      }
    }
  }
  double yaw() const {
    const auto q = simulator.truth().q_WB_wxyz;
    return std::atan2(2 * (q[0] * q[3] + q[1] * q[2]), 1 - 2 * (q[2] * q[2] + q[3] * q[3]));
  }

  Simulator simulator;
  hal::Board board;
  TimeNs time;
  hal::GaitSample sample;
  std::array<hal::ImuSample, 16> imu{};
  double way_m = 0;
  int samples = 0;
  bool sent = true;
};

TEST(FastPlant, StandsWithinASecondAndWaits) {
  Walk walk;
  walk.go(0.2, {});
  EXPECT_FALSE(walk.sample.standing);
  walk.go(0.8, {true, 1, 0, 0});
  EXPECT_TRUE(walk.sample.standing);
  EXPECT_NEAR(walk.sample.height_m, 0.308, 0.02);
  EXPECT_EQ(walk.samples, 500);
  const double x = walk.simulator.truth().p_WB_m[0];
  walk.go(3, {});
  EXPECT_NEAR(walk.simulator.truth().p_WB_m[0], x, 0.1);
}

// Speeds within the errors of a run; drift of the odometry within 2.5 %.
TEST(FastPlant, FollowsCommandsWithItsErrors) {
  double worst_drift = 0;
  double sum_drift = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Walk walk(WorldSpec(), seed);
    walk.go(1.5, {});
    walk.go(1.0, {true, 0.6, 0, 0});
    const auto from = walk.simulator.truth().p_WB_m;
    const double yaw = walk.yaw();
    walk.way_m = 0;
    walk.go(20, {true, 0.6, 0, 0});
    const auto to = walk.simulator.truth().p_WB_m;
    const double way = std::hypot(to[0] - from[0], to[1] - from[1]);
    EXPECT_NEAR(way / 20, 0.6, 0.09) << seed;
    EXPECT_LT(std::fabs(walk.yaw() - yaw), 1.2) << seed;
    const double drift = std::fabs(walk.way_m / way - 1);
    worst_drift = std::max(worst_drift, drift);
    sum_drift += drift;
    const double before = walk.yaw();
    walk.go(2, {true, 0, 0, 0.5});
    EXPECT_NEAR(walk.yaw() - before, 1.0, 0.35) << seed;
  }
  EXPECT_LT(worst_drift, 0.05);
  EXPECT_GT(sum_drift / 10, 0.004);
}

TEST(FastPlant, StopsByItselfWhenNoCommandComes) {
  Walk walk;
  walk.go(2, {true, 0.6, 0, 0});
  EXPECT_GT(walk.simulator.truth().v_WB_m_s[0], 0.3);
  walk.go(1.5, {}, false);
  const auto v = walk.simulator.truth().v_WB_m_s;
  EXPECT_LT(std::hypot(v[0], v[1]), 0.05);
}

TEST(FastPlant, GoesOverHillsAndTellsOfThemToTheInertialSensor) {
  Walk walk(of(Generator::kForest), 3);
  walk.go(1.2, {});
  double worst_m = 0;
  for (int i = 0; i < 40; ++i) {
    walk.go(0.1, {true, 0.5, 0, 0});
    const auto p = walk.simulator.truth().p_WB_m;
    worst_m = std::max(worst_m, std::fabs(p[2] - walk.simulator.ground_height_m(p[0], p[1]) - 0.3));
    const auto& force = walk.imu[0].specific_force_I_m_s2;
    const double size = std::sqrt(force[0] * force[0] + force[1] * force[1] + force[2] * force[2]);
    EXPECT_NEAR(size, 9.81, 6.0);
  }
  EXPECT_LT(worst_m, 0.12);
}

// What the IMU says, integrated, is how the body moved: gyroscope against the truth's yaw.
TEST(FastPlant, GyroscopeAndPoseAgree) {
  Walk walk;
  walk.go(1.2, {});
  double turned = 0;
  const double before = walk.yaw();
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(ok(walk.board.gait->send({true, 0.3, 0, 0.8})));
    walk.time = walk.time + milliseconds(2);
    ASSERT_TRUE(ok(walk.board.clock->wait_until(walk.time)));
    const std::size_t count = walk.board.imu->receive(walk.imu);
    for (std::size_t k = 0; k < count; ++k) {
      turned += 0.001 * walk.imu[k].angular_velocity_I_rad_s[2];
    }
  }
  EXPECT_NEAR(turned, walk.yaw() - before, 0.03);
}

TEST(FastPlant, IsStoppedByAWallAndCountsIt) {
  Walk walk(of(Generator::kWall), 2);
  walk.go(1.2, {});
  EXPECT_EQ(walk.simulator.truth().obstacle_steps, 0U);
  walk.go(20, {true, 0.8, 0, 0});
  const Truth truth = walk.simulator.truth();
  EXPECT_GT(truth.obstacle_steps, 0U);
  EXPECT_NEAR(truth.clearance_m, 0.0, 0.02);
  EXPECT_LT(truth.p_WB_m[0], 7.0);
}

TEST(FastPlant, PeopleRunIntoIt) {
  bool met = false;
  for (std::uint64_t seed = 1; seed <= 4 && !met; ++seed) {
    Walk walk(of(Generator::kWalkers), seed);
    walk.go(1.2, {});
    const Truth before = walk.simulator.truth();
    EXPECT_GE(before.walker_count, 3);
    walk.go(9, {true, 0.8, 0, 0});
    walk.go(15, {});
    const Truth after = walk.simulator.truth();
    EXPECT_NE(before.walkers_W_m, after.walkers_W_m);
    met = after.obstacle_steps > 0;
  }
  EXPECT_TRUE(met);
}

TEST(FastPlant, StepsHigherThanATrotTakesCount) {
  WorldSpec spec;
  spec.generator = Generator::kPlatform;
  spec.height_m = 0.13;
  Walk walk(spec);
  walk.go(8, {true, 0.5, 0, 0});
  EXPECT_GT(walk.simulator.truth().obstacle_steps, 0U);
  spec.height_m = 0.08;
  Walk low(spec);
  low.go(8, {true, 0.5, 0, 0});
  EXPECT_EQ(low.simulator.truth().obstacle_steps, 0U);
}

TEST(FastPlant, SameSeedSameBits) {
  const auto hash = [](std::uint64_t seed) {
    Walk walk(of(Generator::kForest), seed, scanning());
    walk.go(3, {true, 0.5, 0.1, 0.2});
    const auto scan = std::make_unique<hal::LidarScan>();
    Fnv64 digest(walk.simulator.state_hash());
    while (ok(walk.board.lidar->receive(*scan))) {
      for (const float range : scan->range_m) digest.word(std::bit_cast<std::uint32_t>(range), 4);
    }
    return digest.value();
  };
  EXPECT_EQ(hash(4), hash(4));
  EXPECT_NE(hash(4), hash(5));
}

TEST(FastPlant, RefusesToLieAbout) {
  SimulatorConfig config = fast();
  config.scenario.start.kind = StartConfig::Kind::kRandomPose;
  EXPECT_THROW(Simulator(mini_cheetah(), WorldSpec(), config, 1), SimulatorError);
}

TEST(FastPlant, IsMuchFasterThanTime) {
  Walk walk(of(Generator::kForest, 40), 5, scanning());
  walk.go(1.2, {});
  const auto scan = std::make_unique<hal::LidarScan>();
  const std::clock_t begin = std::clock();
  for (int i = 0; i < 500; ++i) {
    walk.go(0.01, {true, 0.6, 0, 0});
    while (ok(walk.board.lidar->receive(*scan))) {
    }
  }
  const double took_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  RecordProperty("real_time_factor_x10", static_cast<int>(50 / took_s));
  EXPECT_LT(took_s, 2.5);
}

}  // namespace
}  // namespace surefoot::sim
