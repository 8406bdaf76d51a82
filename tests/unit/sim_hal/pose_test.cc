#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim_hal/robot/articulation.h"
#include "tests/unit/sim_hal/sim_fixture.h"

namespace surefoot::sim {
namespace {

robot::RobotModel tracked() {
  robot::RobotModel model = mini_cheetah();
  model.tracking_camera.mount = {{0.26, 0.02, -0.01}, {0.1, 0.3, -0.2}};
  model.tracking_camera.rate_Hz = 200;
  return model;
}

SimulatorConfig on_stand() {
  SimulatorConfig config;
  config.start.trunk_fixed = true;
  config.start.drop_height_m = 0.5;
  return config;
}

Vector3 vector(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

Eigen::Quaterniond quaternion(const std::array<double, 4>& q) { return {q[0], q[1], q[2], q[3]}; }

std::vector<hal::PoseSample> collect(Rig& rig, double seconds) {
  std::vector<hal::PoseSample> all;
  std::array<hal::PoseSample, 16> some;
  for (int i = 0; i < static_cast<int>(seconds * 500); ++i) {
    rig.tick();
    const std::size_t count = rig.board.pose->receive(some);
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return all;
}

struct Camera {
  Vector3 p_WT_m;
  Matrix3 R_WT;
};

Camera truth(const Rig& rig) {
  const Truth truth = rig.simulator->truth();
  const robot::SensorMount& mount = rig.model.tracking_camera.mount;
  const Matrix3 R_WB = quaternion(truth.q_WB_wxyz).toRotationMatrix();
  return {vector(truth.p_WB_m) + R_WB * vector(mount.position_B_m), R_WB * mount_rotation(mount)};
}

TEST(SimPose, WithoutErrorsItIsTheWayFromTheStart) {
  SimulatorConfig config;
  config.start.drop_height_m = 0.4;
  Rig rig({}, config, 1, tracked());
  const Camera start = truth(rig);
  const std::vector<hal::PoseSample> samples = collect(rig, 1.0);  // falls and tumbles
  ASSERT_EQ(samples.size(), 200u);
  const Camera now = truth(rig);
  ASSERT_EQ(samples.back().stamp, rig.simulator->truth().stamp);
  EXPECT_GT((now.p_WT_m - start.p_WT_m).norm(), 0.2);
  const Vector3 p_ST = start.R_WT.transpose() * (now.p_WT_m - start.p_WT_m);
  EXPECT_LT((vector(samples.back().p_ST_m) - p_ST).norm(), 1e-9);
  const Matrix3 R_ST = quaternion(samples.back().q_ST_wxyz).toRotationMatrix();
  EXPECT_LT((R_ST - start.R_WT.transpose() * now.R_WT).norm(), 1e-9);
}

TEST(SimPose, ComesLateWithTheStampOfItsExposure) {
  SimulatorConfig config = on_stand();
  config.tracking.latency_s = 0.02;
  Rig rig({}, config, 1, tracked());
  const std::vector<hal::PoseSample> samples = collect(rig, 0.1);
  ASSERT_EQ(samples.size(), 16u);
  EXPECT_EQ(samples.front().stamp, milliseconds(5));
  EXPECT_EQ(samples.back().stamp, milliseconds(80));
}

TEST(SimPose, NoiseAndDriftHaveTheStatedSize) {
  SimulatorConfig config = on_stand();
  config.tracking.position_noise_m = 0.002;
  config.tracking.attitude_noise_rad = 0.003;
  Rig rig({}, config, 1, tracked());
  double position = 0;
  double angle = 0;
  const std::vector<hal::PoseSample> samples = collect(rig, 4.0);
  for (const hal::PoseSample& sample : samples) {
    position += vector(sample.p_ST_m).squaredNorm() / 3;
    angle +=
        std::pow(quaternion(sample.q_ST_wxyz).angularDistance(Eigen::Quaterniond::Identity()), 2) /
        3;
  }
  const auto count = static_cast<double>(samples.size());
  EXPECT_NEAR(std::sqrt(position / count), 0.002, 0.0002);
  EXPECT_NEAR(std::sqrt(angle / count), 0.003, 0.0003);

  config.tracking = {};
  config.tracking.position_walk_m_rts = 0.01;
  config.tracking.yaw_walk_rad_rts = 0.02;
  position = 0;
  angle = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Rig walking({}, config, seed, tracked());
    const hal::PoseSample last = collect(walking, 0.5).back();
    position += vector(last.p_ST_m).squaredNorm() / 120;
    angle +=
        std::pow(quaternion(last.q_ST_wxyz).angularDistance(Eigen::Quaterniond::Identity()), 2) /
        40;
  }
  EXPECT_NEAR(std::sqrt(position), 0.01 * std::sqrt(0.5), 0.0015);
  EXPECT_NEAR(std::sqrt(angle), 0.02 * std::sqrt(0.5), 0.004);
}

TEST(SimPose, JumpsAsOftenAsStated) {
  SimulatorConfig config = on_stand();
  config.tracking.jump_interval_s = 0.1;
  config.tracking.jump_m = 0.1;
  Rig rig({}, config, 1, tracked());
  const std::vector<hal::PoseSample> samples = collect(rig, 10.0);
  std::uint64_t seen = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if ((vector(samples[i].p_ST_m) - vector(samples[i - 1].p_ST_m)).norm() > 1e-3) ++seen;
  }
  EXPECT_EQ(rig.simulator->counters().pose_jumps, seen);
  EXPECT_NEAR(static_cast<double>(seen), 100, 30);
}

TEST(SimPose, AnOutageShowsAsAGapAndEndsWithLowConfidence) {
  SimulatorConfig config = on_stand();
  config.faults.pose_off_from_s = 0.2;
  config.faults.pose_off_until_s = 0.3;
  config.tracking.regain_s = 0.05;
  Rig rig({}, config, 1, tracked());
  const std::vector<hal::PoseSample> samples = collect(rig, 0.5);
  EXPECT_EQ(samples.size(), 80u);
  EXPECT_EQ(rig.simulator->counters().pose_samples_lost, 20u);
  EXPECT_EQ(rig.board.pose->counters().gaps, 20u);
  for (const hal::PoseSample& sample : samples) {
    const double t = sample.stamp.seconds();
    const bool low = t < 0.05 - 1e-9 || (t > 0.25 && t < 0.35 - 1e-9);
    EXPECT_EQ(sample.confidence, low ? 1 : 3) << t;
  }
}

TEST(SimPose, ARobotWithoutTheCameraHasNoPort) {
  Rig rig({}, on_stand());
  EXPECT_EQ(rig.board.pose, nullptr);
}

}  // namespace
}  // namespace surefoot::sim
