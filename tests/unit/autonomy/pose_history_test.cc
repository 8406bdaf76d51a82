#include "core/autonomy/pose_history.h"

#include <gtest/gtest.h>

#include <cmath>

namespace surefoot::autonomy {
namespace {

estimation::RobotState state_at(int ms) {
  estimation::RobotState state;
  state.stamp = milliseconds(ms);
  state.p_OB_m = Vector3(0.001 * ms, 0.0, 0.3);
  state.q_OB = geometry::from_rotation_vector(Vector3(0.0, 0.0, 0.0005 * ms));
  for (actuation::JointState& joint : state.joints) joint.position_rad = 0.002 * ms;
  return state;
}

TEST(PoseHistory, InterpolatesBetweenPoses) {
  PoseHistory history;
  for (int ms = 0; ms <= 100; ms += 2) history.push(state_at(ms));
  const Result<PastPose> pose = history.at(microseconds(51500));
  ASSERT_TRUE(pose.ok());
  EXPECT_NEAR(pose.value().p_OB_m[0], 0.0515, 1e-12);
  EXPECT_NEAR(geometry::to_rotation_vector(geometry::to_matrix(pose.value().q_OB))[2], 0.02575,
              1e-9);
  EXPECT_NEAR(pose.value().joint_rad[7], 0.103, 1e-12);
}

TEST(PoseHistory, GivesEveryStoredPoseExactly) {
  PoseHistory history;
  for (int ms = 0; ms < 2000; ms += 2) history.push(state_at(ms));
  for (int ms = 976; ms < 2000; ms += 2) {  // the last 512
    const Result<PastPose> pose = history.at(milliseconds(ms));
    ASSERT_TRUE(pose.ok()) << ms;
    EXPECT_EQ(pose.value().p_OB_m[0], 0.001 * ms);
  }
}

TEST(PoseHistory, RefusesWhatItDoesNotCover) {
  PoseHistory history;
  EXPECT_EQ(history.at(milliseconds(1)).status(), Status::kUnavailable);
  for (int ms = 0; ms < 2000; ms += 2) history.push(state_at(ms));
  EXPECT_EQ(history.at(milliseconds(974)).status(), Status::kOutOfRange);
  EXPECT_EQ(history.at(milliseconds(1999)).status(), Status::kOutOfRange);
  history.push(state_at(500));  // stamps never go back
  EXPECT_EQ(history.at(milliseconds(1998)).value().p_OB_m[0], 0.001 * 1998);
}

TEST(PoseHistory, MovesEveryPoseAboutThePivot) {
  PoseHistory history;
  for (int ms = 0; ms <= 100; ms += 2) history.push(state_at(ms));
  OdometryShift shift;
  shift.pivot_O_m = Vector3(0.1, 0.0, 0.3);
  shift.shift_O_m = Vector3(0.01, 0.02, 0.03);
  shift.yaw_rad = 0.5;
  history.move(shift);
  const PastPose last = history.at(milliseconds(100)).value();  // at the pivot
  EXPECT_LT((last.p_OB_m - Vector3(0.11, 0.02, 0.33)).norm(), 1e-12);
  EXPECT_NEAR(geometry::to_rotation_vector(geometry::to_matrix(last.q_OB))[2], 0.55, 1e-9);
  const PastPose first = history.at(milliseconds(0)).value();  // 0.1 m behind it
  EXPECT_LT(
      (first.p_OB_m - Vector3(0.11 - 0.1 * std::cos(0.5), 0.02 - 0.1 * std::sin(0.5), 0.33)).norm(),
      1e-9);
}

}  // namespace
}  // namespace surefoot::autonomy
