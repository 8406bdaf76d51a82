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
};

class PoseHistory {
 public:
  static constexpr std::size_t kCapacity = 512;  // 1 s at 500 Hz

  void clear() { poses_.clear(); }
  // Stamps must not go back; an equal one is ignored.
  void push(const estimation::RobotState& state);
  // The pose at a stamp, interpolated. kUnavailable: empty. kOutOfRange: older than the oldest, or
  // newer than the newest pose. Cost: O(log kCapacity).
  Result<PastPose> at(TimeNs stamp) const;

 private:
  RingBuffer<PastPose, kCapacity> poses_;
};

}  // namespace surefoot::autonomy
