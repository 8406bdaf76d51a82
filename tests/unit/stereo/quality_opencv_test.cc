// Quality on rendered pairs against OpenCV's matchers, and the predicted noise against the real.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <opencv2/calib3d.hpp>

#include "core/stereo/matcher.h"
#include "core/stereo/point_cloud.h"
#include "tests/support/stereo_scene.h"
#include "tests/support/stereo_setup.h"

namespace surefoot::stereo {
namespace {

cv::Mat picture(const std::vector<std::uint8_t>& grey) {
  return cv::Mat(240, 320, CV_8U, const_cast<std::uint8_t*>(grey.data()));
}

TEST(Quality, AtMostTheWrongPixelsOfSgbm) {
  auto matcher = std::make_unique<Matcher>();
  auto ours = std::make_unique<DisparityImage>();
  ASSERT_TRUE(ok(matcher->configure(tests::recommended_matcher())));
  const auto sgbm = cv::StereoSGBM::create(0, 64, 5, 8 * 25, 32 * 25, 1, 63, 10, 50, 1);
  std::uint64_t seed = 0;
  for (const tests::StereoSurroundings& around : tests::kStereoSurroundings) {
    const tests::StereoScene scene = tests::render_stereo_scene(tests::options_in(around, ++seed));
    ASSERT_TRUE(ok(matcher->match(scene.left_view(), scene.right_view(), *ours)));
    cv::Mat theirs;
    sgbm->compute(picture(scene.left), picture(scene.right), theirs);
    const auto mine =
        tests::judge_disparities(ours->values.data(), kSubpixels, scene.disparity_px, 320, 64);
    const auto other =
        tests::judge_disparities(theirs.ptr<std::int16_t>(), 16, scene.disparity_px, 320, 64);
    std::printf(
        "contrast %3.0f noise %.0f gain %.2f: density %.3f wrong %.4f rms %.3f; "
        "SGBM %.3f %.4f %.3f\n",
        around.contrast, around.grey_noise, around.right_gain, mine.density, mine.wrong,
        mine.rms_px, other.density, other.wrong, other.rms_px);
    EXPECT_LE(mine.wrong, other.wrong);
    EXPECT_LE(mine.rms_px, other.rms_px);
    EXPECT_GE(mine.density, other.density - 0.08);
  }
}

// Squared errors of z over those predicted, over all points within 1 px of the truth.
TEST(Quality, PredictedNoiseIsTheRealOne) {
  auto matcher = std::make_unique<Matcher>();
  auto ours = std::make_unique<DisparityImage>();
  auto cloud = std::make_unique<PointCloud>();
  ASSERT_TRUE(ok(matcher->configure(tests::recommended_matcher())));
  std::uint64_t seed = 10;
  using tests::kStereoSurroundings;
  for (const tests::StereoSurroundings& around :
       {kStereoSurroundings[0], kStereoSurroundings[2], kStereoSurroundings[3]}) {
    const tests::StereoScene scene = tests::render_stereo_scene(tests::options_in(around, ++seed));
    ASSERT_TRUE(ok(matcher->match(scene.left_view(), scene.right_view(), *ours)));
    RectifiedPair cameras;
    cameras.width_px = 320;
    cameras.height_px = 240;
    cameras.focal_px = scene.focal_px;
    cameras.baseline_m = scene.baseline_m;
    cameras.cx_px = 159.5;
    cameras.cy_px = 119.5;
    ASSERT_TRUE(ok(make_points(*ours, cameras, tests::recommended_points(), *cloud)));
    double squares = 0;
    double count = 0;
    for (const StereoPoint& point : *cloud) {
      const std::size_t pixel = static_cast<std::size_t>(point.v_px) * 320 + point.u_px;
      const double truth_px = static_cast<double>(scene.disparity_px[pixel]);
      if (std::fabs(ours->values[pixel] / 64.0 - truth_px) > 1.0) continue;
      const double z_m = scene.focal_px * scene.baseline_m / truth_px;
      const double error_m = point.p_N_m.z() - z_m;
      squares += error_m * error_m / point.variance_m2;
      ++count;
    }
    const double ratio = std::sqrt(squares / count);
    std::printf("contrast %3.0f: real noise is %.2f of the predicted\n", around.contrast, ratio);
    EXPECT_GT(ratio, 0.8);
    EXPECT_LT(ratio, 1.2);
  }
}

}  // namespace
}  // namespace surefoot::stereo
