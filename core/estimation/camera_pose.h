// The trunk's pose as a tracking camera sees it, in S, the camera's own world: the right-hand part
// X_ST X_TB of paper 002, equation (1).
#pragma once

#include "core/base/time.h"
#include "core/geometry/rotations.h"
#include "core/math/linear.h"
#include "core/robot/robot_model.h"
#include "hal/api/pose_port.h"

namespace surefoot::estimation {

// The estimator's pose at a sample's stamp.
struct PoseAtStamp {
  Vector3 p_OB_m = Vector3::Zero();
  geometry::Quaternion q_OB;
};

struct CameraPose {
  TimeNs stamp;
  Matrix3 R_SB = Matrix3::Identity();
  Vector3 p_SB_m = Vector3::Zero();
};

class CameraMount {
 public:
  CameraMount() = default;
  explicit CameraMount(const robot::TrackingCameraSpecification& camera);
  // Of a sample that is_pose().
  CameraPose trunk(const hal::PoseSample& sample) const;

 private:
  Matrix3 R_BT_ = Matrix3::Identity();
  Vector3 p_BT_m_ = Vector3::Zero();
};

// All numbers finite, a unit quaternion to 5e-4.
bool is_pose(const hal::PoseSample& sample);

}  // namespace surefoot::estimation
