// Every generator's promises (contract.md "The worlds"), on several seeds.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/base/random.h"
#include "sim_hal/simulator_error.h"
#include "sim_hal/world/terrain.h"
#include "sim_hal/world/terrain_index.h"
#include "tests/unit/sim_hal/sim_fixture.h"

namespace surefoot::sim {
namespace {

WorldSpec spec(Generator generator, double height_m = 0, double cover = 0, double slope_rad = 0) {
  WorldSpec world;
  world.generator = generator;
  world.height_m = height_m;
  world.cover = cover;
  world.slope_rad = slope_rad;
  return world;
}

std::array<Vector2, 4> corners(const TerrainBox& box) {
  std::array<Vector2, 4> result;
  for (std::size_t k = 0; k < 4; ++k) {
    const double a = (k == 0 || k == 3 ? 1 : -1) * box.half_length_m;
    const double b = (k < 2 ? 1 : -1) * box.half_width_m;
    result[k] = Vector2(box.x_m + box.cos_yaw * a - box.sin_yaw * b,
                        box.y_m + box.sin_yaw * a + box.cos_yaw * b);
  }
  return result;
}

TEST(World, SlabsFillTheBoardAndReachExactlyTheirHeight) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Terrain terrain = make_terrain(spec(Generator::kRocks, 0.06), seed);
    double tallest = 0;
    for (const TerrainBox& slab : terrain.boxes) {
      EXPECT_EQ(slab.bottom_m, 0.0);
      tallest = std::max(tallest, slab.top_m);
      for (const Vector2& corner : corners(slab)) {
        EXPECT_GE(corner.x(), kFieldBegin_m - 1e-9);
        EXPECT_LE(corner.x(), kFieldBegin_m + kBoardLength_m + 1e-9);
        EXPECT_LE(std::fabs(corner.y()), kBoardWidth_m / 2 + 1e-9);
      }
    }
    EXPECT_NEAR(tallest, 0.06, 1e-12) << seed;
    int covered = 0;
    int levels = 0;
    double last = 0;
    constexpr int kSamples = 3000;
    Random random(seed);
    for (int i = 0; i < kSamples; ++i) {
      const double x = random.uniform(kFieldBegin_m, kFieldBegin_m + kBoardLength_m);
      const double y = random.uniform(-kBoardWidth_m / 2, kBoardWidth_m / 2);
      const double z = terrain.height_m(x, y);
      covered += z > 0 ? 1 : 0;
      levels += z != last ? 1 : 0;
      last = z;
    }
    EXPECT_GT(covered, 0.5 * kSamples) << seed;
    EXPECT_GT(levels, 0.5 * kSamples) << seed;
  }
}

TEST(World, ClutterKeepsItsPromises) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const double height = seed % 2 == 0 ? 0.05 : 0.10;
    const Terrain terrain = make_terrain(spec(Generator::kClutter, height, 0.5), seed);
    EXPECT_GE(clutter_cover(terrain), 0.5) << seed;
    EXPECT_LE(clutter_cover(terrain), 0.535) << seed;  // one box more at most
    double tallest = 0;
    for (const TerrainBox& box : terrain.boxes) {
      EXPECT_GE(box.half_length_m, 0.04);
      EXPECT_LE(box.half_length_m, 0.15);
      EXPECT_GE(box.half_width_m, 0.04);
      EXPECT_LE(box.half_width_m, 0.15);
      EXPECT_GE(box.top_m - box.bottom_m, 0.3 * height);
      EXPECT_LE(box.top_m, height);
      tallest = std::max(tallest, box.top_m);
      for (const Vector2& corner : corners(box)) {
        EXPECT_GE(corner.x(), kFieldBegin_m - 1e-9);
        EXPECT_LE(corner.x(), kFieldBegin_m + kFieldLength_m + 1e-9);
        EXPECT_LE(std::fabs(corner.y()), kLaneWidth_m / 2 + 1e-9);
      }
    }
    EXPECT_GT(tallest, 0.85 * height);
  }
}

TEST(World, ClutterHeightsAreUniform) {
  double sum = 0;
  double squares = 0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    for (const TerrainBox& box : make_terrain(spec(Generator::kClutter, 0.1, 0.4), seed).boxes) {
      sum += box.top_m - box.bottom_m;
      squares += (box.top_m - box.bottom_m) * (box.top_m - box.bottom_m);
      ++count;
    }
  }
  const double mean = sum / count;
  EXPECT_NEAR(mean, 0.065, 0.002);
  EXPECT_NEAR(std::sqrt(squares / count - mean * mean), 0.07 / std::sqrt(12.0), 0.0015);
}

TEST(World, ClutterStacksOnlyBelowItsHeight) {
  // A cover out of reach without overlap: boxes stand on boxes, tops still at most H.
  const Terrain terrain = make_terrain(spec(Generator::kClutter, 0.1, 0.6), 3);
  EXPECT_GE(clutter_cover(terrain), 0.6);
  int stacked = 0;
  for (const TerrainBox& box : terrain.boxes) {
    EXPECT_LE(box.top_m, 0.1);
    stacked += box.bottom_m > 0 ? 1 : 0;
  }
  EXPECT_GT(stacked, 0);
}

TEST(World, ImpossibleClutterIsRefused) {
  EXPECT_THROW(make_terrain(spec(Generator::kClutter, 0.0, 0.5), 1), SimulatorError);
  EXPECT_THROW(make_terrain(spec(Generator::kClutter, 0.05, 0.999), 1), SimulatorError);
}

TEST(World, StepsCrossTheLane) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Terrain terrain = make_terrain(spec(Generator::kSteps, 0.08), seed);
    EXPECT_GE(terrain.boxes.size(), 3u);
    for (const TerrainBox& box : terrain.boxes) {
      EXPECT_GE(2 * box.half_length_m, 0.25 - 1e-9);
      EXPECT_LE(2 * box.half_length_m, 0.60 + 1e-9);
      EXPECT_LE(box.top_m, 0.08);
      EXPECT_GE(box.half_width_m, kLaneWidth_m / 2);
      EXPECT_GE(box.x_m - box.half_length_m, kFieldBegin_m - 1e-9);
      EXPECT_LE(box.x_m + box.half_length_m, kFieldBegin_m + kFieldLength_m + 1e-9);
    }
  }
}

TEST(World, RampsAreContinuousAndNoSteeperThanStated) {
  double steepest_side = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Terrain terrain = make_terrain(spec(Generator::kRamps, 0, 0, 0.26), seed);
    constexpr double kStep = 0.005;
    for (double x = 0; x < 3.0; x += kStep) {
      for (double y = -0.59; y < 0.59; y += 0.07) {
        const double z = terrain.height_m(x, y);
        const double dx = (terrain.height_m(x + kStep, y) - z) / kStep;
        const double dy = (terrain.height_m(x, y + kStep) - z) / kStep;
        EXPECT_LE(std::hypot(dx, dy), std::tan(0.26) * 1.03) << x << " " << y;
        steepest_side = std::max(steepest_side, std::fabs(dy));
      }
    }
    EXPECT_EQ(terrain.height_m(0.39, 0.3), 0);
    EXPECT_NEAR(terrain.height_m(2.71, -0.3), 0, 1e-12);
  }
  EXPECT_GT(steepest_side, 0.15);
}

TEST(World, StartAndGoalAreClearInEveryWorld) {
  for (const WorldSpec& world :
       {spec(Generator::kFlat), spec(Generator::kSteps, 0.08), spec(Generator::kRamps, 0, 0, 0.26),
        spec(Generator::kClutter, 0.1, 0.5)}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const Terrain terrain = make_terrain(world, seed);
      for (double y = -0.6; y <= 0.6; y += 0.05) {
        for (double x = -0.6; x < 0.39; x += 0.05) EXPECT_EQ(terrain.height_m(x, y), 0);
        EXPECT_NEAR(terrain.height_m(kGoalX_m - 0.25, y), 0, 1e-12);
      }
    }
  }
}

TEST(World, PlatformsBeginWhereTheyShouldAndAreLargerThanTheRobot) {
  double turned = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Terrain terrain = make_terrain(spec(Generator::kPlatform, 0.13), seed);
    ASSERT_EQ(terrain.boxes.size(), 1u);
    const TerrainBox& box = terrain.boxes[0];
    EXPECT_EQ(box.top_m, 0.13);
    EXPECT_GE(2 * box.half_length_m, 1.6);
    EXPECT_GE(2 * box.half_width_m, 1.2);
    EXPECT_EQ(terrain.height_m(kEdgeX_m - 1e-6, 0), 0);
    EXPECT_EQ(terrain.height_m(kEdgeX_m + 1e-6, 0), 0.13);
    for (double x = 1.1; x < 2.5; x += 0.05) {
      for (const double y : {-0.4, 0.0, 0.4}) EXPECT_EQ(terrain.height_m(x, y), 0.13);
    }
    turned = std::max(turned, std::fabs(box.sin_yaw));
  }
  EXPECT_GT(turned, 0.03);
  EXPECT_LT(turned, 0.053);
  EXPECT_THROW(make_terrain(spec(Generator::kPlatform), 1), SimulatorError);
}

TEST(World, GapsAreAsWideAsStated) {
  for (const double length : {0.1, 0.15, 0.2, 0.35}) {
    WorldSpec world = spec(Generator::kGap);
    world.length_m = length;
    const Terrain terrain = make_terrain(world, 3);
    for (const double y : {-1.4, -0.3, 0.0, 0.7}) {
      EXPECT_EQ(terrain.height_m(kEdgeX_m - 1e-6, y), 0);
      EXPECT_NEAR(terrain.height_m(kEdgeX_m + length + 1e-6, y), 0, 1e-4);
      for (double x = 0.011; x < length - 0.01; x += 0.01) {
        EXPECT_LE(terrain.height_m(kEdgeX_m + x, y), -0.3) << x;
        EXPECT_GE(terrain.height_m(kEdgeX_m + x, y), -0.5) << x;
      }
    }
  }
  EXPECT_THROW(make_terrain(spec(Generator::kGap), 1), SimulatorError);
}

TEST(World, SeedsDiffer) {
  const Terrain a = make_terrain(spec(Generator::kClutter, 0.05, 0.5), 1);
  const Terrain b = make_terrain(spec(Generator::kClutter, 0.05, 0.5), 2);
  EXPECT_NE(a.boxes[0].x_m, b.boxes[0].x_m);
}

TEST(World, IndexKnowsTheTerrainsHeights) {
  WorldSpec gap = spec(Generator::kGap);
  gap.length_m = 0.2;
  for (const WorldSpec& world :
       {spec(Generator::kClutter, 0.1, 0.5), spec(Generator::kSteps, 0.08),
        spec(Generator::kRamps, 0, 0, 0.26), spec(Generator::kPlatform, 0.13), gap}) {
    const Terrain terrain = make_terrain(world, 6);
    const TerrainIndex index(terrain);
    Random random(1);
    for (int i = 0; i < 5000; ++i) {
      const double x = random.uniform(-1.0, 4.0);
      const double y = random.uniform(-2.0, 2.0);
      const double height = terrain.height_m(x, y);
      ASSERT_EQ(index.height_m(x, y), height) << x << " " << y;
      ASSERT_GE(index.max_height_m(x - 0.02, y - 0.02, x + 0.02, y + 0.02), height);
    }
  }
}

TEST(World, FiguresDescribeTheLane) {
  Rig flat;
  EXPECT_EQ(flat.simulator->terrain_figures().max_step_m, 0);
  EXPECT_EQ(flat.simulator->terrain_figures().rms_m, 0);
  Rig clutter(spec(Generator::kClutter, 0.05, 0.5), {}, 4);
  const TerrainFigures figures = clutter.simulator->terrain_figures();
  EXPECT_LE(figures.max_step_m, 0.05);
  EXPECT_GT(figures.max_step_m, 0.045);
  EXPECT_GT(figures.rms_m, 0.012);
  EXPECT_LT(figures.rms_m, 0.025);
  EXPECT_GE(figures.cover, 0.5);
  EXPECT_GT(figures.boxes, 30u);
}

// Clutter, obstacle, panels, platform, in this order, with level ground between them.
TEST(Gauntlet, HasItsFourPartsInOrder) {
  WorldSpec spec;
  spec.generator = Generator::kGauntlet;
  spec.height_m = 0.10;
  spec.cover = 0.5;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Terrain terrain = make_terrain(spec, seed);
    const auto highest_m = [&terrain](double x0, double x1) {
      double highest = 0;
      for (double x = x0; x <= x1; x += 0.01) {
        for (double y = -0.3; y <= 0.3; y += 0.01) {
          highest = std::max(highest, terrain.height_m(x, y));
        }
      }
      return highest;
    };
    EXPECT_EQ(highest_m(-1.0, 0.39), 0);
    EXPECT_GT(highest_m(0.4, 2.7), 0.05);
    EXPECT_LE(highest_m(0.4, 2.7), 0.10);
    EXPECT_GE(clutter_cover(terrain), 0.5);
    EXPECT_EQ(highest_m(2.71, 4.6), 0);
    ASSERT_TRUE(terrain.obstacle.has_value());
    EXPECT_NEAR(terrain.obstacle->x_m, 3.8, 0.1);
    EXPECT_TRUE(terrain.obstacle->covers(terrain.obstacle->x_m, 0));  // on the line
    EXPECT_EQ(terrain.obstacle->top_m, 0.4);
    EXPECT_GE(highest_m(4.7, 6.2), 0.06);  // four panels on one another
    EXPECT_LE(highest_m(4.7, 6.2), 0.10);
    EXPECT_EQ(highest_m(6.3, 6.95), 0);
    EXPECT_EQ(highest_m(7.05, 8.5), 0.13);
    EXPECT_EQ(terrain.height_m(8.0, 0), 0.13);
  }
}

}  // namespace
}  // namespace surefoot::sim
