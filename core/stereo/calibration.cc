#include "core/stereo/calibration.h"

#include <Eigen/Geometry>

#include "core/geometry/rotations.h"
#include "core/math/elementary.h"
#include "core/stereo/images.h"

namespace surefoot::stereo {

namespace {

constexpr double kMinBaseline_m = 0.001;
constexpr double kRotationTolerance = 1e-6;

// Radial factor and tangential shift at an undistorted direction.
struct Distortion {
  double radial;
  double dx;
  double dy;
};

Distortion distortion_at(const std::array<double, 8>& k, double x, double y) {
  const double r2 = x * x + y * y;
  const double over = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double under = 1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
  return {over / under, 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x),
          k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y};
}

bool is_good(const CameraModel& camera) {
  bool good = camera.width_px >= 16 && camera.width_px <= kMaxWidth_px && camera.height_px >= 16 &&
              camera.height_px <= kMaxHeight_px;
  for (const double focal : {camera.fx_px, camera.fy_px}) {
    good = good && focal > 1.0 && focal < 1e5;
  }
  for (const double centre : {camera.cx_px, camera.cy_px}) {
    good = good && centre > -1e5 && centre < 1e5;
  }
  for (const double k : camera.distortion) good = good && k > -1e3 && k < 1e3;
  return good;
}

// Half of the turn from V to E: the square root of a unit quaternion with w >= 0.
Matrix3 half_turn(const Matrix3& R_EV) {
  geometry::Quaternion q = geometry::to_quaternion(R_EV);
  q.w += 1.0;
  return geometry::to_matrix(geometry::normalised(q));
}

// The shortest turn of a direction onto +x; the direction's x is positive.
Matrix3 turn_onto_x(const Vector3& direction) {
  const Vector3 d = direction / math::sqrt(direction.squaredNorm());
  const Matrix3 K = geometry::cross_matrix(Vector3(0.0, d.z(), -d.y()));  // d x (1, 0, 0)
  const Matrix3 K2 = K.lazyProduct(K);
  return Matrix3::Identity() + K + K2 / (1.0 + d.x());
}

// Mean of where the corners of both pictures would lie with focal length 1 and centre 0.
Vector2 middle_of_view(const StereoCalibration& calibration, const RectifiedPair& pair) {
  Vector2 sum = Vector2::Zero();
  const auto add = [&](const CameraModel& camera, const Matrix3& R_NC) {
    for (const double u : {0.0, camera.width_px - 1.0}) {
      for (const double v : {0.0, camera.height_px - 1.0}) {
        const Vector2 seen = camera.direction(u, v);
        const Vector3 ray_N = R_NC * Vector3(seen.x(), seen.y(), 1.0);
        sum += Vector2(ray_N.x() / ray_N.z(), ray_N.y() / ray_N.z());
      }
    }
  };
  add(calibration.left, pair.R_NV);
  add(calibration.right, pair.R_NE);
  return sum / 8.0;
}

CameraModel camera_model(const robot::StereoCameraCalibration& file,
                         const robot::StereoLens& lens) {
  return {file.width_px,  file.height_px, lens.matrix[0], lens.matrix[4],
          lens.matrix[2], lens.matrix[5], lens.distortion};
}

}  // namespace

StereoCalibration stereo_calibration(const robot::StereoCameraCalibration& file) {
  StereoCalibration calibration;
  calibration.left = camera_model(file, file.left);
  calibration.right = camera_model(file, file.right);
  for (Eigen::Index i = 0; i < 9; ++i) {
    calibration.R_EV(i / 3, i % 3) = file.R_EV[static_cast<std::size_t>(i)];
  }
  calibration.p_EV_m = Vector3(file.p_EV_m[0], file.p_EV_m[1], file.p_EV_m[2]);
  return calibration;
}

Vector2 CameraModel::project(double x, double y) const {
  const Distortion at = distortion_at(distortion, x, y);
  return {fx_px * (x * at.radial + at.dx) + cx_px, fy_px * (y * at.radial + at.dy) + cy_px};
}

Vector2 CameraModel::direction(double u_px, double v_px) const {
  const double x_seen = (u_px - cx_px) / fx_px;
  const double y_seen = (v_px - cy_px) / fy_px;
  double x = x_seen;
  double y = y_seen;
  for (int i = 0; i < kUndistortSteps; ++i) {
    const Distortion at = distortion_at(distortion, x, y);
    x = (x_seen - at.dx) / at.radial;
    y = (y_seen - at.dy) / at.radial;
  }
  return {x, y};
}

Status rectify(const StereoCalibration& calibration, std::uint16_t width_px,
               std::uint16_t height_px, double focal_px, RectifiedPair& out) {
  const CameraModel& left = calibration.left;
  const CameraModel& right = calibration.right;
  const bool sizes = left.width_px == right.width_px && left.height_px == right.height_px &&
                     width_px >= 16 && width_px <= kMaxWidth_px && height_px >= 16 &&
                     height_px <= kMaxHeight_px;
  if (!sizes || !is_good(left) || !is_good(right) || !(focal_px >= 0.0 && focal_px < 1e5) ||
      !geometry::is_rotation(calibration.R_EV, kRotationTolerance) ||
      !math::is_finite(calibration.p_EV_m.squaredNorm())) {
    return Status::kInvalid;
  }
  const Matrix3 half = half_turn(calibration.R_EV);
  // In axes half way between the cameras: the right camera from the left one.
  const Vector3 baseline = half.transpose() * -calibration.p_EV_m;
  const double across = math::sqrt(baseline.y() * baseline.y() + baseline.z() * baseline.z());
  if (baseline.x() < kMinBaseline_m || across > baseline.x()) return Status::kOutOfRange;
  RectifiedPair pair;
  pair.width_px = width_px;
  pair.height_px = height_px;
  pair.baseline_m = math::sqrt(baseline.squaredNorm());
  const Matrix3 turn = turn_onto_x(baseline);
  pair.R_NV = turn.lazyProduct(half);
  pair.R_NE = turn.lazyProduct(half.transpose());
  const double scale = static_cast<double>(width_px) / left.width_px;
  pair.focal_px = focal_px > 0.0 ? focal_px : 0.5 * (left.fx_px + right.fx_px) * scale;
  const Vector2 middle = middle_of_view(calibration, pair);
  pair.cx_px = 0.5 * (width_px - 1) - pair.focal_px * middle.x();
  pair.cy_px = 0.5 * (height_px - 1) - pair.focal_px * middle.y();
  if (!math::is_finite(pair.cx_px + pair.cy_px)) return Status::kInvalid;
  out = pair;
  return Status::kOk;
}

}  // namespace surefoot::stereo
