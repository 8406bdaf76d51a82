// Visual odometry along a recorded hand-held sequence with true poses. Only its depth pictures are
// at hand, so the grey pictures are DERIVED: the recorded surfaces, smoothed, painted with a
// pattern that is fixed to the room, seen from the recorded poses. Depth with its noise and holes,
// motion and truth are real; the texture is not. (Lit by a lamp instead, the noise of the depth is
// most of what is seen: no motion is found, and none is invented.)
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/geometry/rotations.h"
#include "core/visual_odometry/visual_odometry.h"
#include "tests/real_data/kinect_sequence.h"
#include "tests/support/visual_odometry_setup.h"

namespace surefoot::real_data {
namespace {

const std::string kFolder = std::string(SUREFOOT_SHARED_DATA) + "/depth/kitchen_a";
constexpr double kBaseline_m = 0.06;  // of the pair that the disparities are those of
constexpr double kGyroNoise_rad = 0.001;

// Depth in metres at half the size, 0 where there is none.
cv::Mat half_depth(const hal::DepthFrame& frame) {
  cv::Mat depth(240, 320, CV_32F);
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      std::vector<float> valid;
      for (int i = 0; i < 4; ++i) {
        const int at = (2 * v + i / 2) * 640 + 2 * u + i % 2;
        const std::uint16_t value = frame.depth[static_cast<std::size_t>(at)];
        if (value != 0) valid.push_back(0.001F * static_cast<float>(value));
      }
      std::sort(valid.begin(), valid.end());
      depth.at<float>(v, u) = valid.empty() ? 0.0F : valid[valid.size() / 2];
    }
  }
  return depth;
}

// Holes take what lies left of them.
cv::Mat filled(const cv::Mat& depth) {
  cv::Mat out = depth.clone();
  for (int v = 0; v < out.rows; ++v) {
    float last = 2.0F;
    for (int u = 0; u < out.cols; ++u) {
      float& value = out.at<float>(v, u);
      if (value == 0.0F) value = last;
      last = value;
    }
  }
  return out;
}

double lattice(int x, int y, int z) {
  Random random(static_cast<std::uint64_t>(x * 73856093) ^ static_cast<std::uint64_t>(y * 19349663),
                static_cast<std::uint64_t>(z + 4096));
  return random.uniform(-1, 1);
}

// A pattern that fills the room, smooth over `size_m`.
double pattern(const Vector3& p_W_m, double size_m) {
  const Vector3 p = p_W_m / size_m;
  const Vector3 low(std::floor(p.x()), std::floor(p.y()), std::floor(p.z()));
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    int at[3];
    for (int axis = 0; axis < 3; ++axis) {
      const int bit = corner >> axis & 1;
      const double t = p[axis] - low[axis];
      const double eased = t * t * (3 - 2 * t);
      weight *= bit != 0 ? eased : 1 - eased;
      at[axis] = static_cast<int>(low[axis]) + bit;
    }
    sum += weight * lattice(at[0], at[1], at[2]);
  }
  return sum;
}

// What is seen of the pattern on the surfaces.
cv::Mat painted(const cv::Mat& depth, const stereo::RectifiedPair& pair, const Matrix3& R_WC,
                const Vector3& p_WC_m, Random& random) {
  cv::Mat smooth;
  cv::bilateralFilter(filled(depth), smooth, 7, 0.05, 2.0);
  cv::Mat grey(smooth.size(), CV_8U, cv::Scalar(0));
  for (int v = 0; v < grey.rows; ++v) {
    for (int u = 0; u < grey.cols; ++u) {
      const double z = static_cast<double>(smooth.at<float>(v, u));
      const Vector3 p((u - pair.cx_px) / pair.focal_px * z, (v - pair.cy_px) / pair.focal_px * z,
                      z);
      const Vector3 p_W_m = R_WC * p + p_WC_m;
      double value = 128 + 2 * random.normal();
      for (const double size_m : {0.2, 0.1, 0.05}) value += 40 * pattern(p_W_m, size_m);
      grey.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(value);
    }
  }
  return grey;
}

void fill(const cv::Mat& depth, const stereo::RectifiedPair& pair, stereo::DisparityImage& out) {
  out.width_px = pair.width_px;
  out.height_px = pair.height_px;
  for (int v = 0; v < depth.rows; ++v) {
    std::int16_t* row = out.row(static_cast<std::size_t>(v));
    for (int u = 0; u < depth.cols; ++u) {
      const double z = static_cast<double>(depth.at<float>(v, u));
      const double disparity = pair.focal_px * pair.baseline_m / z * stereo::kSubpixels;
      row[u] = z > 0 ? static_cast<std::int16_t>(std::lround(disparity)) : stereo::kNoDisparity;
    }
  }
}

struct Pose {
  Matrix3 R = Matrix3::Identity();
  Vector3 p_m = Vector3::Zero();
};
Pose between(const Pose& a, const Pose& b) {
  return {a.R.transpose() * b.R, a.R.transpose() * (b.p_m - a.p_m)};
}
Pose chain(const Pose& a, const Pose& b) { return {a.R * b.R, a.p_m + a.R * b.p_m}; }

stereo::RectifiedPair half_pair() {
  const hal::PinholeIntrinsics full = read_intrinsics(kFolder);
  stereo::RectifiedPair pair;
  pair.width_px = 320;
  pair.height_px = 240;
  pair.focal_px = 0.5 * static_cast<double>(full.fx_px);
  pair.cx_px = 0.5 * (static_cast<double>(full.cx_px) - 0.5);
  pair.cy_px = 0.5 * (static_cast<double>(full.cy_px) - 0.5);
  pair.baseline_m = kBaseline_m;
  return pair;
}

TEST(RealVisualOdometry, DriftAlongARecordedSequence) {
  const std::vector<PosedFrame> frames = list_frames(kFolder);
  if (frames.empty()) GTEST_SKIP() << kFolder << " is missing";
  const stereo::RectifiedPair pair = half_pair();
  const auto odometry = std::make_unique<visual_odometry::VisualOdometry>();
  const auto disparities = std::make_unique<stereo::DisparityImage>();
  const auto depth = std::make_unique<hal::DepthFrame>();
  visual_odometry::VisualOdometryConfig config = tests::recommended_visual_odometry();
  config.track_noise_px = 0.4;  // the depth's noise moves the paint
  config.disparity_noise_px = 0.2;
  ASSERT_EQ(odometry->configure(config, pair), Status::kOk);
  Random random(1);
  Pose key;
  Pose believed;
  Pose last;
  double way_m = 0;
  int good = 0;
  int failed = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_TRUE(read_depth(frames[i].image_path, *depth));
    const Pose truth{frames[i].R_WC, frames[i].p_WC_m};
    if (i == 0) key = believed = last = truth;
    const cv::Mat half = half_depth(*depth);
    const cv::Mat grey = painted(half, pair, truth.R, truth.p_m, random);
    fill(half, pair, *disparities);
    Vector3 noise;
    for (int axis = 0; axis < 3; ++axis) noise[axis] = kGyroNoise_rad * random.normal();
    visual_odometry::Prediction prediction;
    const geometry::Quaternion turned = geometry::to_quaternion(between(last, truth).R);
    prediction.R_PN = geometry::to_matrix(geometry::normalised(turned)) *
                      geometry::to_matrix(geometry::from_rotation_vector(noise));
    // Legs that are 10 % off.
    prediction.p_PN_m = 1.1 * between(last, truth).p_m;
    visual_odometry::Motion motion;
    const visual_odometry::Pictures input{TimeNs{static_cast<std::int64_t>(i + 1) * 200'000'000},
                                          {grey.data, 320, 240},
                                          {},
                                          disparities.get()};
    ASSERT_EQ(odometry->update(input, prediction, motion), Status::kOk);
    const double step_m = (truth.p_m - last.p_m).norm();
    way_m += step_m;
    const Pose predicted = chain(believed, {prediction.R_PN, prediction.p_PN_m});
    if (motion.status == visual_odometry::MotionStatus::kOk) {
      ++good;
      believed = chain(key, {motion.R_KN, motion.p_KN_m});
    } else if (i > 0) {
      ++failed;
      believed = predicted;
    }
    if (motion.new_keyframe) key = believed;
    last = truth;
  }
  const double error_m = (believed.p_m - last.p_m).norm();
  const double turn_rad = geometry::to_rotation_vector(between(believed, last).R).norm();
  std::printf(
      "kitchen_a, painted: %d motions, %d failed, way %.2f m, end error %.3f m (%.1f %%), "
      "%.1f mrad\n",
      good, failed, way_m, error_m, 100 * error_m / way_m, 1e3 * turn_rad);
  EXPECT_LT(error_m / way_m, 0.05);
}

}  // namespace
}  // namespace surefoot::real_data
