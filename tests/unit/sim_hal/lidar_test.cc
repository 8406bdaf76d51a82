// The laser scanner's model: ranges against a brute-force oracle, its errors against their figures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <vector>

#include "sim_hal/robot/articulation.h"
#include "sim_hal/sensors/sim_lidar_port.h"
#include "tests/unit/sim_hal/sim_fixture.h"

namespace surefoot::sim {
namespace {

constexpr double kPi = 3.14159265;

robot::LidarSpecification scanner() {
  robot::LidarSpecification lidar;
  lidar.mount = {{0.15, 0, 0.12}, {0, 0, 0}};
  lidar.beams = 361;
  lidar.view_rad = kPi;
  lidar.rate_Hz = 75;
  lidar.min_range_m = 0.1;
  lidar.max_range_m = 30;
  return lidar;
}

// A scanner in a world, carried along by hand.
class Scanner {
 public:
  explicit Scanner(Terrain world, const robot::LidarSpecification& specification = scanner(),
                   const LidarNoiseConfig& noise = LidarNoiseConfig(), std::uint64_t seed = 1)
      : terrain(std::move(world)),
        index(terrain),
        solids(terrain.solids, terrain.saplings),
        port(specification, noise, FaultConfig(), index, solids, seed),
        scan(std::make_unique<hal::LidarScan>()) {
    index.show(&solids);
  }
  // Until the next scan is there.
  bool next(const std::vector<Solid>& moving = {}) {
    for (int i = 0; i < 60; ++i) {
      now = now + microseconds(500);
      position += 0.0005 * velocity;
      yaw += 0.0005 * yaw_rate;
      port.advance(now, position, rotation_z(yaw), moving, nullptr);
      if (ok(port.receive(*scan))) return true;
    }
    return false;
  }

  Terrain terrain;
  TerrainIndex index;
  SolidIndex solids;
  SimLidarPort port;
  std::unique_ptr<hal::LidarScan> scan;
  TimeNs now;
  Vector3 position = Vector3(0, 0, 0.3);
  Vector3 velocity = Vector3::Zero();
  double yaw = 0;
  double yaw_rate = 0;
};

Terrain forest(std::uint64_t seed) {
  WorldSpec spec;
  spec.generator = Generator::kForest;
  spec.length_to_goal_m = 40;
  return make_terrain(spec, seed);
}

Terrain with_trunk(double x, double y, double radius) {
  Terrain terrain;
  terrain.solids.push_back({SolidKind::kTrunk, {Vector3(x, y, -1), Vector3(x, y, 6), radius}, {}});
  return terrain;
}

TEST(Lidar, RangesAreThoseOfAllSolidsOneByOne) {
  Scanner scanner(forest(3));
  ASSERT_TRUE(scanner.next());
  const Vector3 origin = scanner.position + Vector3(0.15, 0, 0.12);
  int solid = 0;
  for (std::size_t i = 0; i < 361; ++i) {
    const double angle = -kPi / 2 + static_cast<double>(i) * kPi / 360;
    const Vector3 along(std::cos(angle), std::sin(angle), 0);
    double nearest = kNoHit;
    for (const Solid& other : scanner.terrain.solids) {
      nearest = std::min(nearest, cast_solid(other, origin, along));
    }
    double ground = kNoHit;
    for (double t = 0.002; t < std::min(nearest, 30.0); t += 0.002) {
      const Vector3 p = origin + t * along;
      if (p.z() > scanner.terrain.height_m(p.x(), p.y())) continue;
      ground = t;
      break;
    }
    const double expected = std::min(nearest, ground);
    const double found = scanner.scan->range_m[i];
    if (expected > 30) {
      EXPECT_EQ(found, 0.0) << i;
    } else {
      EXPECT_NEAR(found, expected, 0.003) << i;
    }
    solid += nearest < ground && nearest < 30 ? 1 : 0;
  }
  EXPECT_GT(solid, 50);
}

TEST(Lidar, NoiseDropOutsAndLimitsAreThoseOfTheFile) {
  robot::LidarSpecification specification = scanner();
  specification.range_noise_m = 0.01;
  LidarNoiseConfig noise;
  noise.random_dropout = 0.05;
  Terrain terrain;
  Solid wall;
  wall.kind = SolidKind::kWall;
  wall.box = {5, 0, 0.2, 20, -1, 3, 1, 0};
  terrain.solids.push_back(wall);
  Scanner scanner(terrain, specification, noise);
  double sum = 0;
  double squares = 0;
  int count = 0;
  int lost = 0;
  for (int k = 0; k < 50; ++k) {
    ASSERT_TRUE(scanner.next());
    for (std::size_t i = 140; i <= 220; ++i) {
      const double angle = (static_cast<double>(i) - 180) * kPi / 360;
      const double exact = (5 - 0.2 - 0.15) / std::cos(angle);
      const double found = scanner.scan->range_m[i];
      if (found == 0) {
        ++lost;
        continue;
      }
      sum += found - exact;
      squares += (found - exact) * (found - exact);
      ++count;
    }
    EXPECT_EQ(scanner.scan->range_m[0], 0.0F);  // sideways: nothing
  }
  EXPECT_NEAR(sum / count, 0.0, 0.001);
  EXPECT_NEAR(std::sqrt(squares / count), 0.01, 0.0006);
  EXPECT_NEAR(static_cast<double>(lost) / (lost + count), 0.05, 0.012);
}

// A pole 1 m before a wall: at its edges, and only there, ranges come between.
TEST(Lidar, BeamsOnTwoSurfacesGiveRangesBetween) {
  robot::LidarSpecification specification = scanner();
  specification.beam_divergence_rad = 0.011;
  LidarNoiseConfig noise;
  noise.mixed_pixel = 1.0;
  Terrain terrain = with_trunk(4.15, 0, 0.15);
  Solid wall;
  wall.kind = SolidKind::kWall;
  wall.box = {5.35, 0, 0.2, 20, -1, 3, 1, 0};
  terrain.solids.push_back(wall);
  Scanner scanner(terrain, specification, noise);
  int between = 0;
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(scanner.next());
    for (std::size_t i = 120; i <= 240; ++i) {
      const double angle = (static_cast<double>(i) - 180) * kPi / 360;
      const double range = scanner.scan->range_m[i] * std::cos(angle);
      const bool mixed = range > 4.05 && range < 4.98;
      between += mixed ? 1 : 0;
      EXPECT_TRUE(!mixed || std::fabs(std::fabs(angle) - 0.0375) < 0.009) << angle;
    }
  }
  EXPECT_GE(between, 20);
  EXPECT_LE(between, 80);
  EXPECT_GT(scanner.port.lidar_counters().mixed, 0U);
}

// Each beam leaves from where the body is at that moment.
TEST(Lidar, BeamsLeaveWhereTheBodyIsThen) {
  Scanner scanner(with_trunk(3, 0, 0.3));
  scanner.velocity = Vector3(0, 2.0, 0);
  scanner.yaw_rate = 1.5;
  for (int k = 0; k < 3; ++k) ASSERT_TRUE(scanner.next());
  const hal::LidarScan& scan = *scanner.scan;
  EXPECT_NEAR(static_cast<double>(scan.beam_interval.ns) * 360, 1e9 / 75 / 2, 400);
  int seen = 0;
  for (std::size_t i = 0; i < scan.beam_count; ++i) {
    const TimeNs at = scan.stamp + scan.beam_interval * static_cast<std::int64_t>(i);
    const double yaw = 1.5 * at.seconds();
    const Vector3 mount = rotation_z(yaw) * Vector3(0.15, 0, 0.12);
    const Vector3 origin = Vector3(0, 2.0 * at.seconds(), 0.3) + mount;
    const double angle = yaw - kPi / 2 + static_cast<double>(i) * kPi / 360;
    const double exact =
        cast_solid(scanner.terrain.solids[0], origin, Vector3(std::cos(angle), std::sin(angle), 0));
    if (exact == kNoHit) continue;
    EXPECT_NEAR(scan.range_m[i], exact, 0.002) << i;
    ++seen;
  }
  EXPECT_GT(seen, 10);
}

TEST(Lidar, SaplingsAnswerNowAndThen) {
  robot::LidarSpecification specification = scanner();
  specification.beam_divergence_rad = 0.011;
  LidarNoiseConfig noise;
  noise.sapling_return = 0.3;
  Terrain terrain;
  terrain.saplings.push_back({2.15, 0, 0.01, 0, 1.5});
  Scanner scanner(terrain, specification, noise);
  int seen = 0;
  for (int k = 0; k < 200; ++k) {
    ASSERT_TRUE(scanner.next());
    for (std::size_t i = 170; i <= 190; ++i) {
      if (scanner.scan->range_m[i] == 0) continue;
      EXPECT_NEAR(scanner.scan->range_m[i], 2.0, 0.02);
      ++seen;
    }
  }
  EXPECT_GT(seen, 20);
  EXPECT_LT(seen, 250);
}

TEST(Lidar, PeopleAreSeenWhereTheyAre) {
  Scanner scanner((Terrain()));
  Solid person;
  person.kind = SolidKind::kWalker;
  person.capsule = {Vector3(4.15, 0, -1), Vector3(4.15, 0, 1.5), 0.25};
  ASSERT_TRUE(scanner.next({person}));
  EXPECT_NEAR(scanner.scan->range_m[180], 3.75, 1e-6);
  ASSERT_TRUE(scanner.next());
  EXPECT_EQ(scanner.scan->range_m[180], 0.0F);
}

TEST(Lidar, AScanIsTheSameWhoeverFetchedTheOthers) {
  robot::LidarSpecification specification = scanner();
  specification.range_noise_m = 0.01;
  specification.beam_divergence_rad = 0.011;
  LidarNoiseConfig noise;
  noise.mixed_pixel = 0.5;
  noise.sapling_return = 0.3;
  Scanner all(forest(3), specification, noise);
  Scanner last(forest(3), specification, noise);
  for (int k = 0; k < 6; ++k) ASSERT_TRUE(all.next());
  while (last.now < all.now) {
    last.now = last.now + microseconds(500);
    last.port.advance(last.now, last.position, rotation_z(0), {}, nullptr);
  }
  for (int k = 0; k < 6; ++k) ASSERT_TRUE(ok(last.port.receive(*last.scan)));
  EXPECT_EQ(all.scan->sequence, last.scan->sequence);
  EXPECT_EQ(all.scan->range_m, last.scan->range_m);
  EXPECT_EQ(last.port.counters().dropped, 0U);
}

TEST(Lidar, AScanOfAForestIsCheap) {
  robot::LidarSpecification specification = scanner();
  specification.beam_divergence_rad = 0.011;
  Scanner scanner(forest(5), specification);
  const std::clock_t begin = std::clock();  // of this process: the machine does other things
  constexpr int kScans = 40;
  for (int k = 0; k < kScans; ++k) {
    scanner.position.x() += 1.0;
    ASSERT_TRUE(scanner.next());
  }
  const double took_us = 1e6 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  RecordProperty("scan_us", static_cast<int>(took_us / kScans));
  EXPECT_LT(took_us / kScans, 6'000);
}

}  // namespace
}  // namespace surefoot::sim
