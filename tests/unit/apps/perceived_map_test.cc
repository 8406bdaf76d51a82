// How far a measured cell is from the true surface.
#include "apps/common/perceived_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/random.h"

namespace surefoot::apps {
namespace {

TEST(DistanceToSurface, AboveFlatGroundItIsTheHeight) {
  const TrueGround flat = [](double, double) { return 0.02; };
  EXPECT_NEAR(distance_to_surface_m(flat, 0.3, -0.2, 0.05), 0.03, 1e-12);
  EXPECT_NEAR(distance_to_surface_m(flat, 0.3, -0.2, 0.0), 0.02, 1e-12);
  EXPECT_EQ(distance_to_surface_m(flat, 0.3, -0.2, 0.02), 0.0);
}

// Half way up the side of a block: what counts is how far away that side is.
TEST(DistanceToSurface, BesideAWallItIsTheWayToTheWall) {
  const TrueGround block = [](double x, double) { return x < 0.1 ? 0.0 : 0.06; };
  for (const double away_m : {0.002, 0.005, 0.012}) {
    EXPECT_NEAR(distance_to_surface_m(block, 0.1 - away_m, 0.0, 0.03), away_m, 0.0011);
    EXPECT_NEAR(distance_to_surface_m(block, 0.1 + away_m, 0.0, 0.03), away_m, 0.0011);
  }
  // Above the block's edge the edge is nearest, and a high wall far away is not.
  EXPECT_NEAR(distance_to_surface_m(block, 0.09, 0.0, 0.07), std::hypot(0.01, 0.01), 0.0011);
  EXPECT_NEAR(distance_to_surface_m(block, 0.0, 0.0, 0.03), 0.03, 1e-12);
}

// Within a tree's foot, and far beside a tree: to some per cent, without a sample per millimetre.
TEST(DistanceToSurface, OfWhatIsFarAwayCostsLittle) {
  int samples = 0;
  const TrueGround tree = [&](double x, double y) {
    ++samples;
    return std::hypot(x, y) < 0.2 ? 10.0 : 0.0;
  };
  EXPECT_NEAR(distance_to_surface_m(tree, 0.0, 0.0, 0.05), 0.2, 0.008);
  EXPECT_NEAR(distance_to_surface_m(tree, 0.7, 0.0, 2.0), 0.5, 0.02);
  EXPECT_LT(samples, 150'000);
}

// Blocks at random: against every sample of a square that is large enough. A wall lies between
// samples, so two grids of 1 mm may differ by as much.
TEST(DistanceToSurface, IsWhatLookingAtAllOfItFinds) {
  Random random(11);
  for (int round = 0; round < 20; ++round) {
    struct Block {
      double x_m, y_m, side_m, height_m;
    };
    std::array<Block, 12> blocks{};
    for (Block& block : blocks) {
      block = {random.uniform(-0.06, 0.06), random.uniform(-0.06, 0.06), random.uniform(0.01, 0.04),
               random.uniform(0.0, 0.04)};
    }
    const TrueGround ground = [&](double x, double y) {
      double height_m = 0;
      for (const Block& b : blocks) {
        const bool over = x >= b.x_m && x < b.x_m + b.side_m && y >= b.y_m && y < b.y_m + b.side_m;
        if (over) height_m = std::max(height_m, b.height_m);
      }
      return height_m;
    };
    const double x_m = random.uniform(-0.01, 0.01);
    const double y_m = random.uniform(-0.01, 0.01);
    const double z_m = random.uniform(0.0, 0.03);
    // Every millimetre a point of the ground and, down to the lowest of its neighbours, its side.
    double nearest_m = std::numeric_limits<double>::max();
    constexpr double kStep_m = 0.0005;
    for (int i = -90; i <= 90; ++i) {
      for (int j = -90; j <= 90; ++j) {
        const double x = x_m + i * kStep_m;
        const double y = y_m + j * kStep_m;
        const double top_m = ground(x, y);
        const double foot_m = std::min({ground(x + kStep_m, y), ground(x - kStep_m, y),
                                        ground(x, y + kStep_m), ground(x, y - kStep_m), top_m});
        const double off_m = z_m > top_m ? z_m - top_m : std::max(0.0, foot_m - z_m);
        nearest_m = std::min(nearest_m, std::hypot(x - x_m, y - y_m, off_m));
      }
    }
    const double found_m = distance_to_surface_m(ground, x_m, y_m, z_m);
    EXPECT_NEAR(found_m, nearest_m, 0.0015) << "round " << round;
    EXPECT_LE(found_m, std::fabs(z_m - ground(x_m, y_m)));
  }
}

}  // namespace
}  // namespace surefoot::apps
