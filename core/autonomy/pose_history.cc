#include "core/autonomy/pose_history.h"

namespace surefoot::autonomy {

void PoseHistory::push(const estimation::RobotState& state) {
  if (!poses_.empty() && state.stamp <= poses_.back().stamp) return;
  PastPose pose;
  pose.stamp = state.stamp;
  pose.p_OB_m = state.p_OB_m;
  pose.q_OB = state.q_OB;
  for (std::size_t i = 0; i < robot::kJoints; ++i) {
    pose.joint_rad[i] = state.joints[i].position_rad;
  }
  poses_.push_overwrite(pose);
}

void PoseHistory::move(const OdometryShift& shift) {
  const geometry::Quaternion turn = geometry::to_quaternion(geometry::rotation_z(shift.yaw_rad));
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    PastPose& pose = poses_[i];
    pose.p_OB_m = shift(pose.p_OB_m);
    pose.q_OB = geometry::normalised(turn * pose.q_OB);
  }
}

Result<PastPose> PoseHistory::at(TimeNs stamp) const {
  if (poses_.empty()) return Status::kUnavailable;
  if (stamp < poses_.front().stamp || stamp > poses_.back().stamp) return Status::kOutOfRange;
  std::size_t low = 0;  // last pose not after the stamp
  std::size_t high = poses_.size() - 1;
  while (low + 1 < high) {
    const std::size_t middle = (low + high) / 2;
    (poses_[middle].stamp <= stamp ? low : high) = middle;
  }
  if (poses_[high].stamp <= stamp) low = high;
  const PastPose& before = poses_[low];
  if (before.stamp == stamp || low == high) return before;
  const PastPose& after = poses_[high];
  const double share = (stamp - before.stamp).seconds() / (after.stamp - before.stamp).seconds();
  PastPose pose;
  pose.stamp = stamp;
  pose.p_OB_m = before.p_OB_m + (after.p_OB_m - before.p_OB_m) * share;
  pose.q_OB = geometry::interpolate(before.q_OB, after.q_OB, share);
  for (std::size_t i = 0; i < robot::kJoints; ++i) {
    pose.joint_rad[i] = before.joint_rad[i] + (after.joint_rad[i] - before.joint_rad[i]) * share;
  }
  return pose;
}

}  // namespace surefoot::autonomy
