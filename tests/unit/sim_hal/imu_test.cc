#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim_hal/robot/articulation.h"
#include "tests/unit/sim_hal/sim_fixture.h"

namespace surefoot::sim {
namespace {

SimulatorConfig on_stand() {
  SimulatorConfig config;
  config.start.trunk_fixed = true;
  config.start.drop_height_m = 0.5;
  return config;
}

std::vector<hal::ImuSample> collect(Rig& rig, double seconds) {
  std::vector<hal::ImuSample> all;
  std::array<hal::ImuSample, 16> some;
  for (int i = 0; i < static_cast<int>(seconds * 500); ++i) {
    rig.tick();
    const std::size_t count = rig.board.imu->receive(some);
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return all;
}

struct Moments {
  double mean = 0;
  double sigma = 0;
};

template <class Get>
Moments moments(const std::vector<hal::ImuSample>& samples, Get get) {
  Moments m;
  for (const auto& sample : samples) m.mean += get(sample);
  m.mean /= static_cast<double>(samples.size());
  for (const auto& sample : samples) m.sigma += std::pow(get(sample) - m.mean, 2);
  m.sigma = std::sqrt(m.sigma / static_cast<double>(samples.size() - 1));
  return m;
}

TEST(SimImu, AtRestReadsGravityInItsOwnAxes) {
  robot::RobotModel model = mini_cheetah();
  model.imu.mount.roll_pitch_yaw_rad = {0.2, -0.3, 0.5};
  Rig rig({}, on_stand(), 1, model);
  collect(rig, 3.0);  // the legs come to rest
  const std::vector<hal::ImuSample> samples = collect(rig, 0.2);
  ASSERT_EQ(samples.size(), 200u);
  const Vector3 expected = mount_rotation(model.imu.mount).transpose() * Vector3(0, 0, 9.81);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto force =
        moments(samples, [&](const auto& s) { return s.specific_force_I_m_s2[axis]; });
    EXPECT_NEAR(force.mean, expected[static_cast<Eigen::Index>(axis)], 0.01);
    const auto rate =
        moments(samples, [&](const auto& s) { return s.angular_velocity_I_rad_s[axis]; });
    EXPECT_NEAR(rate.mean, 0, 0.001);
  }
  for (std::size_t i = 1; i < samples.size(); ++i) {
    EXPECT_EQ(samples[i].stamp - samples[i - 1].stamp, milliseconds(1));
    EXPECT_EQ(samples[i].sequence, samples[i - 1].sequence + 1);
  }
}

TEST(SimImu, FreeFallReadsZero) {
  SimulatorConfig config;
  config.start.drop_height_m = 2.0;
  config.start.leg_rad = {0, 0, 0};
  Rig rig({}, config);
  for (const auto& sample : collect(rig, 0.1)) {
    for (const double f : sample.specific_force_I_m_s2) EXPECT_NEAR(f, 0, 1e-6);
  }
}

TEST(SimImu, NoiseHasTheStatedDensity) {
  SimulatorConfig config = on_stand();
  config.start.leg_rad = {0, 0, 0};
  config.imu.gyro_noise_rad_s_rtHz = 0.001;
  config.imu.accelerometer_noise_m_s2_rtHz = 0.01;
  Rig rig({}, config);
  const std::vector<hal::ImuSample> samples = collect(rig, 4.0);
  const double root_rate = std::sqrt(1000.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto rate =
        moments(samples, [&](const auto& s) { return s.angular_velocity_I_rad_s[axis]; });
    EXPECT_NEAR(rate.sigma, 0.001 * root_rate, 0.05 * 0.001 * root_rate);
    EXPECT_NEAR(rate.mean, 0, 4 * 0.001 * root_rate / std::sqrt(4000.0));
    const auto force =
        moments(samples, [&](const auto& s) { return s.specific_force_I_m_s2[axis]; });
    EXPECT_NEAR(force.sigma, 0.01 * root_rate, 0.05 * 0.01 * root_rate);
  }
}

TEST(SimImu, BiasDiffersBySeedAndWalks) {
  SimulatorConfig config = on_stand();
  config.start.leg_rad = {0, 0, 0};
  config.imu.gyro_bias_rad_s = 0.02;
  double squares = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Rig rig({}, config, seed);
    const auto samples = collect(rig, 0.01);
    for (const double rate : samples.back().angular_velocity_I_rad_s) squares += rate * rate;
  }
  EXPECT_NEAR(std::sqrt(squares / 120), 0.02, 0.005);

  config.imu = {};
  config.imu.gyro_bias_walk_rad_s2_rtHz = 0.01;
  squares = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Rig rig({}, config, seed);
    const auto samples = collect(rig, 0.25);
    for (const double rate : samples.back().angular_velocity_I_rad_s) squares += rate * rate;
  }
  EXPECT_NEAR(std::sqrt(squares / 120), 0.01 * std::sqrt(0.25), 0.0015);
}

TEST(SimImu, AnOutageShowsAsAGap) {
  SimulatorConfig config = on_stand();
  config.faults.imu_off_from_s = 0.1;
  config.faults.imu_off_until_s = 0.15;
  Rig rig({}, config);
  const auto samples = collect(rig, 0.3);
  EXPECT_EQ(samples.size(), 250u);
  EXPECT_EQ(rig.simulator->counters().imu_samples_lost, 50u);
  EXPECT_EQ(rig.board.imu->counters().gaps, 50u);
}

TEST(SimImu, AFullQueueDropsTheOldestAndCounts) {
  Rig rig({}, on_stand());
  for (int i = 0; i < 50; ++i) rig.tick();
  EXPECT_EQ(rig.board.imu->counters().dropped, 100u - 64u);
  std::array<hal::ImuSample, 100> samples;
  ASSERT_EQ(rig.board.imu->receive(samples), 64u);
  EXPECT_EQ(samples[63].stamp, milliseconds(100));
}

}  // namespace
}  // namespace surefoot::sim
