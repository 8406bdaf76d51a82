// The drift estimator against a camera and an odometry whose errors are known.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/random.h"
#include "core/estimation/relocation.h"
#include "core/estimation/tracking.h"

namespace surefoot::estimation {
namespace {

constexpr double kStep_s = 0.005;

TrackingConfig tracking_config() {
  TrackingConfig config;
  config.min_confidence = 2;
  config.jump_m = 0.015;
  config.jump_rad = 0.012;
  config.odometry_drift_m_s = 0.03;
  config.odometry_drift_rad_s = 0.003;
  config.own_horizontal_m = 0.015;
  config.own_vertical_m = 0.004;
  config.own_yaw_rad = 0.003;
  config.own_error_share = 0.05;
  config.position_gain_1_s = 1.0;
  config.max_horizontal_m_s = 0.04;
  config.max_vertical_m_s = 0.01;
  config.yaw_gain_1_s = 0.5;
  config.max_yaw_rate_rad_s = 0.01;
  config.yaw_bias_gain_1_s2 = 0.01;
  config.tilt_gain_1_s = 0.05;
  return config;
}

robot::TrackingCameraSpecification camera() {
  robot::TrackingCameraSpecification camera;
  camera.mount.position_B_m = {0.26, 0.02, -0.01};
  camera.mount.roll_pitch_yaw_rad = {0.05, 0.3, -0.1};
  camera.rate_Hz = 1.0 / kStep_s;
  return camera;
}

// Walks along a curve at 0.5 m/s; its odometry sees the way longer and the turn faster than they
// are.
class Walk {
 public:
  double scale = 1.0;         // of the odometry
  double yaw_bias_rad_s = 0;  // of the gyro, what has been learned subtracted
  double noise_m = 0;
  double noise_rad = 0;
  Vector3 camera_shift_m = Vector3::Zero();  // of a camera that relocalises, in S
  double camera_yaw_rad = 0;

  Walk() { drift.reset(tracking_config()); }

  // One step of body and odometry.
  void move() {
    stamp = stamp + milliseconds(5);
    t_s += kStep_s;
    const double omega = 0.2 * std::sin(0.3 * t_s);
    yaw_rad += omega * kStep_s;
    own_yaw_rad += (omega + yaw_bias_rad_s) * kStep_s;
    const Vector3 step_B(0.5 * kStep_s, 0, 0.05 * std::cos(10 * t_s) * kStep_s);
    p_m += geometry::rotation_z(yaw_rad) * step_B;
    own_p_m += geometry::rotation_z(own_yaw_rad) * (step_B * scale);
  }
  hal::PoseSample sample() {
    const robot::TrackingCameraSpecification spec = camera();
    const auto& rpy = spec.mount.roll_pitch_yaw_rad;
    const Matrix3 R_BT = geometry::from_roll_pitch_yaw(rpy[0], rpy[1], rpy[2]);
    const Vector3 p_BT(spec.mount.position_B_m[0], spec.mount.position_B_m[1],
                       spec.mount.position_B_m[2]);
    // S: anywhere and tilted.
    const Matrix3 R_SW = geometry::from_roll_pitch_yaw(0.1, -0.2, 2.0);
    const Matrix3 seen = geometry::rotation_z(camera_yaw_rad);
    const Matrix3 R_WB = body(yaw_rad);
    Vector3 p_ST = R_SW * (seen * (p_m + R_WB * p_BT)) + Vector3(3, -2, 1) + camera_shift_m;
    Vector3 jitter;
    for (int i = 0; i < 3; ++i) {
      p_ST[i] += noise_m * random.normal();
      jitter[i] = noise_rad * random.normal();
    }
    const geometry::Quaternion q =
        geometry::to_quaternion(R_SW * seen * R_WB * R_BT) * geometry::from_rotation_vector(jitter);
    hal::PoseSample sample;
    sample.stamp = stamp;
    sample.confidence = 3;
    sample.p_ST_m = {p_ST[0], p_ST[1], p_ST[2]};
    sample.q_ST_wxyz = {q.w, q.x, q.y, q.z};
    return sample;
  }
  PoseAtStamp own() const { return {own_p_m, geometry::to_quaternion(body(own_yaw_rad))}; }
  CameraPose camera_pose() { return CameraMount(camera()).trunk(sample()); }
  Status observe() {
    const hal::PoseSample taken = sample();
    const Status status = drift.check(taken);
    if (!ok(status)) return status;
    correction = drift.observe(CameraMount(camera()).trunk(taken), own());
    own_p_m += correction.shift_O_m;
    own_yaw_rad += correction.yaw_rad;
    yaw_bias_rad_s -= correction.yaw_bias_rad_s;
    return status;
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / kStep_s); ++i) {
      move();
      ASSERT_EQ(observe(), Status::kOk);
      ASSERT_LE(correction.shift_O_m.head<2>().norm(), 0.04 * kStep_s + 1e-12);
      ASSERT_LE(std::fabs(correction.shift_O_m[2]), 0.01 * kStep_s + 1e-12);
      ASSERT_LE(std::fabs(correction.yaw_rad), 0.01 * kStep_s + 1e-12);
    }
  }
  double error_m() const { return (own_p_m - p_m).norm(); }

  DriftEstimator drift;
  DriftCorrection correction;
  TimeNs stamp;
  double t_s = 0;
  double yaw_rad = 0;
  double own_yaw_rad = 0;
  Vector3 p_m = Vector3(0, 0, 0.3);
  Vector3 own_p_m = Vector3(0, 0, 0.3);
  Random random{7};

 private:
  Matrix3 body(double heading_rad) const {
    return geometry::from_roll_pitch_yaw(0.03 * std::sin(8 * t_s), 0.02 * std::cos(9 * t_s),
                                         heading_rad);
  }
};

TEST(Drift, AnExactOdometryIsLeftAloneWhateverMountAndStart) {
  Walk walk;
  walk.run(20.0);
  EXPECT_LT(walk.error_m(), 1e-9);
  EXPECT_LT(std::fabs(walk.own_yaw_rad - walk.yaw_rad), 1e-9);
  EXPECT_EQ(walk.drift.counters().jumps, 0u);
  EXPECT_EQ(walk.drift.counters().used, 4000u);
}

TEST(Drift, OfScaleAndYawIsTakenOutAndTheBiasLearned) {
  Walk alone;
  alone.scale = 1.04;
  alone.yaw_bias_rad_s = 0.002;
  for (int i = 0; i < 24000; ++i) alone.move();
  ASSERT_GT(alone.error_m(), 1.0);  // what there is to take out

  Walk walk;
  walk.scale = 1.04;
  walk.yaw_bias_rad_s = 0.002;
  walk.noise_m = 0.001;
  walk.noise_rad = 0.001;
  walk.run(120.0);
  EXPECT_LT(walk.error_m(), 0.05);
  EXPECT_LT(std::fabs(walk.own_yaw_rad - walk.yaw_rad), 0.004);
  EXPECT_LT(std::fabs(walk.yaw_bias_rad_s), 0.0004);
  EXPECT_EQ(walk.drift.counters().jumps, 0u);
}

// Legs without drift beside a camera that creeps away within what may be its own: most of its drift
// stays out of O. The same creep beyond it is taken for the legs'.
TEST(Drift, WhatMayBeTheCamerasOwnIsLeftToIt) {
  Walk walk;
  for (int i = 0; i < 10; ++i) {
    walk.camera_shift_m += Vector3(0.001, 0.0005, 0.0003);
    walk.camera_yaw_rad += 0.0002;
    walk.run(1.0);
  }
  EXPECT_LT(walk.error_m(), 0.004);
  EXPECT_LT(std::fabs(walk.own_yaw_rad - walk.yaw_rad), 0.0005);
  EXPECT_EQ(walk.drift.counters().jumps, 0u);
  for (int i = 0; i < 40; ++i) {
    walk.camera_shift_m += Vector3(0.002, 0.0, 0.0);
    walk.run(1.0);
  }
  EXPECT_GT(walk.error_m(), 0.05);
}

// A slip of the legs within an eighth of a second: all but the camera's own error is taken out.
TEST(Drift, ASlipOfTheLegsIsTakenOut) {
  Walk walk;
  walk.noise_m = 0.001;
  walk.run(5.0);
  for (int i = 0; i < 25; ++i) {
    walk.own_p_m += Vector3(0.004, 0, 0);
    walk.run(kStep_s);
  }
  EXPECT_GT(walk.error_m(), 0.08);
  walk.run(8.0);
  EXPECT_LT(walk.error_m(), 0.018);
  EXPECT_EQ(walk.drift.counters().jumps, 0u);
}

TEST(Drift, AJumpOfTheCameraMovesItsStartFrameAndNotTheBody) {
  Walk walk;
  walk.noise_m = 0.001;
  walk.noise_rad = 0.001;
  walk.run(10.0);
  const double before_m = walk.error_m();
  walk.camera_shift_m = Vector3(0.2, -0.1, 0.05);
  walk.camera_yaw_rad = 0.1;
  walk.run(10.0);
  EXPECT_EQ(walk.drift.counters().jumps, 1u);
  EXPECT_LT(std::fabs(walk.error_m() - before_m), 0.01);
  EXPECT_LT(std::fabs(walk.own_yaw_rad - walk.yaw_rad), 0.004);
}

TEST(Drift, ASpikeOfOneSampleLeavesNothing) {
  Walk walk;
  walk.run(5.0);
  walk.camera_shift_m = Vector3(0, 0, 0.5);
  walk.run(kStep_s);
  walk.camera_shift_m.setZero();
  walk.run(5.0);
  EXPECT_EQ(walk.drift.counters().jumps, 2u);
  EXPECT_LT(walk.error_m(), 0.001);
}

TEST(Drift, OfAnOutageIsAbsorbedSlowlyWhenItCanBeTheLegs) {
  Walk walk;
  walk.scale = 1.03;
  walk.run(10.0);
  const double before_m = walk.error_m();
  for (int i = 0; i < 2000; ++i) walk.move();
  const double after_m = walk.error_m();
  EXPECT_GT(after_m, before_m + 0.1);
  walk.run(kStep_s);  // the bounds of a single correction are checked in here
  EXPECT_LT(std::fabs(walk.error_m() - after_m), 0.001);
  walk.run(15.0);
  EXPECT_LT(walk.error_m(), before_m + 0.01);
  EXPECT_EQ(walk.drift.counters().jumps, 0u);
}

TEST(Drift, AnOffsetThatTheLegsCannotHaveMadeMovesTheStartFrame) {
  Walk walk;
  walk.run(10.0);
  for (int i = 0; i < 2000; ++i) walk.move();
  walk.camera_shift_m = Vector3(4, 0, 0);  // the camera started anew
  walk.camera_yaw_rad = 2.0;
  walk.run(10.0);
  EXPECT_EQ(walk.drift.counters().jumps, 1u);
  EXPECT_LT(walk.error_m(), 0.001);
}

TEST(Drift, RefusesAndCountsWhatIsNoPose) {
  Walk walk;
  walk.run(1.0);
  const Vector3 before = walk.drift.position_error_O_m();
  const auto refuse = [&](const hal::PoseSample& sample, Status expected) {
    EXPECT_EQ(walk.drift.check(sample), expected);
  };
  refuse(walk.sample(), Status::kInvalid);  // the stamp of the last one
  walk.move();
  hal::PoseSample sample = walk.sample();
  sample.p_ST_m[1] = std::numeric_limits<double>::quiet_NaN();
  refuse(sample, Status::kInvalid);
  sample = walk.sample();
  sample.q_ST_wxyz = {0, 0, 0, 0};
  refuse(sample, Status::kInvalid);
  sample = walk.sample();
  sample.confidence = 1;
  refuse(sample, Status::kUnavailable);
  EXPECT_EQ((walk.drift.position_error_O_m() - before).norm(), 0.0);
  EXPECT_EQ(walk.drift.counters().refused, 3u);
  EXPECT_EQ(walk.drift.counters().low_confidence, 1u);
  EXPECT_EQ(walk.drift.counters().used, 200u);
  EXPECT_EQ(walk.observe(), Status::kOk);
}

// Walks for two seconds, falls a third of a second after `trusted`, and its legs carry it away.
struct Fall {
  Walk walk;
  Relocation relocation;
  TimeNs trusted;

  Fall() {
    step(400);
    trusted = walk.stamp;
    for (int i = 0; i < 60; ++i) {
      step(1);
      walk.own_p_m += Vector3(0.01, -0.02, 0.005);
    }
    relocation.pin(trusted);
  }
  void step(int samples) {
    for (int i = 0; i < samples; ++i) {
      walk.move();
      relocation.observe(walk.camera_pose(), walk.own());
    }
  }
  void lie(int samples) {
    for (int i = 0; i < samples; ++i) {
      walk.move();
      relocation.observe(walk.camera_pose());
    }
  }
};

TEST(Relocation, TheCameraSaysWhereAFallHasEnded) {
  Fall fall;
  fall.walk.yaw_rad += 0.8;  // it is turned as it falls, and the gyro has seen nothing of it
  fall.lie(800);
  const Result<PoseAtStamp> pose = fall.relocation.pose(fall.walk.stamp);
  ASSERT_TRUE(pose.ok());
  EXPECT_LT((pose.value().p_OB_m - fall.walk.p_m).norm(), 1e-9);
  const Vector3 rpy = geometry::to_roll_pitch_yaw(geometry::to_matrix(pose.value().q_OB));
  EXPECT_NEAR(rpy[2], fall.walk.yaw_rad, 1e-9);
}

TEST(Relocation, TheErrorOfAnOwnPoseBeforeTheFallStays) {
  Fall fall;
  fall.relocation.pin(fall.trusted + milliseconds(150));  // half of the way it was carried
  fall.lie(100);
  const Result<PoseAtStamp> pose = fall.relocation.pose(fall.walk.stamp);
  ASSERT_TRUE(pose.ok());
  EXPECT_NEAR((pose.value().p_OB_m - fall.walk.p_m).norm(), 30 * Vector3(1, -2, 0.5).norm() * 0.01,
              0.03);
}

TEST(Relocation, ACameraThatWasAwayCannotTell) {
  Fall fall;
  fall.lie(50);
  for (int i = 0; i < 50; ++i) fall.walk.move();
  EXPECT_FALSE(fall.relocation.pose(fall.walk.stamp).ok());  // is away
  fall.lie(50);
  EXPECT_FALSE(fall.relocation.pose(fall.walk.stamp).ok());  // was away
}

TEST(Relocation, AFallRightAfterGettingUpCountsFromTheFallBefore) {
  Fall fall;
  fall.lie(200);
  fall.walk.own_p_m = fall.walk.p_m;
  const TimeNs stood_up = fall.walk.stamp;
  fall.step(10);
  fall.walk.own_p_m += Vector3(1, 0, 0);
  fall.step(10);
  fall.relocation.pin(stood_up - milliseconds(10));
  fall.lie(200);
  const Result<PoseAtStamp> pose = fall.relocation.pose(fall.walk.stamp);
  ASSERT_TRUE(pose.ok());
  EXPECT_LT((pose.value().p_OB_m - fall.walk.p_m).norm(), 1e-9);
}

TEST(Relocation, NothingPinnedIsUnavailable) {
  Relocation relocation;
  EXPECT_EQ(relocation.pose(TimeNs{0}).status(), Status::kUnavailable);
  Walk walk;
  walk.move();
  relocation.observe(walk.camera_pose(), walk.own());
  relocation.pin(TimeNs{0});  // older than what is kept
  EXPECT_EQ(relocation.pose(walk.stamp).status(), Status::kUnavailable);
}

}  // namespace
}  // namespace surefoot::estimation
