// Rendered walks with known motion: how far the chained motions end from the truth, and whether
// their covariances say so.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "tests/support/samples.h"
#include "tests/unit/visual_odometry/walk.h"

namespace surefoot::tests {
namespace {

constexpr std::uint64_t kSeeds = samples(3, 1);

// Over several seeds: the worst and the mean.
struct Spread {
  double worst_drift = 0;  // end error over way
  double mean_drift = 0;
  double worst_turn_rad = 0;
  double mean_nees = 0;
  double mean_inliers = 0;
  int failed = 0;
};

Spread walk_seeds(const char* name, WalkOptions options) {
  Spread spread;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    options.seed = seed;
    const WalkResult result = walk(options);
    const double drift = result.end_error_m / std::max(result.way_m, 1e-9);
    spread.worst_drift = std::max(spread.worst_drift, drift);
    spread.mean_drift += drift / kSeeds;
    spread.worst_turn_rad = std::max(spread.worst_turn_rad, result.turn_error_rad);
    spread.mean_nees += result.mean_nees / kSeeds;
    spread.mean_inliers += result.mean_inliers / kSeeds;
    spread.failed += result.failed;
  }
  std::printf(
      "%-12s drift mean %.3f %% worst %.3f %%, turn worst %.2f mrad, NEES %.2f of 6, "
      "inliers %.0f, failed %d\n",
      name, 100 * spread.mean_drift, 100 * spread.worst_drift, 1e3 * spread.worst_turn_rad,
      spread.mean_nees, spread.mean_inliers, spread.failed);
  return spread;
}

TEST(WalkingVisualOdometry, FollowsAWalk) {
  const Spread spread = walk_seeds("pairs", WalkOptions{});
  EXPECT_LT(spread.worst_drift, 0.004);
  EXPECT_LT(spread.worst_turn_rad, 0.002);
  EXPECT_GT(spread.mean_nees, 3);
  EXPECT_LT(spread.mean_nees, 9);
  EXPECT_EQ(spread.failed, 0);
}

TEST(WalkingVisualOdometry, FollowsAWalkWithDisparitiesOfOthers) {
  WalkOptions options;
  options.use_disparities = true;
  const Spread spread = walk_seeds("disparities", options);
  EXPECT_LT(spread.worst_drift, 0.004);
  EXPECT_LT(spread.mean_nees, 9);
  EXPECT_EQ(spread.failed, 0);
}

TEST(WalkingVisualOdometry, ExposureMayChange) {
  WalkOptions options;
  options.changing_exposure = true;
  options.contrast = 110;  // nothing saturates
  const Spread spread = walk_seeds("exposure", options);
  EXPECT_LT(spread.worst_drift, 0.006);
  EXPECT_EQ(spread.failed, 0);
}

TEST(WalkingVisualOdometry, FaintTextureWithNoise) {
  WalkOptions options;
  options.contrast = 60;
  options.grey_noise = 3;
  const Spread spread = walk_seeds("faint", options);
  EXPECT_LT(spread.worst_drift, 0.012);
  EXPECT_LT(spread.mean_nees, 12);
  EXPECT_EQ(spread.failed, 0);
}

TEST(WalkingVisualOdometry, AnObjectMovesThroughThePicture) {
  WalkOptions options;
  options.object_m_s = 0.3;
  options.with_legs = true;
  const Spread spread = walk_seeds("object", options);
  EXPECT_LT(spread.worst_drift, 0.008);
  EXPECT_EQ(spread.failed, 0);
}

TEST(WalkingVisualOdometry, TurnsOnTheSpot) {
  WalkOptions options;
  options.speed_m_s = 0;
  options.turn_rad_s = 0.6;
  const Spread spread = walk_seeds("turning", options);
  EXPECT_LT(spread.worst_turn_rad, 0.006);
  EXPECT_EQ(spread.failed, 0);
}

TEST(WalkingVisualOdometry, WalksFast) {
  WalkOptions options;
  options.speed_m_s = 1.2;
  options.with_legs = true;
  options.pictures = 24;
  const Spread spread = walk_seeds("fast", options);
  EXPECT_LT(spread.worst_drift, 0.006);
  EXPECT_EQ(spread.failed, 0);
}

TEST(WalkingVisualOdometry, DoesNotDriftAtStandstill) {
  WalkOptions options;
  options.speed_m_s = 0;
  options.turn_rad_s = 0;
  double worst_m = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    options.seed = seed;
    const WalkResult result = walk(options);
    EXPECT_EQ(result.keyframes, 1) << "the first one stays";
    worst_m = std::max(worst_m, result.end_error_m);
  }
  std::printf("standstill: worst %.5f m\n", worst_m);
  EXPECT_LT(worst_m, 2e-4);
}

}  // namespace
}  // namespace surefoot::tests
