#include "core/objects/scan_points.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>

#include "tests/unit/objects/config.h"
#include "tests/unit/objects/scan_world.h"

namespace surefoot::objects {
namespace {

using test::pose_at;
using test::still;

class Points : public testing::Test {
 protected:
  SurfacePoints& points(const hal::LidarScan& scan, const ScanPoses& poses) {
    EXPECT_EQ(check_scan(scan, poses), Status::kOk);
    counters_ = ScanCounters{};
    scan_points(scan, poses, config_, *out_, counters_);
    return *out_;
  }
  ObjectsConfig config_ = test::config();
  ScanCounters counters_;
  Random random_{7};
  std::unique_ptr<SurfacePoints> out_ = std::make_unique<SurfacePoints>();
};

TEST_F(Points, LieOnTheWallThatWasScannedOnTheWay) {
  test::ScanWorld world;
  world.noise_m = 0;
  world.walls.push_back({{6, -20}, {6, 20}, 5});
  world.ground.present = false;
  const ScannerPose first = pose_at(0, 0, 0.9, 0.02, 0.1);
  const ScannerPose last = moved(first, {1.0, 0.3, 0.1}, {0.2, -0.5, 1.0}, 0.013);
  const hal::LidarScan scan = world.scan({first, last}, TimeNs{}, random_);
  for (const SurfacePoint& point : points(scan, {first, last})) {
    ASSERT_NEAR(point.p_O_m[0], 6.0, 2e-3) << point.beam;
  }
  // Without deskewing the same returns are off by more than the noise of a scanner.
  double worst = 0;
  for (const SurfacePoint& point : points(scan, still(first))) {
    worst = std::max(worst, std::abs(point.p_O_m[0] - 6.0));
  }
  EXPECT_GT(worst, 0.05);
}

TEST_F(Points, EveryBeamThatGivesNoneIsCounted) {
  hal::LidarScan scan;
  scan.beam_count = 7;
  scan.angle_step_rad = 0.01F;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  scan.range_m = {nan, inf, -1.0F, 0.0F, 0.1F, 31.0F, 5.0F};
  EXPECT_EQ(points(scan, {}).size(), 1u);
  EXPECT_EQ(counters_.not_finite, 3u);
  EXPECT_EQ(counters_.no_return, 1u);
  EXPECT_EQ(counters_.too_near, 1u);
  EXPECT_EQ(counters_.too_far, 1u);
}

TEST_F(Points, VeilsAreDroppedAndGrazingWallsAreNot) {
  hal::LidarScan scan;
  scan.beam_count = 6;
  scan.angle_step_rad = 0.01F;
  scan.range_m = {3.0F, 3.01F, 5.0F, 8.0F, 8.0F, 8.0F};
  EXPECT_EQ(points(scan, {}).size(), 5u);
  EXPECT_EQ(counters_.veil, 1u);
  test::ScanWorld world;
  world.walls.push_back({{0, 1}, {40, 1}, 5});
  world.ground.present = false;
  const ScannerPose pose = pose_at(0, 0, 0.9);
  const std::size_t count = points(world.scan(still(pose), TimeNs{}, random_), still(pose)).size();
  EXPECT_GT(count, 150u);
  EXPECT_EQ(counters_.veil, 0u);
}

TEST_F(Points, ScansThatCannotBeAreRefused) {
  hal::LidarScan scan;
  EXPECT_EQ(check_scan(scan, {}), Status::kInvalid);
  scan.beam_count = 10;
  EXPECT_EQ(check_scan(scan, {}), Status::kInvalid);
  scan.angle_step_rad = 0.01F;
  EXPECT_EQ(check_scan(scan, {}), Status::kOk);
  scan.beam_count = hal::kMaxLidarBeams + 1;
  EXPECT_EQ(check_scan(scan, {}), Status::kInvalid);
  scan.beam_count = 10;
  ScanPoses poses;
  poses.last.p_OL_m[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(check_scan(scan, poses), Status::kInvalid);
  poses = {};
  poses.first.R_OL(0, 0) = 2;
  EXPECT_EQ(check_scan(scan, poses), Status::kInvalid);
  scan.first_angle_rad = std::numeric_limits<float>::infinity();
  EXPECT_EQ(check_scan(scan, {}), Status::kInvalid);
}

}  // namespace
}  // namespace surefoot::objects
