#include "tests/unit/visual_odometry/walk.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/geometry/rotations.h"
#include "core/math/elementary.h"

namespace surefoot::tests {

namespace {

constexpr double kHeight_m = 0.45;
constexpr double kPitch_rad = 0.5;

Vector6 error_of(const visual_odometry::Motion& motion, const CameraPlace& truth) {
  Vector6 error;
  error << motion.p_KN_m - truth.p_WN_m,
      geometry::to_rotation_vector(motion.R_KN * truth.R_WN.transpose());
  return error;
}

void fill(const StereoPictures& pictures, stereo::DisparityImage& out) {
  out.width_px = pictures.width_px;
  out.height_px = pictures.height_px;
  for (std::size_t i = 0; i < pictures.disparity_px.size(); ++i) {
    out.values[i] =
        static_cast<std::int16_t>(std::lround(pictures.disparity_px[i] * stereo::kSubpixels));
  }
}

}  // namespace

CameraPlace relative(const CameraPlace& a, const CameraPlace& b) {
  return {a.R_WN.transpose() * b.R_WN, a.R_WN.transpose() * (b.p_WN_m - a.p_WN_m)};
}

CameraPlace chain(const CameraPlace& a, const CameraPlace& b) {
  return {a.R_WN * b.R_WN, a.p_WN_m + a.R_WN * b.p_WN_m};
}

CameraPlace camera_at(const WalkOptions& options, double time_s) {
  const double yaw = options.turn_rad_s * time_s;
  const double turn = options.turn_rad_s;
  const double x =
      turn == 0 ? options.speed_m_s * time_s : options.speed_m_s / turn * std::sin(yaw);
  const double y = turn == 0 ? 0 : options.speed_m_s / turn * (1 - std::cos(yaw));
  const double moving = options.speed_m_s == 0 && turn == 0 ? 0 : 1;
  const double phase = 2 * math::kPi * 2.5 * time_s;
  const Vector3 p(x, y + moving * 0.01 * std::sin(0.5 * phase),
                  kHeight_m + moving * 0.008 * std::sin(phase));
  return walking_camera(p, yaw + moving * 0.01 * std::sin(0.5 * phase),
                        kPitch_rad + moving * 0.02 * std::sin(phase + 1),
                        moving * 0.03 * std::sin(0.5 * phase));
}

WalkResult walk(const WalkOptions& options) {
  const stereo::RectifiedPair pair = small_pair();
  TexturedScene scene(options.seed, options.contrast, options.boxes);
  const auto odometry = std::make_unique<visual_odometry::VisualOdometry>();
  const auto disparities = std::make_unique<stereo::DisparityImage>();
  EXPECT_EQ(odometry->configure(recommended_visual_odometry(), pair), Status::kOk);
  Random random(options.seed, 5);
  WalkResult result;
  std::vector<double> errors;
  CameraPlace keyframe = camera_at(options, 0);  // believed
  CameraPlace true_keyframe = keyframe;
  CameraPlace believed = keyframe;
  CameraPlace last = keyframe;
  if (options.object_m_s != 0) scene.boxes().push_back({});
  for (int i = 0; i < options.pictures; ++i) {
    const double time_s = i * kPicturePeriod_s;
    const CameraPlace camera = camera_at(options, time_s);
    if (options.object_m_s != 0) {
      const CameraPlace middle = camera_at(options, time_s);
      const double side = options.object_m_s * (time_s - 0.5 * options.pictures * kPicturePeriod_s);
      scene.boxes().back() = {middle.p_WN_m + Vector3(0.75, side, 0.1 - kHeight_m),
                              Vector3(0.1, 0.22, 0.2)};
    }
    Exposure exposure;
    exposure.grey_noise = options.grey_noise;
    exposure.noise_seed = options.seed * 1000 + static_cast<std::uint64_t>(i);
    if (options.changing_exposure) exposure.gain = 1 + 0.25 * std::sin(0.5 * i);
    const StereoPictures pictures = scene.render(pair, camera, exposure);
    visual_odometry::Prediction prediction;
    Vector3 noise;
    for (int axis = 0; axis < 3; ++axis) noise[axis] = options.gyro_noise_rad * random.normal();
    prediction.R_PN =
        relative(last, camera).R_WN * geometry::to_matrix(geometry::from_rotation_vector(noise));
    if (options.with_legs) {
      prediction.p_PN_m = 1.1 * relative(last, camera).p_WN_m;
      for (int axis = 0; axis < 3; ++axis) prediction.p_PN_m[axis] += 0.005 * random.normal();
    }
    visual_odometry::Pictures input{TimeNs{static_cast<std::int64_t>(1e9 * (time_s + 1))},
                                    pictures.left_view(), pictures.right_view(), nullptr};
    if (options.use_disparities) {
      fill(pictures, *disparities);
      input.disparities = disparities.get();
    }
    visual_odometry::Motion motion;
    EXPECT_EQ(odometry->update(input, prediction, motion), Status::kOk);
    result.way_m += (camera.p_WN_m - last.p_WN_m).norm();
    last = camera;
    if (motion.status == visual_odometry::MotionStatus::kOk) {
      ++result.ok;
      const Vector6 error = error_of(motion, relative(true_keyframe, camera));
      result.mean_nees += error.dot(Eigen::LDLT<Matrix6>(motion.covariance).solve(error));
      result.mean_inliers += motion.inliers;
      errors.push_back(error.head<3>().norm());
      believed = chain(keyframe, {motion.R_KN, motion.p_KN_m});
    } else if (motion.status != visual_odometry::MotionStatus::kFirst) {
      ++result.failed;
    }
    if (std::getenv("VO_SHOW") != nullptr) {
      std::printf("%2d s%d c%d d%d m%d q%d t%d i%d r%.3f k%d e%.5f\n", i,
                  static_cast<int>(motion.status), motion.corners, motion.with_depth,
                  motion.matched, motion.clique, motion.tracked, motion.inliers, motion.residual_px,
                  motion.new_keyframe, errors.empty() ? 0.0 : errors.back());
    }
    if (motion.new_keyframe) {
      ++result.keyframes;
      keyframe = believed;
      true_keyframe = camera;
    }
  }
  const CameraPlace off = relative(last, believed);
  result.end_error_m = off.p_WN_m.norm();
  result.turn_error_rad = geometry::to_rotation_vector(off.R_WN).norm();
  if (result.ok > 0) {
    result.mean_nees /= result.ok;
    result.mean_inliers /= result.ok;
    std::nth_element(errors.begin(), errors.begin() + result.ok / 2, errors.end());
    result.median_step_error_m = errors[static_cast<std::size_t>(result.ok / 2)];
  }
  return result;
}

}  // namespace surefoot::tests
