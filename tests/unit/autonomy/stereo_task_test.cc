// When a pair is taken, and what becomes of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "core/autonomy/stereo_task.h"
#include "core/base/random.h"
#include "tests/support/stereo_setup.h"

namespace surefoot::autonomy {
namespace {

constexpr double kTick_s = 0.002;
constexpr std::uint16_t kWidth_px = 160;
constexpr std::uint16_t kHeight_px = 120;
constexpr int kDisparity_px = 20;

robot::StereoCameraSpecification camera() {
  robot::StereoCameraSpecification camera;
  camera.present = true;
  camera.min_range_m = 0.1;
  camera.max_range_m = 1.0;
  camera.calibration.width_px = kWidth_px;
  camera.calibration.height_px = kHeight_px;
  camera.calibration.left.matrix = {100, 0, 79.5, 0, 100, 59.5, 0, 0, 1};
  camera.calibration.right = camera.calibration.left;
  camera.calibration.R_EV = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  camera.calibration.p_EV_m = {-0.06, 0, 0};
  return camera;
}

StereoConfig config() {
  StereoConfig config;
  config.present = true;
  config.period_s = 0.5;
  config.least_interval_s = 0.2;
  config.steady_rate_rad_s = 0.1;
  config.steady_speed_m_s = 0.02;
  config.matcher = tests::recommended_matcher();
  config.matcher.disparities = 48;
  config.least_valid_share = 0.2;
  config.rim_step_px = 1.5;
  config.noise = tests::recommended_noise();
  return config;
}

// Random texture on a plane across the view, kDisparity_px apart.
std::unique_ptr<hal::StereoFrame> textured_pair() {
  auto pair = std::make_unique<hal::StereoFrame>();
  pair->stamp = milliseconds(40);
  pair->width_px = kWidth_px;
  pair->height_px = kHeight_px;
  Random random(1);
  for (std::size_t i = 0; i < pair->pixel_count(); ++i) {
    pair->left[i] = static_cast<std::uint8_t>(random.below(256));
    pair->right[i] = static_cast<std::uint8_t>(random.below(256));
    if (i >= kDisparity_px) pair->right[i - kDisparity_px] = pair->left[i];
  }
  return pair;
}

TEST(StereoTrigger, WaitsUntilTheTrunkIsSteady) {
  StereoTrigger trigger;
  trigger.reset(config());
  EXPECT_FALSE(trigger.update({}, kTick_s));  // lies
  EXPECT_FALSE(trigger.update({true, false, 0.2, 0.0}, kTick_s));
  EXPECT_FALSE(trigger.update({true, false, 0.0, 0.03}, kTick_s));
  EXPECT_TRUE(trigger.update({true, false, 0.05, 0.01}, kTick_s));
  EXPECT_FALSE(trigger.update({true, false, 0.05, 0.01}, kTick_s));
}

TEST(StereoTrigger, EveryPeriodAndAfterAShift) {
  StereoTrigger trigger;
  trigger.reset(config());
  ASSERT_TRUE(trigger.update({true, false, 0, 0}, kTick_s));
  int ticks = 1;
  while (!trigger.update({true, false, 0, 0}, kTick_s)) ++ticks;
  EXPECT_NEAR(ticks * kTick_s, 0.5, 0.003);
  ticks = 1;
  // A shift that ends too early after the last pair is not forgotten.
  while (!trigger.update({true, ticks == 50, 0, 0}, kTick_s)) ++ticks;
  EXPECT_NEAR(ticks * kTick_s, 0.2, 0.003);
}

TEST(StereoTask, WithoutACameraItDoesNothing) {
  const auto task = std::make_unique<StereoTask>();
  EXPECT_EQ(task->reset({}, {}, {}, true), Status::kOk);
  EXPECT_FALSE(task->enabled());
  EXPECT_FALSE(task->release(*textured_pair(), {}));
}

TEST(StereoTask, RefusesWhatCannotBeMatched) {
  const auto task = std::make_unique<StereoTask>();
  robot::StereoCameraSpecification broken = camera();
  broken.calibration.p_EV_m = {};
  EXPECT_EQ(task->reset(broken, config(), {}, true), Status::kOutOfRange);
  broken = camera();
  broken.calibration.width_px = 1024;
  EXPECT_EQ(task->reset(broken, config(), {}, true), Status::kExhausted);
  StereoConfig wrong = config();
  wrong.matcher.disparities = 40;
  EXPECT_EQ(task->reset(camera(), wrong, {}, true), Status::kInvalid);
}

TEST(StereoTask, APairBecomesAPictureOfDepthOnce) {
  const auto task = std::make_unique<StereoTask>();
  ASSERT_EQ(task->reset(camera(), config(), {}, true), Status::kOk);
  EXPECT_EQ(task->take(), nullptr);
  ASSERT_TRUE(task->release(*textured_pair(), {}));
  task->run();
  EXPECT_EQ(task->take(), nullptr);
  task->publish();
  const StereoPicture* const picture = task->take();
  ASSERT_NE(picture, nullptr);
  EXPECT_EQ(task->take(), nullptr);
  EXPECT_EQ(picture->depth.stamp, milliseconds(40));
  EXPECT_EQ(picture->depth.intrinsics.width_px, kWidth_px);
  // The left border of the left picture is not in the right one.
  const std::size_t middle = kHeight_px / 2 * kWidth_px;
  EXPECT_EQ(picture->depth.depth[middle + 5], 0);
  const double unit_m = static_cast<double>(picture->depth.depth_unit_m);
  EXPECT_NEAR(picture->depth.depth[middle + 80] * unit_m, 100 * 0.06 / kDisparity_px, 0.002);
  EXPECT_NEAR(picture->depth.depth[middle + 30] * unit_m, 100 * 0.06 / kDisparity_px, 0.002);
  EXPECT_GE(picture->noise.factors[middle + 80], mapping::DepthNoise::kUnit);
  EXPECT_LE(picture->noise.factors[middle + 80], 2 * mapping::DepthNoise::kUnit);
  EXPECT_GT(task->valid_share(), 0.7);
  EXPECT_EQ(task->counters().pairs_matched, 1u);
}

// A square nearer than the plane behind it: the matcher makes it wider than it is.
std::unique_ptr<hal::StereoFrame> pair_with_square(std::size_t from, std::size_t to) {
  constexpr std::size_t kNearer_px = 30;
  auto pair = std::make_unique<hal::StereoFrame>();
  pair->stamp = milliseconds(40);
  pair->width_px = kWidth_px;
  pair->height_px = kHeight_px;
  Random random(2);
  // Blurred dots: one tells little of its own pixel alone.
  std::vector<double> dots(pair->pixel_count());
  for (double& dot : dots) dot = random.uniform(0.0, 256.0);
  for (std::size_t i = 0; i < dots.size(); ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < 16; ++k) {
      sum += dots[(i + k / 4 * kWidth_px + k % 4) % dots.size()];
    }
    pair->left[i] = static_cast<std::uint8_t>(std::clamp(128 + 3 * (sum / 16 - 128), 0.0, 255.0));
    pair->right[i] = 128;
  }
  // What is nearer is drawn last: it hides what is behind it.
  for (const bool square : {false, true}) {
    const std::size_t disparity = square ? kNearer_px : kDisparity_px;
    for (std::size_t i = disparity; i < pair->pixel_count(); ++i) {
      const std::size_t u = i % kWidth_px;
      const std::size_t v = i / kWidth_px;
      const bool inside = v >= from && v < to && u >= from && u < to;
      if (inside == square && u >= disparity) pair->right[i - disparity] = pair->left[i];
    }
  }
  return pair;
}

// Pixels that were given the square's depth although they lie beside it.
int fattened(std::uint8_t rim_px) {
  constexpr std::size_t kFrom = 40;
  constexpr std::size_t kTo = 80;
  StereoConfig settings = config();
  settings.rim_px = rim_px;
  const auto task = std::make_unique<StereoTask>();
  EXPECT_EQ(task->reset(camera(), settings, {}, true), Status::kOk);
  EXPECT_TRUE(task->release(*pair_with_square(kFrom, kTo), {}));
  task->run();
  task->publish();
  const StereoPicture* const picture = task->take();
  EXPECT_NE(picture, nullptr);
  if (picture == nullptr) return -1;
  const auto nearer = [&](std::size_t u, std::size_t v) {
    const double z_m = static_cast<double>(picture->depth.depth[v * kWidth_px + u]) *
                       static_cast<double>(picture->depth.depth_unit_m);
    return z_m > 0 && z_m < 100 * 0.06 / 25;
  };
  EXPECT_TRUE(nearer(60, 60));
  int beside = 0;
  for (std::size_t v = 20; v < 100; ++v) {
    for (std::size_t u = 35; u < 100; ++u) {
      const bool square = v >= kFrom && v < kTo && u >= kFrom && u < kTo;
      if (!square && nearer(u, v)) ++beside;
    }
  }
  return beside;
}

TEST(StereoTask, TheRimOfWhatStandsInFrontIsLeftOut) {
  const int with_rim = fattened(0);
  EXPECT_GT(with_rim, 10);
  EXPECT_LT(fattened(4), with_rim / 4);
}

TEST(StereoTask, ABlindPairMapsNothingAndIsCounted) {
  const auto task = std::make_unique<StereoTask>();
  ASSERT_EQ(task->reset(camera(), config(), {}, true), Status::kOk);
  auto pair = std::make_unique<hal::StereoFrame>();
  pair->width_px = kWidth_px;
  pair->height_px = kHeight_px;
  pair->left.fill(120);
  pair->right.fill(120);
  ASSERT_TRUE(task->release(*pair, {}));
  task->run();
  task->publish();
  EXPECT_EQ(task->take(), nullptr);
  EXPECT_EQ(task->counters().pairs_unusable, 1u);
  pair->width_px = 100;
  EXPECT_FALSE(task->release(*pair, {}));
  EXPECT_EQ(task->counters().pairs_refused, 1u);
}

}  // namespace
}  // namespace surefoot::autonomy
