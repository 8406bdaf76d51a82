// Solids against oracles: rays against all of them and against closed forms, distances against
// sampled outlines.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "sim_hal/world/solid.h"
#include "sim_hal/world/solid_index.h"
#include "sim_hal/world/terrain.h"
#include "sim_hal/world/terrain_index.h"

namespace surefoot::sim {
namespace {

Solid trunk(double x, double y, double radius) {
  return {SolidKind::kTrunk, {Vector3(x, y, -1), Vector3(x, y, 6), radius}, {}};
}

Solid ball(const Vector3& centre, double radius) {
  return {SolidKind::kBoulder, {centre, centre, radius}, {}};
}

Solid wall(double x, double y, double half_length, double half_width, double yaw) {
  Solid solid;
  solid.kind = SolidKind::kWall;
  solid.box = {x, y, half_length, half_width, 0, 1.5, std::cos(yaw), std::sin(yaw)};
  return solid;
}

Terrain forest(std::uint64_t seed, double length_m = 20) {
  WorldSpec spec;
  spec.generator = Generator::kForest;
  spec.length_to_goal_m = length_m;
  return make_terrain(spec, seed);
}

Vector3 direction(Random& random, double steepest) {
  const double heading = random.uniform(0.0, 6.283185307);
  const double rise = random.uniform(-steepest, steepest);
  return {std::cos(heading) * std::cos(rise), std::sin(heading) * std::cos(rise), std::sin(rise)};
}

TEST(Solid, RaysMeetCylinderAndBallWhereGeometrySays) {
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const double off = random.uniform(-0.29, 0.29);
    const double far = random.uniform(1.0, 20.0);
    const double rise = random.uniform(-0.1, 0.1);
    const Vector3 along(std::cos(rise), 0, std::sin(rise));
    const double z = far * std::tan(rise);
    const double half = std::sqrt(0.3 * 0.3 - off * off);
    const Vector3 origin(-far, off, 2.5);
    EXPECT_NEAR(cast_solid(trunk(0, 0, 0.3), origin, along), (far - half) / std::cos(rise), 1e-9);
    const Solid boulder = ball(Vector3(0, 0, 2.5 + z), 0.3);
    EXPECT_NEAR(cast_solid(boulder, origin, along), far / std::cos(rise) - half, 1e-9);
  }
  EXPECT_EQ(cast_solid(trunk(0, 0, 0.3), Vector3(-5, 0.31, 1), Vector3(1, 0, 0)), kNoHit);
  EXPECT_EQ(cast_solid(trunk(0, 0, 0.3), Vector3(-5, 0, 1), Vector3(-1, 0, 0)), kNoHit);
}

TEST(Solid, TheIndexFindsWhatAllOfThemAreAskedFor) {
  const Terrain terrain = forest(7);
  const SolidIndex index(terrain.solids, terrain.saplings);
  Random random(11);
  int hits = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double x = random.uniform(-12.0, 32.0);
    const double y = random.uniform(-24.0, 24.0);
    const Vector3 origin(x, y, random.uniform(0.3, 3.0));
    const Vector3 along = direction(random, 0.3);
    double nearest = kNoHit;
    for (const Solid& solid : terrain.solids) {
      nearest = std::min(nearest, cast_solid(solid, origin, along));
    }
    if (nearest > 30.0) nearest = kNoHit;
    const double found = index.cast(origin, along, 30.0);
    if (nearest == kNoHit) {
      EXPECT_EQ(found, kNoHit);
    } else {
      EXPECT_NEAR(found, nearest, 1e-12);
    }
    hits += nearest != kNoHit ? 1 : 0;
  }
  EXPECT_GT(hits, 3000);
}

// A march of a millimetre: slow, but without any index.
TEST(Solid, FarRaysMeetTheGroundWhereAFineMarchDoes) {
  const Terrain terrain = forest(9, 12);
  TerrainIndex index(terrain);
  const std::vector<Solid> no_solids;
  const std::vector<Sapling> no_saplings;
  const SolidIndex none(no_solids, no_saplings);
  index.show(&none);
  Random random(5);
  for (int i = 0; i < 300; ++i) {
    const double x = random.uniform(-4.0, 14.0);
    const double y = random.uniform(-8.0, 8.0);
    const Vector3 origin(x, y, terrain.height_m(x, y) + random.uniform(0.2, 1.0));
    const Vector3 along = direction(random, 0.2);
    const double found = index.cast(origin, along, 10.0);
    double marched = kNoHit;
    for (double t = 0.001; t <= 10.0; t += 0.001) {
      const Vector3 p = origin + t * along;
      if (p.z() > terrain.height_m(p.x(), p.y())) continue;
      marched = t;
      break;
    }
    if (found == kNoHit || marched == kNoHit) {
      EXPECT_EQ(found == kNoHit, marched == kNoHit || marched > 9.99) << i;
    } else {
      EXPECT_NEAR(found, marched, 0.002) << i;
    }
  }
}

TEST(Solid, PlanDistancesAreThoseOfSampledOutlines) {
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const double yaw = random.uniform(-3.0, 3.0);
    const double length = random.uniform(0.3, 3.0);
    const Solid box = wall(0, 0, length, 0.2, yaw);
    Solid log = ball(Vector3(0, 0, 0.1), 0.2);
    log.capsule.b_m = Vector3(length * std::cos(yaw), length * std::sin(yaw), 0.1);
    const double ax = random.uniform(-4.0, 4.0);
    const double ay = random.uniform(-4.0, 4.0);
    const double bx = ax + random.uniform(-0.3, 0.3);
    const double by = ay + random.uniform(-0.3, 0.3);
    const Vector2 a(ax, ay);
    const Vector2 b(bx, by);
    double to_box = kNoHit;
    double to_log = kNoHit;
    for (int k = 0; k <= 60; ++k) {
      const Vector2 p = a + k / 60.0 * (b - a);
      for (int m = 0; m <= 200; ++m) {
        const double s = -length + 2 * length * m / 200;
        for (const double side : {-0.2, 0.0, 0.2}) {
          const Vector2 q(std::cos(yaw) * s - std::sin(yaw) * side,
                          std::sin(yaw) * s + std::cos(yaw) * side);
          to_box = std::min(to_box, (p - q).norm());
        }
        const double part = 0.5 * (s + length);
        const Vector2 q(std::cos(yaw) * part, std::sin(yaw) * part);
        to_log = std::min(to_log, (p - q).norm() - 0.2);
      }
    }
    Vector2 away;
    const double box_m = plan_distance_m(box, a, b, away);
    EXPECT_NEAR(away.norm(), 1.0, 1e-9);
    EXPECT_TRUE(box_m <= 0 || std::fabs(box_m - to_box) < 0.02) << box_m << " " << to_box;
    const double log_m = plan_distance_m(log, a, b, away);
    EXPECT_NEAR(away.norm(), 1.0, 1e-9);
    EXPECT_NEAR(log_m, to_log, 0.02);
    // Moved off, it touches at most; where the axes cross, after a few times.
    Vector2 off = Vector2::Zero();
    for (int k = 0; k < 4; ++k) {
      const double left = plan_distance_m(log, a + off, b + off, away);
      if (left < 0) off -= left * away;
    }
    EXPECT_GT(plan_distance_m(log, a + off, b + off, away), -0.01);
  }
}

TEST(Solid, TopsAreThoseOfRaysFromAbove) {
  const Terrain terrain = forest(4, 12);
  const SolidIndex index(terrain.solids, terrain.saplings);
  Random random(8);
  int above = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double x = random.uniform(-7.0, 19.0);
    const double y = random.uniform(-19.0, 19.0);
    const double t = index.cast(Vector3(x, y, 100), Vector3(0, 0, -1), 200);
    const double top = index.top_m(x, y);
    if (t == kNoHit) {
      EXPECT_LT(top, -1e9);
    } else {
      EXPECT_NEAR(top, 100 - t, 1e-6);
      ++above;
    }
  }
  EXPECT_GT(above, 100);
}

}  // namespace
}  // namespace surefoot::sim
