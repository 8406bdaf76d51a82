#include "core/estimation/camera_pose.h"

#include "core/math/elementary.h"

namespace surefoot::estimation {
namespace {

constexpr double kUnitTolerance = 1e-3;  // of the squared norm of a unit quaternion

Vector3 from_array(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

}  // namespace

CameraMount::CameraMount(const robot::TrackingCameraSpecification& camera) {
  const auto& rpy = camera.mount.roll_pitch_yaw_rad;
  R_BT_ = geometry::from_roll_pitch_yaw(rpy[0], rpy[1], rpy[2]);
  p_BT_m_ = from_array(camera.mount.position_B_m);
}

CameraPose CameraMount::trunk(const hal::PoseSample& sample) const {
  const auto& q = sample.q_ST_wxyz;
  CameraPose pose;
  pose.stamp = sample.stamp;
  pose.R_SB =
      geometry::to_matrix(geometry::normalised({q[0], q[1], q[2], q[3]})) * R_BT_.transpose();
  pose.p_SB_m = from_array(sample.p_ST_m) - pose.R_SB * p_BT_m_;
  return pose;
}

bool is_pose(const hal::PoseSample& sample) {
  double unit_error = -1.0;
  for (const double q : sample.q_ST_wxyz) {
    if (!math::is_finite(q)) return false;
    unit_error += q * q;
  }
  for (const double p : sample.p_ST_m) {
    if (!math::is_finite(p)) return false;
  }
  return math::magnitude(unit_error) <= kUnitTolerance;
}

}  // namespace surefoot::estimation
