// Pictures of rocks registered with each other: what the drift of dead reckoning is found to be.
#include "core/autonomy/localisation_task.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/base/random.h"
#include "tests/support/little_dog.h"
#include "tests/support/mapping_setup.h"
#include "tests/support/rocky_board.h"

namespace surefoot::autonomy {
namespace {

constexpr std::uint16_t kWidth_px = 120;
constexpr std::uint16_t kHeight_px = 90;
constexpr double kFocal_px = 79;
constexpr double kMarch_m = 0.008;  // along the axis, then halved

LocalisationConfig config() {
  LocalisationConfig config;
  config.present = true;
  config.registration.cell_m = 0.015;
  config.drift_m = 0.003;
  config.drift_rad = 0.002;
  config.max_sigma_m = 0.01;
  config.scan_distance_m = 0.02;
  config.scans = 8;
  return config;
}

MapCamera camera() {
  robot::SensorMount mount;
  mount.position_B_m = {0.12, 0.0, 0.10};
  mount.roll_pitch_yaw_rad = {0.0, 0.8, 0.0};
  MapCamera camera;
  camera.X_BC = optical_pose(mount);
  camera.sensor.inverse_depth_sigma_per_m = 0.01;
  camera.sensor.min_range_m = 0.1;
  camera.sensor.max_range_m = 0.9;
  return camera;
}

PastPose pose_at(double x_m, double y_m, double yaw_rad, std::int64_t ms) {
  PastPose pose;
  pose.stamp = milliseconds(ms);
  pose.p_OB_m = Vector3(x_m, y_m, 0.13);
  pose.q_OB = geometry::to_quaternion(geometry::rotation_z(yaw_rad));
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    pose.joint_rad[robot::joint_index(leg, 1)] = -0.8;
    pose.joint_rad[robot::joint_index(leg, 2)] = 1.6;
  }
  return pose;
}

// What the camera sees from there, ray by ray.
std::unique_ptr<hal::DepthFrame> picture(const tests::RockyBoard& board, const PastPose& pose,
                                         Random& noise) {
  auto frame = std::make_unique<hal::DepthFrame>();
  frame->stamp = pose.stamp;
  frame->intrinsics = {kWidth_px, kHeight_px, kFocal_px, kFocal_px, 59.5, 44.5};
  frame->depth_unit_m = 0.0001f;
  const MapCamera eye = camera();
  const Matrix3 R_OB = geometry::to_matrix(pose.q_OB);
  const Vector3 from = R_OB * eye.X_BC.origin.m + pose.p_OB_m;
  for (std::size_t v = 0; v < kHeight_px; ++v) {
    for (std::size_t u = 0; u < kWidth_px; ++u) {
      const Vector3 ray_C((static_cast<double>(u) - 59.5) / kFocal_px,
                          (static_cast<double>(v) - 44.5) / kFocal_px, 1.0);
      const Vector3 ray = R_OB * (eye.X_BC.rotation.matrix * ray_C);
      const auto over_ground_m = [&](double z) {
        const Vector3 p = from + ray * z;
        return p[2] - board.height_m(p[0], p[1]);
      };
      for (double z = 0.1; z < 0.9; z += kMarch_m) {
        if (over_ground_m(z) > 0) continue;
        for (double step = 0.5 * kMarch_m; step > 1e-4; step *= 0.5) {
          z += over_ground_m(z) > 0 ? step : -step;
        }
        const double seen = 1.0 / (1.0 / z + 0.01 * noise.normal());
        frame->depth[v * kWidth_px + u] = static_cast<std::uint16_t>(std::lround(seen / 0.0001));
        break;
      }
    }
  }
  return frame;
}

struct Walk {
  explicit Walk(const tests::BoardOptions& options, const LocalisationConfig& settings = config())
      : board(5, options) {
    EXPECT_EQ(
        task->reset(settings, mapping::test::recommended_config(), robot::little_dog(), camera()),
        Status::kOk);
  }
  // A picture from `true_pose`, which dead reckoning takes for `believed`.
  void look(const PastPose& true_pose, const PastPose& believed) {
    const auto frame = picture(board, true_pose, noise);
    ASSERT_TRUE(task->release(*frame, nullptr, believed));
    task->run();
    task->publish();
  }
  void look(const PastPose& pose) { look(pose, pose); }

  tests::RockyBoard board;
  Random noise{3};
  std::unique_ptr<LocalisationTask> task = std::make_unique<LocalisationTask>();
};

tests::BoardOptions rocks() {
  tests::BoardOptions options;
  options.max_height_m = 0.05;
  options.steps = 0;
  return options;
}

PastPose drifted(PastPose pose) {
  pose.p_OB_m += Vector3(0.004, -0.003, 0.002);
  pose.q_OB =
      geometry::normalised(geometry::to_quaternion(geometry::rotation_z(0.003)) * pose.q_OB);
  return pose;
}

TEST(LocalisationTask, FindsHowFarDeadReckoningWasOff) {
  Walk walk(rocks());
  for (int i = 0; i < 4; ++i) walk.look(pose_at(0.03 * i, 0, 0, 500 * (i + 1)));
  const PastPose truth = pose_at(0.12, 0, 0, 2500);
  walk.look(truth, drifted(truth));
  const OdometryShift& shift = walk.task->shift();
  EXPECT_NEAR(shift.shift_O_m[0], -0.004, 0.001);
  EXPECT_NEAR(shift.shift_O_m[1], 0.003, 0.001);
  EXPECT_NEAR(shift.shift_O_m[2], -0.002, 0.0005);
  EXPECT_NEAR(shift.yaw_rad, -0.003, 0.0015);
  EXPECT_EQ(walk.task->observed_directions(), 6);
  const PosedPicture* const found = walk.task->take();
  ASSERT_NE(found, nullptr);
  EXPECT_LT((found->pose.p_OB_m - truth.p_OB_m).norm(), 0.0015);
  EXPECT_EQ(found->frame.stamp, truth.stamp);
  EXPECT_EQ(walk.task->take(), nullptr);
  EXPECT_EQ(walk.task->counters().first, 1u);
  EXPECT_EQ(walk.task->counters().registered, 4u);
}

TEST(LocalisationTask, AFlatFloorTellsHeightAndInventsNoWay) {
  tests::BoardOptions flat;
  flat.features = 0;
  Walk walk(flat);
  for (int i = 0; i < 4; ++i) walk.look(pose_at(0.03 * i, 0, 0, 500 * (i + 1)));
  const PastPose truth = pose_at(0.12, 0, 0, 2500);
  walk.look(truth, drifted(truth));
  const OdometryShift& shift = walk.task->shift();
  EXPECT_NEAR(shift.shift_O_m[2], -0.002, 0.0005);
  EXPECT_NEAR(shift.shift_O_m[0], 0, 0.0005);
  EXPECT_NEAR(shift.shift_O_m[1], 0, 0.0005);
  EXPECT_EQ(walk.task->observed_directions(), 3);
}

TEST(LocalisationTask, WhatDeadReckoningCannotHaveDoneIsNotBelieved) {
  Walk walk(rocks());
  for (int i = 0; i < 4; ++i) walk.look(pose_at(0.03 * i, 0, 0, 500 * (i + 1)));
  const PastPose truth = pose_at(0.12, 0, 0, 2500);
  PastPose far = truth;
  far.p_OB_m[2] += 0.02;
  walk.look(truth, far);
  EXPECT_EQ(walk.task->counters().implausible, 1u);
  EXPECT_EQ(walk.task->shift().shift_O_m, Vector3(Vector3::Zero()));
  const PosedPicture* const picture = walk.task->take();
  ASSERT_NE(picture, nullptr);
  EXPECT_EQ(picture->pose.p_OB_m, far.p_OB_m);
}

TEST(LocalisationTask, AfterForgettingThePictureIsTheFirst) {
  Walk walk(rocks());
  walk.look(pose_at(0, 0, 0, 500));
  walk.task->forget();
  const PastPose truth = pose_at(0.03, 0, 0, 1000);
  walk.look(truth, drifted(truth));
  EXPECT_EQ(walk.task->counters().first, 2u);
  EXPECT_EQ(walk.task->shift().shift_O_m, Vector3(Vector3::Zero()));
}

TEST(LocalisationTask, NoPoseNoPicture) {
  Walk walk(rocks());
  const auto frame = std::make_unique<hal::DepthFrame>();
  EXPECT_FALSE(walk.task->release(*frame, nullptr, Status::kOutOfRange));
  EXPECT_EQ(walk.task->counters().without_pose, 1u);
}

TEST(LocalisationTask, AnEmptyPictureIsThin) {
  Walk walk(rocks());
  walk.look(pose_at(0, 0, 0, 500));
  auto frame = std::make_unique<hal::DepthFrame>();
  frame->stamp = milliseconds(1000);
  frame->intrinsics = {kWidth_px, kHeight_px, kFocal_px, kFocal_px, 59.5, 44.5};
  frame->depth_unit_m = 0.0001f;
  ASSERT_TRUE(walk.task->release(*frame, nullptr, pose_at(0.03, 0, 0, 1000)));
  walk.task->run();
  walk.task->publish();
  EXPECT_EQ(walk.task->counters().thin, 1u);
}

TEST(LocalisationTask, RefusesAConfigurationOutOfItsDomain) {
  const auto task = std::make_unique<LocalisationTask>();
  LocalisationConfig none = config();
  none.scans = 0;
  EXPECT_EQ(task->reset(none, mapping::test::recommended_config(), robot::little_dog(), camera()),
            Status::kInvalid);
  EXPECT_FALSE(task->enabled());
  EXPECT_EQ(task->reset(LocalisationConfig{}, mapping::test::recommended_config(),
                        robot::little_dog(), camera()),
            Status::kOk);
  EXPECT_FALSE(task->enabled());
}

}  // namespace
}  // namespace surefoot::autonomy
