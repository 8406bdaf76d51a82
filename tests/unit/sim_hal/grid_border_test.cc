// The border of a height grid is a wall down to height 0.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sim_hal/world/grid_contacts.h"
#include "sim_hal/world/terrain.h"
#include "tests/unit/sim_hal/sim_fixture.h"

namespace surefoot::sim {
namespace {

constexpr double kTop_m = 0.1;
constexpr double kRadius_m = 0.015;
constexpr double kStep_m = 0.001;

// 0.4 m x 0.3 m, its corner at (0.4, -0.1); rough at the top.
HeightGrid board(double roughness_m = 0.0) {
  HeightGrid grid;
  grid.nx = 41;
  grid.ny = 31;
  grid.x0_m = 0.4;
  grid.y0_m = -0.1;
  grid.cell_m = 0.01;
  Random random(2);
  for (std::size_t i = 0; i < grid.nx * grid.ny; ++i) {
    grid.z_m.push_back(kTop_m + random.uniform(0.0, roughness_m));
  }
  return grid;
}

// The outward normal of a side and a point on it.
struct Wall {
  Vector3 normal;
  Vector3 point;
};
std::array<Wall, 4> walls(const HeightGrid& grid) {
  const double x = 0.5 * (grid.x0_m + grid.end_x_m());
  const double y = 0.5 * (grid.y0_m + grid.end_y_m());
  return {{{Vector3(-1, 0, 0), Vector3(grid.x0_m, y, 0)},
           {Vector3(1, 0, 0), Vector3(grid.end_x_m(), y, 0)},
           {Vector3(0, -1, 0), Vector3(x, grid.y0_m, 0)},
           {Vector3(0, 1, 0), Vector3(x, grid.end_y_m(), 0)}}};
}

// From 3 cm outside inwards, a millimetre at a time, for as long as the wall is the nearest way
// out: it pushes outwards, by how far the ball is in it. Above a rough top the nearest way is at
// least half of that straight up.
void move_in(const HeightGrid& grid, const Wall& wall, double along_m, double height_m,
             double share) {
  const Vector3 along = Vector3::UnitZ().cross(wall.normal);
  std::array<GridContact, 4> found;
  double last_m = 0;
  for (double out_m = 0.0303; out_m > -share * (kTop_m - height_m); out_m -= kStep_m) {
    if (out_m < -0.05) break;
    const Vector3 centre =
        wall.point + out_m * wall.normal + along_m * along + Vector3(0, 0, height_m);
    const std::size_t count = sphere_on_grid(grid, centre, kRadius_m, found);
    ASSERT_EQ(count > 0, out_m < kRadius_m) << out_m << ' ' << height_m;
    if (count == 0) continue;
    EXPECT_NEAR(found[0].depth_m, kRadius_m - out_m, 1e-9);
    EXPECT_LE(found[0].depth_m, std::max(kRadius_m, last_m) + kStep_m + 1e-9);
    EXPECT_GT(found[0].normal.dot(wall.normal), 0.999) << out_m << ' ' << height_m;
    for (std::size_t i = 1; i < count; ++i) EXPECT_GT(found[i].normal.dot(wall.normal), -1e-9);
    last_m = found[0].depth_m;
  }
}

TEST(GridBorder, ABallMeetsAWallAtEveryHeightBelowIt) {
  for (const double roughness_m : {0.0, 0.01}) {
    const HeightGrid grid = board(roughness_m);
    for (const Wall& wall : walls(grid)) {
      for (double height_m = 0.001; height_m < kTop_m; height_m += 0.0037) {
        for (const double along_m : {-0.083, 0.0, 0.0521}) {
          move_in(grid, wall, along_m, height_m, roughness_m > 0 ? 0.5 : 1.0);
        }
      }
    }
  }
}

// Whatever is nearest, no step makes the ball deeper than it is long: the wall's upper edge, and
// from above over the border.
TEST(GridBorder, DepthNeverJumpsOnAWayAcrossTheBorder) {
  const HeightGrid grid = board();
  std::array<GridContact, 4> found;
  Random random(6);
  for (int trial = 0; trial < 300; ++trial) {
    const Wall wall = walls(grid).at(random.below(4));
    const Vector3 along = Vector3::UnitZ().cross(wall.normal);
    Vector3 way{random.normal(), random.normal(), random.normal()};
    way *= kStep_m / way.norm();
    const double along_m = random.uniform(-0.08, 0.08);
    const double height_m = random.uniform(0.03, kTop_m);
    Vector3 centre = wall.point + along_m * along + Vector3(0, 0, height_m) - 50 * way;
    double last_m = -1;
    for (int i = 0; i < 100; ++i, centre += way) {
      if (centre.z() < 0.001) break;  // the plane's side
      const std::size_t count = sphere_on_grid(grid, centre, kRadius_m, found);
      const double depth_m = count > 0 ? found[0].depth_m : 0.0;
      if (last_m >= 0) {
        ASSERT_NEAR(depth_m, last_m, kStep_m + 1e-9) << centre.transpose();
      }
      last_m = depth_m;
    }
  }
}

// A leg's capsule as Contacts takes it: balls a radius apart.
TEST(GridBorder, ACapsuleMeetsAWallWithEveryPartOfIt) {
  const HeightGrid grid = board();
  std::array<GridContact, 4> found;
  for (const Wall& wall : walls(grid)) {
    const Vector3 along = Vector3::UnitZ().cross(wall.normal);
    for (const Vector3& axis :
         {Vector3(0, 0, 1), along, Vector3((along + wall.normal).normalized()),
          Vector3((wall.normal - Vector3(0, 0, 1)).normalized())}) {
      double last_m = 0;
      for (double out_m = 0.08; out_m > -0.02; out_m -= kStep_m) {
        double deepest_m = 0;
        for (int k = -3; k <= 3; ++k) {
          const Vector3 centre =
              wall.point + out_m * wall.normal + Vector3(0, 0, 0.05) + k * kRadius_m * axis;
          const double inside_m = -(centre - wall.point).dot(wall.normal);
          if (sphere_on_grid(grid, centre, kRadius_m, found) == 0) {
            EXPECT_GE(-inside_m, kRadius_m - 1e-9);
            continue;
          }
          deepest_m = std::max(deepest_m, found[0].depth_m);
          if (centre.z() < kTop_m - std::max(0.0, inside_m) - kStep_m) {
            EXPECT_GT(found[0].normal.dot(wall.normal), 0.999);
          }
        }
        ASSERT_LE(deepest_m, std::max(kRadius_m, last_m) + kStep_m + 1e-9) << out_m;
        last_m = deepest_m;
      }
    }
  }
}

TEST(GridBorder, ABuriedBallIsPushedOutTheNearWay) {
  const HeightGrid grid = board();
  std::array<GridContact, 4> found;
  Random random(5);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vector3 centre{random.uniform(grid.x0_m, grid.end_x_m()),
                         random.uniform(grid.y0_m, grid.end_y_m()), random.uniform(0.001, kTop_m)};
    double way_m = kTop_m - centre.z();
    Vector3 normal = Vector3::UnitZ();
    for (const Wall& wall : walls(grid)) {
      const double inside_m = (wall.point - centre).dot(wall.normal);
      if (inside_m >= way_m) continue;
      way_m = inside_m;
      normal = wall.normal;
    }
    ASSERT_EQ(sphere_on_grid(grid, centre, kRadius_m, found), 1U);
    EXPECT_NEAR(found[0].depth_m, kRadius_m + way_m, 1e-9);
    EXPECT_GT(found[0].normal.dot(normal), 0.999) << centre.transpose();
  }
}

TEST(GridBorder, NothingTouchesBesideAboveOrWhereTheBorderLiesLow) {
  HeightGrid grid = board();
  std::array<GridContact, 4> found;
  for (const Wall& wall : walls(grid)) {
    const Vector3 beside = wall.point + 0.016 * wall.normal + Vector3(0, 0, 0.05);
    EXPECT_EQ(sphere_on_grid(grid, beside, kRadius_m, found), 0U);
    const Vector3 above = wall.point + 0.001 * wall.normal + Vector3(0, 0, kTop_m + 0.016);
    EXPECT_EQ(sphere_on_grid(grid, above, kRadius_m, found), 0U);
    const Vector3 on_edge = wall.point + Vector3(0, 0, kTop_m + 0.014);
    ASSERT_GE(sphere_on_grid(grid, on_edge, kRadius_m, found), 1U);
    EXPECT_NEAR(found[0].depth_m, 0.001, 1e-9);
  }
  std::fill(grid.z_m.begin(), grid.z_m.end(), 0.0);
  for (const Wall& wall : walls(grid)) {
    const Vector3 beside = wall.point + 0.005 * wall.normal + Vector3(0, 0, 0.016);
    EXPECT_EQ(sphere_on_grid(grid, beside, kRadius_m, found), 0U);
  }
}

// A limp robot lies across the near border of a board of flat stones and is pulled over it, to and
// fro: what it gains it gains from the pull.
TEST(GridBorder, ARobotThatIsPulledOverTheBorderGainsNoEnergyFromIt) {
  WorldSpec world;
  world.generator = Generator::kRocks;
  SimulatorConfig config;
  config.scenario.start.kind = StartConfig::Kind::kRandomPose;
  config.scenario.start.x_m = 0.4;
  double worst_J = 0;
  double fastest_m_s = 0;
  double nearest_m = 1;
  double farthest_m = 0;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    Rig rig(world, config, seed);
    for (int second = 0; second < 10; ++second) {
      const bool pulled = second % 2 == 0;
      const double force_N = second % 4 == 0 ? -60.0 : 60.0;
      rig.simulator->set_trunk_force({pulled ? force_N : 0.0, 0, pulled ? -20.0 : 0.0});
      double least_J = 1e9;
      for (int i = 0; i < 500; ++i) {
        rig.tick();
        const Truth truth = rig.simulator->truth();
        const Vector3 v(truth.v_WB_m_s[0], truth.v_WB_m_s[1], truth.v_WB_m_s[2]);
        fastest_m_s = std::max(fastest_m_s, v.norm());
        nearest_m = std::min(nearest_m, truth.p_WB_m[0]);
        farthest_m = std::max(farthest_m, truth.p_WB_m[0]);
        if (pulled) continue;
        worst_J = std::max(worst_J, truth.mechanical_energy_J - least_J);
        least_J = std::min(least_J, truth.mechanical_energy_J);
      }
    }
  }
  RecordProperty("worst_gain_mJ", static_cast<int>(worst_J * 1000));
  RecordProperty("fastest_mm_s", static_cast<int>(fastest_m_s * 1000));
  RecordProperty("nearest_mm", static_cast<int>(nearest_m * 1000));
  RecordProperty("farthest_mm", static_cast<int>(farthest_m * 1000));
  EXPECT_LT(worst_J, 0.1);
  EXPECT_LT(fastest_m_s, 3.0);
}

}  // namespace
}  // namespace surefoot::sim
