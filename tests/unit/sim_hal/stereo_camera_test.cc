// The simulated stereo pair: its pictures, matched by core/stereo, are the ground it stands over.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include "core/stereo/matcher.h"
#include "core/stereo/rectifier.h"
#include "sim_hal/robot/articulation.h"
#include "sim_hal/sensors/sim_stereo_camera_port.h"
#include "sim_hal/world/terrain.h"
#include "tests/support/stereo_setup.h"

namespace surefoot::sim {
namespace {

constexpr double kHeight_m = 0.24;

robot::StereoCameraSpecification pair_of_cameras() {
  robot::StereoCameraSpecification camera;
  camera.present = true;
  camera.mount = {{0.1, 0.03, 0.0}, {0.0, 0.8, 0.0}};
  camera.min_range_m = 0.1;
  camera.max_range_m = 2.0;
  robot::StereoCameraCalibration& c = camera.calibration;
  c.width_px = 320;
  c.height_px = 240;
  c.left = {{210, 0, 161, 0, 210.5, 119, 0, 0, 1}, {-0.12, 0.05, 0.0006, -0.0004, 0, 0, 0, 0}};
  c.right = {{209, 0, 158, 0, 209.5, 121, 0, 0, 1}, {-0.1, 0.04, -0.0005, 0.0003, 0, 0, 0, 0}};
  const Matrix3 R_EV = rotation_z(0.004) * rotation_y(-0.006) * rotation_x(0.005);
  for (Eigen::Index i = 0; i < 9; ++i) c.R_EV[static_cast<std::size_t>(i)] = R_EV(i / 3, i % 3);
  c.p_EV_m = {-0.07, 0.0004, -0.0003};
  return camera;
}

StereoImageConfig clear_pictures() {
  StereoImageConfig config;
  config.present = true;
  config.texture = 1.0;
  return config;
}

// A pair alone over a terrain, trunk level.
struct Scene {
  explicit Scene(const StereoImageConfig& config = clear_pictures(), const FaultConfig& faults = {},
                 std::uint64_t seed = 1)
      : terrain(make_terrain({}, 1)), index(terrain) {
    camera = std::make_unique<SimStereoCameraPort>(specification, config, faults, index, seed);
  }
  hal::StereoCameraPort& port() { return *camera; }
  void shoot(TimeNs now, std::span<const Capsule> shapes = {}) {
    EXPECT_TRUE(ok(port().trigger()));
    EXPECT_TRUE(camera->triggered());
    camera->expose(now, Vector3(0, 0, kHeight_m), Matrix3::Identity(), shapes);
    camera->advance(now);
  }
  bool receive() { return ok(port().receive(*frame)); }

  robot::StereoCameraSpecification specification = pair_of_cameras();
  Terrain terrain;
  TerrainIndex index;
  std::unique_ptr<SimStereoCameraPort> camera;
  std::unique_ptr<hal::StereoFrame> frame = std::make_unique<hal::StereoFrame>();
};

struct PlaneErrors {
  double valid = 0;  // share of the pixels tried
  double mean_px = 0;
  double rms_px = 0;
  double wrong = 0;  // share of the valid off by more than 1 px
};

// Disparities of the rectified pair against those of the plane z = 0.
PlaneErrors compare_with_plane(const Scene& scene) {
  const stereo::StereoCalibration calibration =
      stereo::stereo_calibration(scene.specification.calibration);
  stereo::RectifiedPair pair;
  EXPECT_TRUE(ok(stereo::rectify(calibration, 320, 240, 0.0, pair)));
  const auto rectifier = std::make_unique<stereo::Rectifier>();
  const auto matcher = std::make_unique<stereo::Matcher>();
  const auto left = std::make_unique<stereo::GreyImage>();
  const auto right = std::make_unique<stereo::GreyImage>();
  const auto image = std::make_unique<stereo::DisparityImage>();
  stereo::MatcherConfig config = tests::recommended_matcher();
  config.disparities = 96;
  EXPECT_TRUE(ok(rectifier->configure(calibration, pair)));
  EXPECT_TRUE(ok(matcher->configure(config)));
  EXPECT_TRUE(ok(rectifier->run({scene.frame->left.data(), 320, 240},
                                {scene.frame->right.data(), 320, 240}, *left, *right)));
  EXPECT_TRUE(ok(matcher->match(left->view(), right->view(), *image)));
  rectifier->clear_unseen(3, *image);
  Matrix3 axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Matrix3 R_WN = mount_rotation(scene.specification.mount) * axes * pair.R_NV.transpose();
  PlaneErrors errors;
  double count = 0;
  double tried = 0;
  double good = 0;
  for (std::size_t v = 0; v < 240; ++v) {
    for (std::size_t u = 96; u < 320; ++u) {
      const Vector3 ray_W =
          R_WN * Vector3((static_cast<double>(u) - pair.cx_px) / pair.focal_px,
                         (static_cast<double>(v) - pair.cy_px) / pair.focal_px, 1);
      const double truth_px = pair.focal_px * pair.baseline_m * -ray_W.z() / kHeight_m;
      if (truth_px < 5) continue;
      ++tried;
      const std::int16_t value = image->row(v)[u];
      if (value == stereo::kNoDisparity) continue;
      ++count;
      const double error_px = value / 64.0 - truth_px;
      if (std::fabs(error_px) > 1) continue;
      ++good;
      errors.mean_px += error_px;
      errors.rms_px += error_px * error_px;
    }
  }
  errors.valid = count / tried;
  errors.wrong = 1 - good / count;
  errors.mean_px /= good;
  errors.rms_px = std::sqrt(errors.rms_px / good);
  return errors;
}

PlaneErrors shoot_and_compare(Scene& scene) {
  scene.shoot(milliseconds(10));
  EXPECT_TRUE(scene.receive());
  const PlaneErrors errors = compare_with_plane(scene);
  std::printf("valid %.3f, wrong %.4f, mean %.3f px, rms %.3f px\n", errors.valid, errors.wrong,
              errors.mean_px, errors.rms_px);
  return errors;
}

TEST(SimStereoCamera, ItsPicturesAreThoseOfTheGround) {
  Scene scene;
  const PlaneErrors errors = shoot_and_compare(scene);
  EXPECT_EQ(scene.frame->width_px, 320);
  EXPECT_EQ(scene.frame->height_px, 240);
  EXPECT_GT(errors.valid, 0.85);
  EXPECT_LT(errors.wrong, 0.01);
  EXPECT_LT(std::fabs(errors.mean_px), 0.05);
  EXPECT_LT(errors.rms_px, 0.15);
}

TEST(SimStereoCamera, NoiseAndExposureLeaveThemUsable) {
  StereoImageConfig config = clear_pictures();
  config.grey_noise = 2.5;
  config.right_gain = 1.06;
  config.right_offset = 3;
  Scene scene(config);
  const PlaneErrors errors = shoot_and_compare(scene);
  EXPECT_GT(errors.valid, 0.8);
  EXPECT_LT(errors.wrong, 0.02);
  EXPECT_LT(std::fabs(errors.mean_px), 0.05);
  EXPECT_LT(errors.rms_px, 0.25);
}

TEST(SimStereoCamera, GroundWithoutAPatternGivesNextToNothing) {
  StereoImageConfig config = clear_pictures();
  config.texture = 0;
  Scene scene(config);
  EXPECT_LT(shoot_and_compare(scene).valid, 0.05);
}

TEST(SimStereoCamera, SeesTheRobotsOwnLegs) {
  Scene scene;
  scene.shoot(milliseconds(10));
  ASSERT_TRUE(scene.receive());
  const auto without = std::make_unique<hal::StereoFrame>(*scene.frame);
  const std::array<Capsule, 1> leg{{{Vector3(0.3, 0.0, 0.1), Vector3(0.3, 0.0, 0.01), 0.01}}};
  scene.shoot(milliseconds(20), leg);
  ASSERT_TRUE(scene.receive());
  int changed = 0;
  for (std::size_t i = 0; i < scene.frame->pixel_count(); ++i) {
    if (scene.frame->left[i] != without->left[i]) ++changed;
  }
  EXPECT_GT(changed, 200);
  EXPECT_LT(changed, 8000);
}

TEST(SimStereoCamera, TheSameSeedGivesTheSamePictures) {
  StereoImageConfig config = clear_pictures();
  config.grey_noise = 2;
  Scene a(config);
  Scene b(config);
  Scene other(config, {}, 2);
  for (Scene* scene : {&a, &b, &other}) {
    scene->shoot(milliseconds(10));
    ASSERT_TRUE(scene->receive());
  }
  const std::size_t count = a.frame->pixel_count();
  EXPECT_EQ(std::memcmp(a.frame->left.data(), b.frame->left.data(), count), 0);
  EXPECT_EQ(std::memcmp(a.frame->right.data(), b.frame->right.data(), count), 0);
  EXPECT_NE(std::memcmp(a.frame->left.data(), other.frame->left.data(), count), 0);
}

TEST(SimStereoCamera, DeliversAfterItsLatencyAndCountsWhatAFullQueueLoses) {
  StereoImageConfig config = clear_pictures();
  config.latency_s = 0.04;
  Scene scene(config);
  scene.shoot(milliseconds(100));
  EXPECT_FALSE(scene.receive());
  scene.camera->advance(milliseconds(139));
  EXPECT_FALSE(scene.receive());
  scene.camera->advance(milliseconds(140));
  ASSERT_TRUE(scene.receive());
  EXPECT_EQ(scene.frame->stamp, milliseconds(100));
  for (int i = 0; i < 7; ++i) scene.shoot(milliseconds(200 + 10 * i));
  scene.camera->advance(milliseconds(500));
  std::vector<std::uint32_t> sequences;
  while (scene.receive()) sequences.push_back(scene.frame->sequence);
  EXPECT_EQ(sequences, (std::vector<std::uint32_t>{4, 5, 6, 7}));
  EXPECT_EQ(scene.port().counters().dropped, 3u);
  EXPECT_EQ(scene.port().counters().gaps, 0u);
  EXPECT_EQ(scene.port().counters().delivered, 5u);
}

TEST(SimStereoCamera, LostPairsShowAsGaps) {
  StereoImageConfig config = clear_pictures();
  config.dropout = 0.3;
  FaultConfig faults;
  faults.camera_off_from_s = 0.2;
  faults.camera_off_until_s = 0.25;
  Scene scene(config, faults);
  std::uint64_t received = 0;
  for (int i = 0; i < 40; ++i) {
    scene.shoot(milliseconds(10 * i + 1));
    while (scene.receive()) ++received;
  }
  const StereoImageCounters& counters = scene.camera->image_counters();
  EXPECT_EQ(counters.exposures, received);
  EXPECT_EQ(counters.exposures + counters.exposures_lost, 40u);
  EXPECT_GE(counters.exposures_lost, 10u);
  EXPECT_LE(scene.port().counters().gaps, counters.exposures_lost);
  EXPECT_GE(scene.port().counters().gaps + 5, counters.exposures_lost);
}

}  // namespace
}  // namespace surefoot::sim
