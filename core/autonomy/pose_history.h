// Where the body and the legs were: a second of estimates, so that a camera frame is placed by the
// pose of its own exposure and not by that of its arrival.
#pragma once

#include <array>

#include "core/base/ring_buffer.h"
#include "core/base/status.h"
#include "core/base/time.h"
#include "core/estimation/estimator.h"
#include "core/geometry/frames.h"
#include "core/geometry/rotations.h"

namespace surefoot::autonomy {

struct PastPose {
  TimeNs stamp;
  Vector3 p_OB_m = Vector3::Zero();
  geometry::Quaternion q_OB;
  std::array<double, robot::kJoints> joint_rad{};

  geometry::Pose<geometry::Odometry, geometry::Body> X_OB() const {
    return {{geometry::to_matrix(q_OB)}, {p_OB_m}};
  }
};

// What was believed to be at a place of O is elsewhere: turned about up around the pivot, and
// moved.
struct OdometryShift {
  Vector3 pivot_O_m = Vector3::Zero();
  Vector3 shift_O_m = Vector3::Zero();
  double yaw_rad = 0;

  Vector3 operator()(const Vector3& p_O_m) const {
    return pivot_O_m + shift_O_m + geometry::rotation_z(yaw_rad) * (p_O_m - pivot_O_m);
  }
};

class PoseHistory {
 public:
  static constexpr std::size_t kCapacity = 512;  // 1 s at 500 Hz

  void clear() { poses_.clear(); }
  // Stamps must not go back; an equal one is ignored.
  void push(const estimation::RobotState& state);
  // All poses were off.
  void move(const OdometryShift& shift);
  // The pose at a stamp, interpolated. kUnavailable: empty. kOutOfRange: older than the oldest, or
  // newer than the newest pose. Cost: O(log kCapacity).
  Result<PastPose> at(TimeNs stamp) const;

 private:
  RingBuffer<PastPose, kCapacity> poses_;
};

}  // namespace surefoot::autonomy
