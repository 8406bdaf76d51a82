// Walls, slopes and trees under a body that pitches, each scan judged by what the beams really hit.
#include "core/objects/ground_or_wall.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/unit/objects/config.h"
#include "tests/unit/objects/scan_world.h"

namespace surefoot::objects {
namespace {

using test::plane_at;
using test::pose_at;
using test::ScanWorld;
using test::still;

constexpr double kHeight_m = 0.9;
constexpr double kPitch_rad = 0.05;
constexpr double kPitch_Hz = 1.5;

struct Share {
  int ground_as_obstacle = 0;
  int ground = 0;
  int thing_as_ground = 0;
  int thing = 0;
  double false_obstacle() const { return ground > 0 ? 1.0 * ground_as_obstacle / ground : 0; }
  double missed() const { return thing > 0 ? 1.0 * thing_as_ground / thing : 0; }
};

enum class Truth { kGround, kThing, kEither };

// What the truth says of a point. Ground within half a metre of a thing is one with it, and of a
// thing its lowest 0.3 m look like rough ground.
Truth truth(const ScanWorld& world, const SurfacePoint& point) {
  const double rise = static_cast<double>(point.z_O_m) - world.ground.at(point.p_O_m[0]);
  double away = 1e9;
  for (const test::Post& post : world.posts) {
    away = std::min(away, (point.p_O_m - post.centre_m).norm() - post.radius_m);
  }
  for (const test::Wall& wall : world.walls) {
    const Vector2 along = (wall.to_m - wall.from_m).normalized();
    const Vector2 off = point.p_O_m - wall.from_m;
    away = std::min(away, std::abs(along[0] * off[1] - along[1] * off[0]));
  }
  if (away > 0.5) return Truth::kGround;
  return away < 0.1 && rise > 0.3 ? Truth::kThing : Truth::kEither;
}

// Two seconds to warm up, four that count. stands_on: slope under the feet; the body follows it.
Share watch(const ScanWorld& world, double x, double stands_on, double pitch_rad,
            double speed_m_s = 0, double compact_range_m = test::config().compact_range_m) {
  const auto part = std::make_unique<GroundOrWall>();
  ObjectsConfig config = test::config();
  config.compact_range_m = compact_range_m;
  part->reset(config);
  const auto points = std::make_unique<SurfacePoints>();
  const auto obstacles = std::make_unique<SurfacePoints>();
  const auto grounds = std::make_unique<SurfacePoints>();
  Random random(4);
  ScanCounters beams;
  Share share;
  for (int n = 0; n < 450; ++n) {
    const double t = n / 75.0;
    const double at_x = x + speed_m_s * t;
    const double z = world.ground.at(at_x);
    const double pitch = -std::atan(stands_on) + pitch_rad * std::sin(math::kTwoPi * kPitch_Hz * t);
    const ScanPoses poses = still(pose_at(at_x, 0, z + kHeight_m, pitch));
    const TimeNs stamp{n * 13'333'333ll};
    scan_points(world.scan(poses, stamp, random), poses, test::config(), *points, beams);
    part->part(*points, stamp, plane_at(at_x, 0, z, stands_on), nullptr, *obstacles, *grounds);
    EXPECT_EQ(obstacles->size() + grounds->size(), points->size());
    if (n < 150) continue;
    for (const SurfacePoint& p : *obstacles) {
      share.ground_as_obstacle += truth(world, p) == Truth::kGround;
      share.ground += truth(world, p) == Truth::kGround;
      share.thing += truth(world, p) == Truth::kThing;
    }
    for (const SurfacePoint& p : *grounds) {
      share.thing_as_ground += truth(world, p) == Truth::kThing;
      share.ground += truth(world, p) == Truth::kGround;
      share.thing += truth(world, p) == Truth::kThing;
    }
  }
  return share;
}

TEST(GroundOrWall, ASlopeAheadIsNotFeared) {
  for (const double degrees : {3.0, 5.0, 8.0, 11.0}) {
    for (const double speed : {0.0, 1.0}) {
      ScanWorld world;
      world.ground = {.slope = std::tan(degrees * math::kPi / 180), .foot_x_m = 3};
      const Share share = watch(world, -3, 0, kPitch_rad, speed);
      std::printf("slope %4.1f deg ahead, %.0f m/s: %6d ground returns, %.4f taken for obstacles\n",
                  degrees, speed, share.ground, share.false_obstacle());
      EXPECT_GT(share.ground, 1000);
      EXPECT_LT(share.false_obstacle(), 0.01) << degrees;
    }
  }
}

TEST(GroundOrWall, ASlopeUnderTheFeetIsNotFeared) {
  for (const double degrees : {0.0, 5.0, 11.0, -11.0}) {
    ScanWorld world;
    const double slope = std::tan(degrees * math::kPi / 180);
    world.ground = {.slope = slope, .foot_x_m = -100};
    const Share share = watch(world, 0, slope, kPitch_rad);
    std::printf("on a slope of %5.1f deg: %6d ground returns, %.4f taken for obstacles\n", degrees,
                share.ground, share.false_obstacle());
    EXPECT_GT(share.ground, 1000);
    EXPECT_LT(share.false_obstacle(), 0.01) << degrees;
  }
}

TEST(GroundOrWall, AWallIsFoundOnEverySlopeAndDistance) {
  for (const double degrees : {0.0, 5.0, 11.0}) {
    for (const double away : {3.0, 5.0, 8.0, 12.0}) {
      ScanWorld world;
      const double slope = std::tan(degrees * math::kPi / 180);
      world.ground = {.slope = slope, .foot_x_m = -100};
      world.walls.push_back({{away, -15}, {away, 15}, 20 + slope * 120});
      const Share share = watch(world, 0, slope, kPitch_rad);
      std::printf("wall %4.1f m ahead on %4.1f deg: %6d returns, %.4f taken for ground\n", away,
                  degrees, share.thing, share.missed());
      EXPECT_LT(share.missed(), 0.05) << degrees << ' ' << away;
      EXPECT_LT(share.false_obstacle(), 0.03) << degrees << ' ' << away;
    }
  }
}

TEST(GroundOrWall, WithoutPitchingAWallIsFoundFromNearby) {
  ScanWorld world;
  world.walls.push_back({{3.5, -3}, {3.5, 3}, 20});
  EXPECT_EQ(watch(world, 0, 0, 0).missed(), 0);
}

TEST(GroundOrWall, APostFarAwayWaitsForASignOfItsHeight) {
  ScanWorld world;
  world.posts.push_back({{8, 0}, 0.2, 20});
  EXPECT_EQ(watch(world, 0, 0, 0, 0, 9.0).missed(), 0);
  EXPECT_EQ(watch(world, 0, 0, 0, 0, 5.0).missed(), 1);
  EXPECT_LT(watch(world, 0, 0, kPitch_rad, 0, 5.0).missed(), 0.05);
  EXPECT_EQ(watch(world, 3.5, 0, 0, 0, 5.0).missed(), 0);
}

TEST(GroundOrWall, TreesAreFoundOnSlopes) {
  for (const double degrees : {0.0, 5.0, 11.0}) {
    ScanWorld world;
    const double slope = std::tan(degrees * math::kPi / 180);
    world.ground = {.slope = slope, .foot_x_m = 2};
    for (int i = 0; i < 12; ++i) {
      world.posts.push_back({{3.0 + 0.8 * i, -6.0 + 4.9 * (i * 7 % 5) / 2}, 0.2, 50});
    }
    for (const double compact_range_m : {30.0, 5.0}) {
      const Share share = watch(world, 0, 0, kPitch_rad, 0, compact_range_m);
      std::printf(
          "trees before and on %4.1f deg: %6d returns, %.4f taken for ground, %.4f feared\n",
          degrees, share.thing, share.missed(), share.false_obstacle());
      EXPECT_LT(share.missed(), 0.05) << degrees;
      EXPECT_LT(share.false_obstacle(), 0.08) << degrees;
    }
  }
}

}  // namespace
}  // namespace surefoot::objects
