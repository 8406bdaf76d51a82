#include "apps/surefoot-lab/bench_stereo.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <string>
#include <vector>

#include "apps/common/statistics.h"
#include "apps/surefoot-lab/stopwatch.h"
#include "core/stereo/matcher.h"
#include "core/stereo/point_cloud.h"
#include "core/stereo/rectifier.h"
#include "tests/support/stereo_scene.h"
#include "tests/support/stereo_setup.h"

namespace surefoot::apps {
namespace {

constexpr int kRounds = 15;
constexpr int kDisparities = 64;
constexpr double kMaxWrongRatio = 1.3;

cv::Mat picture(const stereo::GreyView& view) {
  return cv::Mat(view.height_px, view.width_px, CV_8U, const_cast<std::uint8_t*>(view.pixels));
}

// One way of matching: its times, and its quality over all scenes.
struct Contender {
  std::string name;
  std::vector<double> times_us;
  double density = 0;
  double wrong = 0;
  double rms_px = 0;

  void judge(const std::int16_t* values, double scale, const tests::StereoScene& scene) {
    const tests::DisparityQuality quality =
        tests::judge_disparities(values, scale, scene.disparity_px, scene.width_px, kDisparities);
    constexpr double kShare = 1.0 / std::size(tests::kStereoSurroundings);
    density += kShare * quality.density;
    wrong += kShare * quality.wrong;
    rms_px += kShare * quality.rms_px;
  }
  void print(double reference_ms) const {
    const double ms = 1e-3 * median(times_us);
    std::fputs(fmt::format("  {:<22} {:>7.2f} {:>8.2f} {:>9.1f} {:>9.2f} {:>9.3f}\n", name, ms,
                           ms / reference_ms, 100 * density, 100 * wrong, rms_px)
                   .c_str(),
               stdout);
  }
};

// Rectification of a pair and points of a result, beside which OpenCV has no counterpart in fixed
// memory.
void bench_rest(const stereo::DisparityImage& disparities, const tests::StereoScene& scene) {
  stereo::StereoCalibration cameras;
  for (stereo::CameraModel* camera : {&cameras.left, &cameras.right}) {
    *camera = {320, 240, 260, 260, 159.5, 119.5, {-0.2, 0.05, 0.001, 0.001, 0, 0, 0, 0}};
  }
  cameras.p_EV_m = Vector3(-0.06, 0.001, 0.001);
  stereo::RectifiedPair pair;
  auto rectifier = std::make_unique<stereo::Rectifier>();
  auto left = std::make_unique<stereo::GreyImage>();
  auto right = std::make_unique<stereo::GreyImage>();
  auto cloud = std::make_unique<stereo::PointCloud>();
  if (!ok(stereo::rectify(cameras, 320, 240, 0, pair)) ||
      !ok(rectifier->configure(cameras, pair))) {
    return;
  }
  std::vector<double> rectify_us;
  std::vector<double> points_us;
  for (int i = 0; i < kRounds; ++i) {
    rectify_us.push_back(time_us(
        [&] { (void)rectifier->run(scene.left_view(), scene.right_view(), *left, *right); }));
    points_us.push_back(time_us([&] {
      (void)stereo::make_points(disparities, pair, tests::recommended_points(), *cloud);
    }));
  }
  std::fputs(fmt::format("  rectifying both pictures {:.2f} ms, {} points {:.2f} ms\n",
                         1e-3 * median(rectify_us), cloud->size(), 1e-3 * median(points_us))
                 .c_str(),
             stdout);
}

}  // namespace

int bench_stereo() {
  cv::setNumThreads(1);
  const auto matcher = std::make_unique<stereo::Matcher>();
  const auto disparities = std::make_unique<stereo::DisparityImage>();
  if (!ok(matcher->configure(tests::recommended_matcher()))) return 3;
  const auto bm = cv::StereoBM::create(kDisparities, 15);
  bm->setDisp12MaxDiff(1);
  const auto sgbm = cv::StereoSGBM::create(0, kDisparities, 5, 8 * 25, 32 * 25, 1, 63, 10, 50, 1);
  Contender block;
  block.name = "OpenCV StereoBM";
  Contender semi_global;
  semi_global.name = "OpenCV StereoSGBM";
  Contender ours;
  ours.name = "core/stereo";
  tests::StereoScene scene;
  std::uint64_t seed = 0;
  for (const tests::StereoSurroundings& around : tests::kStereoSurroundings) {
    scene = tests::render_stereo_scene(tests::options_in(around, ++seed));
    const cv::Mat left = picture(scene.left_view());
    const cv::Mat right = picture(scene.right_view());
    cv::Mat found_bm;
    cv::Mat found_sgbm;
    for (int i = 0; i < kRounds; ++i) {
      block.times_us.push_back(time_us([&] { bm->compute(left, right, found_bm); }));
      semi_global.times_us.push_back(time_us([&] { sgbm->compute(left, right, found_sgbm); }));
      ours.times_us.push_back(time_us(
          [&] { (void)matcher->match(scene.left_view(), scene.right_view(), *disparities); }));
    }
    block.judge(found_bm.ptr<std::int16_t>(), 16, scene);
    semi_global.judge(found_sgbm.ptr<std::int16_t>(), 16, scene);
    ours.judge(disparities->values.data(), stereo::kSubpixels, scene);
  }
  std::fputs(
      "stereo: 320 x 240 pixels, 64 disparities, five rendered pairs, one thread\n"
      "                         ms    of BM   valid %   wrong %    rms px\n",
      stdout);
  const double reference_ms = 1e-3 * median(block.times_us);
  for (const Contender* contender : {&block, &semi_global, &ours}) contender->print(reference_ms);
  bench_rest(*disparities, scene);
  return ours.wrong <= kMaxWrongRatio * semi_global.wrong ? 0 : 3;
}

}  // namespace surefoot::apps
