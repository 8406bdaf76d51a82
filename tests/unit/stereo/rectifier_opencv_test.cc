// Calibration and rectification against OpenCV.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/base/random.h"
#include "core/geometry/rotations.h"
#include "core/stereo/calibration.h"
#include "core/stereo/point_cloud.h"
#include "core/stereo/rectifier.h"

namespace surefoot::stereo {
namespace {

StereoCalibration calibration(std::uint64_t seed) {
  Random random(seed);
  StereoCalibration result;
  for (CameraModel* camera : {&result.left, &result.right}) {
    camera->width_px = 320;
    camera->height_px = 240;
    camera->fx_px = random.uniform(240, 300);
    camera->fy_px = camera->fx_px * random.uniform(0.98, 1.02);
    camera->cx_px = random.uniform(150, 170);
    camera->cy_px = random.uniform(110, 130);
    camera->distortion = {random.uniform(-0.35, -0.1), 0.1,  random.uniform(-0.002, 0.002), 0.001,
                          random.uniform(-0.02, 0.02), 0.01, random.uniform(-0.01, 0.01),   0.001};
  }
  const double roll = random.uniform(-0.03, 0.03);
  const double pitch = random.uniform(-0.03, 0.03);
  const double yaw = random.uniform(-0.03, 0.03);
  result.R_EV = geometry::from_roll_pitch_yaw(roll, pitch, yaw);
  const double y = random.uniform(-0.004, 0.004);
  result.p_EV_m = Vector3(-0.06, y, random.uniform(-0.004, 0.004));
  return result;
}

cv::Matx33d matrix(const Matrix3& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)};
}
cv::Matx33d camera_matrix(const CameraModel& camera) {
  return {camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1};
}
cv::Mat coefficients(const CameraModel& camera) {
  return cv::Mat(std::vector<double>(camera.distortion.begin(), camera.distortion.end()), true);
}

cv::Mat random_picture(std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat picture(240, 320, CV_8U);
  random.fill(picture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(picture, picture, {5, 5}, 1.2);
  return picture;
}

TEST(Calibration, ProjectsAsOpenCvDoes) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const CameraModel camera = calibration(seed).left;
    for (double x = -0.6; x <= 0.6; x += 0.1) {
      for (double y = -0.4; y <= 0.4; y += 0.1) {
        std::vector<cv::Point2d> seen;
        cv::projectPoints(std::vector<cv::Point3d>{{x, y, 1.0}}, cv::Vec3d(), cv::Vec3d(),
                          camera_matrix(camera), coefficients(camera), seen);
        const Vector2 ours = camera.project(x, y);
        ASSERT_NEAR(ours.x(), seen[0].x, 1e-9);
        ASSERT_NEAR(ours.y(), seen[0].y, 1e-9);
        const Vector2 back = camera.direction(ours.x(), ours.y());
        ASSERT_NEAR(back.x(), x, 1e-5);
        ASSERT_NEAR(back.y(), y, 1e-5);
      }
    }
  }
}

TEST(Calibration, RotationsAreThoseOfStereoRectify) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const StereoCalibration cameras = calibration(seed);
    RectifiedPair pair;
    ASSERT_TRUE(ok(rectify(cameras, 320, 240, 0, pair)));
    cv::Mat R1;
    cv::Mat R2;
    cv::Mat P1;
    cv::Mat P2;
    cv::Mat Q;
    const Vector3& t = cameras.p_EV_m;
    cv::stereoRectify(camera_matrix(cameras.left), coefficients(cameras.left),
                      camera_matrix(cameras.right), coefficients(cameras.right), {320, 240},
                      matrix(cameras.R_EV), cv::Vec3d(t.x(), t.y(), t.z()), R1, R2, P1, P2, Q);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        ASSERT_NEAR(pair.R_NV(i, j), R1.at<double>(i, j), 1e-9);
        ASSERT_NEAR(pair.R_NE(i, j), R2.at<double>(i, j), 1e-9);
      }
    }
    EXPECT_NEAR(pair.baseline_m, -P2.at<double>(0, 3) / P2.at<double>(0, 0), 1e-12);
    // The middle of the view is chosen in the same way, up to the focal length.
    EXPECT_NEAR((pair.cx_px - 159.5) / pair.focal_px,
                (P1.at<double>(0, 2) - 159.5) / P1.at<double>(0, 0), 0.02);
  }
}

TEST(Rectifier, PicturesAreThoseOfRemap) {
  auto rectifier = std::make_unique<Rectifier>();
  auto left = std::make_unique<GreyImage>();
  auto right = std::make_unique<GreyImage>();
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const StereoCalibration cameras = calibration(seed);
    RectifiedPair pair;
    ASSERT_TRUE(ok(rectify(cameras, 320, 240, 0, pair)));
    ASSERT_TRUE(ok(rectifier->configure(cameras, pair)));
    const cv::Mat pictures[2] = {random_picture(seed), random_picture(seed + 100)};
    ASSERT_TRUE(ok(
        rectifier->run({pictures[0].data, 320, 240}, {pictures[1].data, 320, 240}, *left, *right)));
    const cv::Matx33d P(pair.focal_px, 0, pair.cx_px, 0, pair.focal_px, pair.cy_px, 0, 0, 1);
    for (const bool first : {true, false}) {
      const CameraModel& camera = first ? cameras.left : cameras.right;
      cv::Mat map_u;
      cv::Mat map_v;
      cv::initUndistortRectifyMap(camera_matrix(camera), coefficients(camera),
                                  matrix(first ? pair.R_NV : pair.R_NE), P, {320, 240}, CV_32F,
                                  map_u, map_v);
      cv::Mat as_float;
      cv::Mat expected;
      pictures[first ? 0 : 1].convertTo(as_float, CV_32F);
      cv::remap(as_float, expected, map_u, map_v, cv::INTER_LINEAR);
      const GreyImage& ours = first ? *left : *right;
      int compared = 0;
      for (int v = 0; v < 240; ++v) {
        for (int u = 0; u < 320; ++u) {
          const float at_u = map_u.at<float>(v, u);
          const float at_v = map_v.at<float>(v, u);
          if (at_u < 0 || at_v < 0 || at_u > 318.9F || at_v > 238.9F) continue;
          ++compared;
          // OpenCV places to 1/32 px, here it is 1/64.
          ASSERT_NEAR(ours.pixels[static_cast<std::size_t>(v * 320 + u)], expected.at<float>(v, u),
                      4.0);
        }
      }
      EXPECT_GT(compared, 60000);
    }
  }
}

TEST(Rectifier, UndistortedCamerasAreCopied) {
  StereoCalibration cameras;
  for (CameraModel* camera : {&cameras.left, &cameras.right}) {
    *camera = {320, 240, 260, 260, 159.5, 119.5, {}};
  }
  cameras.p_EV_m = Vector3(-0.06, 0, 0);
  RectifiedPair pair;
  ASSERT_TRUE(ok(rectify(cameras, 320, 240, 0, pair)));
  EXPECT_NEAR(pair.cx_px, 159.5, 1e-9);
  EXPECT_NEAR(pair.cy_px, 119.5, 1e-9);
  EXPECT_EQ(pair.focal_px, 260);
  auto rectifier = std::make_unique<Rectifier>();
  ASSERT_TRUE(ok(rectifier->configure(cameras, pair)));
  const cv::Mat picture = random_picture(1);
  auto left = std::make_unique<GreyImage>();
  auto right = std::make_unique<GreyImage>();
  ASSERT_TRUE(
      ok(rectifier->run({picture.data, 320, 240}, {picture.data, 320, 240}, *left, *right)));
  for (int v = 1; v < 238; ++v) {
    for (int u = 1; u < 318; ++u) {
      ASSERT_EQ(left->pixels[static_cast<std::size_t>(v * 320 + u)],
                picture.at<std::uint8_t>(v, u));
    }
  }
  EXPECT_EQ(rectifier->run({picture.data, 240, 320}, {picture.data, 240, 320}, *left, *right),
            Status::kInvalid);
}

TEST(Rectifier, ClearsWhatACameraDoesNotSee) {
  const StereoCalibration cameras = calibration(3);
  RectifiedPair pair;
  ASSERT_TRUE(ok(rectify(cameras, 320, 240, 200, pair)));  // wide: the rims are empty
  auto rectifier = std::make_unique<Rectifier>();
  ASSERT_TRUE(ok(rectifier->configure(cameras, pair)));
  const cv::Mat white(240, 320, CV_8U, cv::Scalar(255));
  auto left = std::make_unique<GreyImage>();
  auto right = std::make_unique<GreyImage>();
  ASSERT_TRUE(ok(rectifier->run({white.data, 320, 240}, {white.data, 320, 240}, *left, *right)));
  auto disparities = std::make_unique<DisparityImage>();
  disparities->width_px = 320;
  disparities->height_px = 240;
  constexpr int kShift = 20;
  disparities->values.fill(kShift * kSubpixels);
  const std::uint32_t cleared = rectifier->clear_unseen(3, *disparities);
  std::uint32_t missing = 0;
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const bool kept = disparities->row(static_cast<std::size_t>(v))[u] != kNoDisparity;
      missing += kept ? 0u : 1u;
      bool seen = true;
      for (int y = v - 3; y <= v + 3; ++y) {
        for (int x = u - 3; x <= u + 3; ++x) {
          seen = seen && y >= 0 && y < 240 && x - kShift >= 0 && x < 320 &&
                 left->pixels[static_cast<std::size_t>(y * 320 + x)] > 0 &&
                 right->pixels[static_cast<std::size_t>(y * 320 + x - kShift)] > 0;
        }
      }
      ASSERT_EQ(kept, seen) << u << ", " << v;
    }
  }
  EXPECT_EQ(cleared, missing);
  EXPECT_GT(cleared, 5000u);
}

TEST(Calibration, RefusesWhatIsNoPair) {
  RectifiedPair pair;
  pair.width_px = 7;
  const auto result = [&](auto change) {
    StereoCalibration cameras = calibration(1);
    change(cameras);
    return rectify(cameras, 320, 240, 0, pair);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(result([&](StereoCalibration& c) { c.left.fx_px = nan; }), Status::kInvalid);
  EXPECT_EQ(result([&](StereoCalibration& c) { c.right.distortion[3] = nan; }), Status::kInvalid);
  EXPECT_EQ(result([&](StereoCalibration& c) { c.p_EV_m.y() = nan; }), Status::kInvalid);
  EXPECT_EQ(result([&](StereoCalibration& c) { c.R_EV(0, 0) = nan; }), Status::kInvalid);
  EXPECT_EQ(result([&](StereoCalibration& c) { c.R_EV *= 1.001; }), Status::kInvalid);
  EXPECT_EQ(result([&](StereoCalibration& c) { c.R_EV = -c.R_EV; }), Status::kInvalid);
  EXPECT_EQ(result([&](StereoCalibration& c) { c.left.width_px = 640; }), Status::kInvalid);
  EXPECT_EQ(result([&](StereoCalibration& c) { c.left.fy_px = 0; }), Status::kInvalid);
  EXPECT_EQ(result([&](StereoCalibration& c) { std::swap(c.p_EV_m.x(), c.p_EV_m.y()); }),
            Status::kOutOfRange);
  EXPECT_EQ(result([&](StereoCalibration& c) { c.p_EV_m *= 1e-3; }), Status::kOutOfRange);
  EXPECT_EQ(result([&](StereoCalibration& c) { c.p_EV_m = -c.p_EV_m; }), Status::kOutOfRange);
  EXPECT_EQ(rectify(calibration(1), 8, 240, 0, pair), Status::kInvalid);
  EXPECT_EQ(rectify(calibration(1), 320, 240, nan, pair), Status::kInvalid);
  EXPECT_EQ(pair.width_px, 7);
}

// A made-up point, seen by both distorted cameras, comes back from its rectified pixels.
TEST(Points, LieWhereTheyWereSeen) {
  Random random(9);
  auto disparities = std::make_unique<DisparityImage>();
  auto cloud = std::make_unique<PointCloud>();
  const PointConfig config{1, 0.1, 10.0, {0.1, 5.0, 0.0}};
  for (int i = 0; i < 200; ++i) {
    const StereoCalibration cameras = calibration(static_cast<std::uint64_t>(i));
    RectifiedPair pair;
    ASSERT_TRUE(ok(rectify(cameras, 320, 240, 0, pair)));
    const double x = random.uniform(-0.1, 0.1);
    const double y = random.uniform(-0.1, 0.1);
    const Vector3 p_N_m(x, y, random.uniform(0.35, 1.0));
    // In the right camera: through V and E, then turned into N again.
    const Vector3 p_V_m = pair.R_NV.transpose() * p_N_m;
    const Vector3 p_E_m = cameras.R_EV * p_V_m + cameras.p_EV_m;
    const Vector3 right_N_m = pair.R_NE * p_E_m;
    EXPECT_NEAR((right_N_m - p_N_m + Vector3(pair.baseline_m, 0, 0)).norm(), 0, 1e-12);
    const double u = pair.focal_px * p_N_m.x() / p_N_m.z() + pair.cx_px;
    const double v = pair.focal_px * p_N_m.y() / p_N_m.z() + pair.cy_px;
    const double disparity = pair.focal_px * pair.baseline_m / p_N_m.z();
    const int column = static_cast<int>(std::lround(u));
    const int row = static_cast<int>(std::lround(v));
    if (column < 0 || column >= 320 || row < 0 || row >= 240) continue;
    disparities->width_px = 320;
    disparities->height_px = 240;
    disparities->values.fill(kNoDisparity);
    const std::size_t pixel = static_cast<std::size_t>(row * 320 + column);
    disparities->values[pixel] = static_cast<std::int16_t>(std::lround(disparity * kSubpixels));
    disparities->contrasts[pixel] = 50;
    ASSERT_TRUE(ok(make_points(*disparities, pair, config, *cloud)));
    ASSERT_EQ(cloud->size(), 1u);
    const double pixel_m = p_N_m.z() / pair.focal_px;
    const double step_m = p_N_m.z() * p_N_m.z() / (pair.focal_px * pair.baseline_m);
    EXPECT_NEAR(((*cloud)[0].p_N_m - p_N_m).norm(), 0, pixel_m + step_m / kSubpixels);
    EXPECT_NEAR((*cloud)[0].variance_m2, step_m * step_m * 0.02, step_m * step_m * 0.001);
  }
}

TEST(Points, BoundsAndBadInput) {
  auto disparities = std::make_unique<DisparityImage>();
  auto cloud = std::make_unique<PointCloud>();
  RectifiedPair pair;
  pair.width_px = 640;
  pair.height_px = 480;
  pair.focal_px = 500;
  pair.baseline_m = 0.1;
  disparities->width_px = 640;
  disparities->height_px = 480;
  disparities->values.fill(50 * kSubpixels);  // 1 m
  PointConfig config{1, 0.1, 10.0, {0.1, 5.0, 0.0}};
  EXPECT_EQ(make_points(*disparities, pair, config, *cloud), Status::kExhausted);
  EXPECT_EQ(cloud->size(), kMaxPoints);
  config.stride = 2;
  EXPECT_TRUE(ok(make_points(*disparities, pair, config, *cloud)));
  EXPECT_EQ(cloud->size(), 320u * 240u);
  config.max_range_m = 0.9;
  EXPECT_TRUE(ok(make_points(*disparities, pair, config, *cloud)));
  EXPECT_EQ(cloud->size(), 0u);
  config.max_range_m = 10;
  disparities->values.fill(0);  // at infinity
  EXPECT_TRUE(ok(make_points(*disparities, pair, config, *cloud)));
  EXPECT_EQ(cloud->size(), 0u);
  disparities->values.fill(kNoDisparity);
  EXPECT_TRUE(ok(make_points(*disparities, pair, config, *cloud)));
  EXPECT_EQ(cloud->size(), 0u);
  config.stride = 0;
  EXPECT_EQ(make_points(*disparities, pair, config, *cloud), Status::kInvalid);
  config.stride = 1;
  pair.width_px = 320;
  EXPECT_EQ(make_points(*disparities, pair, config, *cloud), Status::kInvalid);
}

}  // namespace
}  // namespace surefoot::stereo
