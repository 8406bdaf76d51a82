// Workload of core/stereo: distorted pictures of random texture at random disparities, rectified,
// matched and turned into points.
#include <memory>

#include "core/base/random.h"
#include "core/geometry/rotations.h"
#include "core/stereo/matcher.h"
#include "core/stereo/point_cloud.h"
#include "core/stereo/rectifier.h"
#include "tests/rules/core_hash/workloads.h"
#include "tests/support/stereo_setup.h"

namespace surefoot::tests {
namespace {

constexpr std::uint16_t kWidth_px = 150;  // no multiple of the vectors' lengths
constexpr std::uint16_t kHeight_px = 70;

stereo::StereoCalibration cameras() {
  stereo::StereoCalibration calibration;
  for (stereo::CameraModel* camera : {&calibration.left, &calibration.right}) {
    camera->width_px = kWidth_px;
    camera->height_px = kHeight_px;
    camera->fx_px = 120.0;
    camera->fy_px = 121.0;
    camera->cx_px = 76.0;
    camera->cy_px = 33.5;
    camera->distortion = {-0.2, 0.06, 0.001, -0.002, 0.01, 0.02, 0.003, 0.001};
  }
  calibration.right.fx_px = 119.0;
  calibration.R_EV = geometry::from_roll_pitch_yaw(0.01, -0.02, 0.015);
  calibration.p_EV_m = Vector3(-0.07, 0.002, -0.003);
  return calibration;
}

// Bands of one disparity each; a fifth of the right picture is unrelated.
void draw(Random& random, stereo::GreyImage& left, stereo::GreyImage& right) {
  for (stereo::GreyImage* image : {&left, &right}) {
    image->width_px = kWidth_px;
    image->height_px = kHeight_px;
    for (std::size_t i = 0; i < image->view().pixel_count(); ++i) {
      image->pixels[i] = static_cast<std::uint8_t>(random.below(256));
    }
  }
  for (std::size_t v = 0; v < kHeight_px; ++v) {
    if (v % 10 < 2) continue;
    const std::size_t shift = 4 + v / 10 * 3;
    for (std::size_t u = 0; u + shift < kWidth_px; ++u) {
      right.pixels[v * kWidth_px + u] = left.pixels[v * kWidth_px + u + shift];
    }
  }
}

}  // namespace

void hash_stereo(Fnv64& hash) {
  const auto left = std::make_unique<stereo::GreyImage>();
  const auto right = std::make_unique<stereo::GreyImage>();
  const auto flat_left = std::make_unique<stereo::GreyImage>();
  const auto flat_right = std::make_unique<stereo::GreyImage>();
  const auto rectifier = std::make_unique<stereo::Rectifier>();
  const auto matcher = std::make_unique<stereo::Matcher>();
  const auto disparities = std::make_unique<stereo::DisparityImage>();
  const auto cloud = std::make_unique<stereo::PointCloud>();
  stereo::MatcherConfig config = recommended_matcher();
  config.disparities = 48;
  stereo::RectifiedPair pair;
  hash.word(
      static_cast<std::uint64_t>(stereo::rectify(cameras(), kWidth_px, kHeight_px, 0.0, pair)), 1);
  mix(hash, pair.R_NV);
  mix(hash, pair.R_NE);
  hash.word(static_cast<std::uint64_t>(rectifier->configure(cameras(), pair)), 1);
  Random random(31);
  for (int i = 0; i < 6; ++i) {
    config.min_disparity_px = static_cast<std::int16_t>(-8 * (i % 2));
    config.smooth_radius_px = static_cast<std::uint8_t>(i % 3);
    hash.word(static_cast<std::uint64_t>(matcher->configure(config)), 1);
    draw(random, *left, *right);
    (void)rectifier->run(left->view(), right->view(), *flat_left, *flat_right);
    for (const bool raw : {true, false}) {
      const stereo::GreyView& a = raw ? left->view() : flat_left->view();
      const stereo::GreyView& b = raw ? right->view() : flat_right->view();
      (void)matcher->match(a, b, *disparities);
      hash.word(rectifier->clear_unseen(3, *disparities), 4);
      for (std::size_t k = 0; k < disparities->pixel_count(); ++k) {
        hash.word(static_cast<std::uint16_t>(disparities->values[k]), 2);
        hash.word(disparities->contrasts[k], 1);
      }
      (void)stereo::make_points(*disparities, pair, recommended_points(), *cloud);
      for (const stereo::StereoPoint& point : *cloud) {
        mix(hash, point.p_N_m);
        mix(hash, point.variance_m2);
      }
    }
  }
}

}  // namespace surefoot::tests
