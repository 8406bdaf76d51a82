// From scans and windows to the published list, with the poses of their own time.
#include "core/autonomy/object_task.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/unit/objects/config.h"

namespace surefoot::autonomy {
namespace {

constexpr double kHeight_m = 0.5;  // of the scanner over the trunk's origin

robot::LidarSpecification scanner() {
  robot::LidarSpecification lidar;
  lidar.mount.position_B_m = {0.2, 0.0, kHeight_m};
  lidar.beams = 181;
  lidar.view_rad = 3.14159265;
  lidar.rate_Hz = 75.0;
  return lidar;
}

// A post of 20 cm ahead and to the left, in O, seen from a trunk at `x_m`.
hal::LidarScan scan_of_post(TimeNs stamp, double x_m, double post_x_m, double post_y_m) {
  hal::LidarScan scan;
  scan.stamp = stamp;
  scan.beam_interval = microseconds(10);
  scan.beam_count = 181;
  scan.first_angle_rad = -1.5707963f;
  scan.angle_step_rad = 0.017453292f;
  const double dx = post_x_m - x_m - 0.2;
  const double distance = std::hypot(dx, post_y_m);
  const double bearing = std::atan2(post_y_m, dx);
  for (std::size_t i = 0; i < scan.beam_count; ++i) {
    const double off = -1.5707963 + 0.017453292 * static_cast<double>(i) - bearing;
    if (std::fabs(off) < std::asin(0.1 / distance)) {
      scan.range_m[i] = static_cast<float>(distance - 0.1);
    }
  }
  return scan;
}

class ObjectTaskTest : public ::testing::Test {
 protected:
  void SetUp() override { task_->reset(objects::test::config(), scanner()); }

  // The trunk walks along x at 1 m/s, 0.3 m over level ground.
  void walk_until(int ms) {
    for (; walked_ms_ <= ms; walked_ms_ += 2) {
      estimation::RobotState state;
      state.stamp = milliseconds(walked_ms_);
      state.p_OB_m = Vector3(1e-3 * walked_ms_, 0.0, 0.3);
      history_->push(state);
    }
  }

  ObjectSight sight(const hal::LidarScan& scan) const {
    ObjectSight sight;
    sight.scan = &scan;
    sight.ground.feet_O_m = Vector3(1e-3 * walked_ms_, 0.0, 0.0);
    sight.robot_O_m = Vector2(1e-3 * walked_ms_, 0.0);
    return sight;
  }

  std::unique_ptr<ObjectTask> task_ = std::make_unique<ObjectTask>();
  std::unique_ptr<PoseHistory> history_ = std::make_unique<PoseHistory>();
  int walked_ms_ = 0;
};

TEST_F(ObjectTaskTest, PlacesAPostWhereItStandsThoughTheScanCameLate) {
  walk_until(100);
  for (int i = 0; i < 4; ++i) {
    walk_until(200 + 40 * i);
    const TimeNs seen = milliseconds(160 + 40 * i);
    const hal::LidarScan scan = scan_of_post(seen, seen.seconds(), 4.0, 1.0);
    ASSERT_TRUE(task_->release(sight(scan), *history_));
    task_->run();
    task_->publish();
  }
  EXPECT_EQ(task_->counters().scans, 4u);
  ASSERT_EQ(task_->objects().size(), 1u);
  const objects::Object& post = task_->objects()[0];
  EXPECT_EQ(post.kind, objects::ObjectClass::kObstacle);
  EXPECT_NEAR(post.centre_O_m[0], 4.0, 0.12);
  EXPECT_NEAR(post.centre_O_m[1], 1.0, 0.12);
  EXPECT_FALSE(post.moving);
}

TEST_F(ObjectTaskTest, ShowsNothingBeforeItIsPublished) {
  walk_until(100);
  const hal::LidarScan scan = scan_of_post(milliseconds(60), 0.06, 3.0, 0.0);
  ASSERT_TRUE(task_->release(sight(scan), *history_));
  task_->run();
  EXPECT_TRUE(task_->objects().empty());
  const std::uint64_t before = task_->digest();
  task_->publish();
  EXPECT_EQ(task_->objects().size(), 1u);
  EXPECT_NE(task_->digest(), before);
}

TEST_F(ObjectTaskTest, CountsAScanOfATimeItDoesNotRemember) {
  walk_until(100);
  const hal::LidarScan scan = scan_of_post(milliseconds(400), 0.4, 3.0, 0.0);
  EXPECT_FALSE(task_->release(sight(scan), *history_));
  EXPECT_EQ(task_->counters().scans_without_pose, 1u);
}

TEST_F(ObjectTaskTest, TakesAWindowOnce) {
  walk_until(100);
  auto window = std::make_unique<mapping::MapWindow>();
  window->clear();
  ObjectSight sight;
  sight.window = window.get();
  sight.window_digest = 7;
  EXPECT_TRUE(task_->release(sight, *history_));
  EXPECT_FALSE(task_->release(sight, *history_));
  sight.window_digest = 8;
  EXPECT_TRUE(task_->release(sight, *history_));
}

}  // namespace
}  // namespace surefoot::autonomy
