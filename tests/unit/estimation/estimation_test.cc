// The estimators against synthetic motion with an analytic truth.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "core/estimation/attitude.h"
#include "core/estimation/body_state.h"

namespace surefoot::estimation {
namespace {

AttitudeConfig attitude_config() {
  AttitudeConfig config;
  config.correction_gain_1_s = 0.2;
  config.bias_gain_1_s2 = 0.01;
  config.max_gravity_error_m_s2 = 3.0;
  config.still_correction_gain_1_s = 5.0;
  config.still_bias_gain_1_s = 2.0;
  return config;
}

hal::ImuSample sample_at(int i, const Vector3& gyro, const Vector3& force) {
  hal::ImuSample sample;
  sample.stamp = milliseconds(i);
  sample.sequence = static_cast<std::uint32_t>(i);
  for (std::size_t k = 0; k < 3; ++k) {
    sample.angular_velocity_I_rad_s[k] = gyro[static_cast<Eigen::Index>(k)];
    sample.specific_force_I_m_s2[k] = force[static_cast<Eigen::Index>(k)];
  }
  return sample;
}

// Feeds samples at rest until the attitude has started; the next sample's index.
int start(AttitudeEstimator& estimator, const Vector3& up_I) {
  int i = 1;
  for (; !estimator.initialised(); ++i) {
    EXPECT_EQ(estimator.update(sample_at(i, Vector3::Zero(), up_I), false), Status::kOk);
  }
  return i;
}

TEST(Attitude, StartsFromRestAndNotFromABump) {
  AttitudeEstimator estimator;
  estimator.reset(attitude_config(), robot::ImuSpecification{});
  const Matrix3 R = geometry::from_roll_pitch_yaw(0.3, -0.2, 0.0);
  ASSERT_EQ(estimator.update(sample_at(1, Vector3::Zero(), Vector3(25, 3, 1)), false), Status::kOk);
  EXPECT_FALSE(estimator.initialised());
  for (int i = 2; i <= 51; ++i) {
    ASSERT_EQ(
        estimator.update(sample_at(i, Vector3::Zero(), R.transpose() * Vector3(0, 0, 9.81)), false),
        Status::kOk);
  }
  EXPECT_TRUE(estimator.initialised());
  EXPECT_LT((estimator.R_OB() - R).norm(), 1e-12);
}

TEST(Attitude, IntegratesAConstantTurnAndIgnoresTheMountRotation) {
  robot::ImuSpecification imu;
  imu.mount.roll_pitch_yaw_rad = {0.1, -0.4, 1.2};
  const Matrix3 R_BI = geometry::from_roll_pitch_yaw(0.1, -0.4, 1.2);
  AttitudeEstimator estimator;
  estimator.reset(attitude_config(), imu);
  const Vector3 omega_B(0.0, 0.0, 0.5);
  const int first = start(estimator, R_BI.transpose() * Vector3(0, 0, 9.81));
  for (int i = first; i < first + 2000; ++i) {
    ASSERT_EQ(estimator.update(
                  sample_at(i, R_BI.transpose() * omega_B, R_BI.transpose() * Vector3(0, 0, 9.81)),
                  false),
              Status::kOk);
  }
  const Vector3 rpy = geometry::to_roll_pitch_yaw(estimator.R_OB());
  EXPECT_NEAR(rpy[0], 0.0, 1e-9);
  EXPECT_NEAR(rpy[1], 0.0, 1e-9);
  EXPECT_NEAR(rpy[2], 1.0, 1e-9);
}

TEST(Attitude, LearnsTheGyroBiasWhileStandingStill) {
  AttitudeEstimator estimator;
  estimator.reset(attitude_config(), robot::ImuSpecification{});
  const Vector3 bias(0.01, -0.02, 0.015);
  Random random(3);
  for (int i = 1; i <= 3000; ++i) {
    Vector3 noise;
    for (int k = 0; k < 3; ++k) noise[k] = 0.005 * random.normal();
    ASSERT_EQ(estimator.update(sample_at(i, bias + noise, Vector3(0, 0, 9.81)), true), Status::kOk);
  }
  EXPECT_LT((estimator.gyro_bias_B_rad_s() - bias).norm(), 1e-3);
}

TEST(Attitude, AWrongTiltIsPulledBackByGravity) {
  AttitudeEstimator estimator;
  estimator.reset(attitude_config(), robot::ImuSpecification{});
  const Matrix3 wrong = geometry::from_roll_pitch_yaw(0.1, 0.1, 0.0);
  const int first = start(estimator, wrong.transpose() * Vector3(0, 0, 9.81));
  for (int i = first; i <= 60000; ++i) {
    ASSERT_EQ(estimator.update(sample_at(i, Vector3::Zero(), Vector3(0, 0, 9.81)), false),
              Status::kOk);
  }
  const Vector3 rpy = geometry::to_roll_pitch_yaw(estimator.R_OB());
  EXPECT_NEAR(rpy[0], 0.0, 0.01);
  EXPECT_NEAR(rpy[1], 0.0, 0.01);
}

TEST(Attitude, RefusesWhatIsNotFiniteOrOutOfOrderAndStaysUnchanged) {
  AttitudeEstimator estimator;
  estimator.reset(attitude_config(), robot::ImuSpecification{});
  ASSERT_EQ(estimator.update(sample_at(5, Vector3::Zero(), Vector3(0, 0, 9.81)), false),
            Status::kOk);
  const Matrix3 before = estimator.R_OB();
  EXPECT_EQ(estimator.update(sample_at(6, Vector3(NAN, 0, 0), Vector3(0, 0, 9.81)), false),
            Status::kInvalid);
  EXPECT_EQ(estimator.update(sample_at(6, Vector3(1, 0, 0), Vector3(0, INFINITY, 9.81)), false),
            Status::kInvalid);
  EXPECT_EQ(estimator.update(sample_at(5, Vector3(1, 0, 0), Vector3(0, 0, 9.81)), false),
            Status::kInvalid);
  EXPECT_EQ((estimator.R_OB() - before).norm(), 0.0);
  EXPECT_EQ(estimator.stamp(), milliseconds(5));
}

BodyStateConfig body_config() {
  BodyStateConfig config;
  config.accelerometer_noise_m_s2_sqrtHz = 0.1;
  config.foot_position_noise_m = 0.002;
  config.foot_velocity_noise_m_s = 0.1;
  config.foot_slip_noise_m_sqrt_s = 0.005;
  config.slip_gate_sigma = 4.0;
  return config;
}

// A trot over ground of random height, exact legs: the estimate follows position, and no height is
// assumed (steps of +-5 cm under every foot).
TEST(BodyState, FollowsATrotOverUnevenGround) {
  BodyStateEstimator estimator;
  estimator.reset(body_config());
  estimator.initialise(Vector3(0, 0, 0.29));
  Random random(5);
  std::array<Vector3, 4> feet;
  Vector3 p(0, 0, 0.29);
  const Vector3 v(0.4, 0.05, 0.0);
  for (std::size_t leg = 0; leg < 4; ++leg) {
    feet[leg] = Vector3(robot::front_sign(leg) * 0.19, robot::left_sign(leg) * 0.115, 0.0);
  }
  constexpr double kStep_s = 0.002;
  Vector3 velocity = Vector3::Zero();
  for (int tick = 0; tick < 5000; ++tick) {
    const Vector3 target = tick < 500 ? Vector3(Vector3::Zero()) : v;
    const Vector3 acceleration = (target - velocity) * 2.0;
    p += velocity * kStep_s + acceleration * (0.5 * kStep_s * kStep_s);
    velocity += acceleration * kStep_s;
    std::array<FootObservation, 4> observations;
    for (std::size_t leg = 0; leg < 4; ++leg) {
      const bool diagonal = leg == 0 || leg == 3;
      const int phase = (tick + (diagonal ? 0 : 100)) % 200;
      const bool stance = tick < 500 || phase < 120;
      if (phase == 160 && tick >= 500) {
        const double height = random.uniform(-0.05, 0.05);
        feet[leg] = p + Vector3(robot::front_sign(leg) * 0.19 + 0.06, robot::left_sign(leg) * 0.115,
                                height - p[2]);
      }
      observations[leg].in_contact = stance;
      Vector3 noise;
      for (int k = 0; k < 3; ++k) noise[k] = 0.001 * random.normal();
      observations[leg].from_body_O_m = feet[leg] - p + noise;
      observations[leg].velocity_from_body_O_m_s = -velocity;
    }
    Vector3 noise;
    for (int k = 0; k < 3; ++k) noise[k] = 0.2 * random.normal();
    estimator.update(acceleration + noise, observations, kStep_s);
  }
  EXPECT_LT((estimator.p_OB_m() - p).norm(), 0.02 * p.head<2>().norm());
  EXPECT_LT((estimator.v_OB_m_s() - velocity).norm(), 0.02);
}

// The rolling term: the foot's centre moves over a fixed contact, and without the term the estimate
// would lose that way.
TEST(BodyState, ARollingFootIsNotTakenForMotionOfTheGround) {
  BodyStateEstimator estimator;
  estimator.reset(body_config());
  estimator.initialise(Vector3(0, 0, 0.3));
  const Vector3 rolling(0.02, 0.0, 0.0);  // all feet roll forward at 2 cm/s, the body with them
  Vector3 offset(0, 0, -0.3);
  for (int tick = 0; tick < 500; ++tick) {
    std::array<FootObservation, 4> observations;
    for (FootObservation& foot : observations) {
      foot.in_contact = true;
      foot.from_body_O_m = offset;
      foot.velocity_from_body_O_m_s = Vector3::Zero();
      foot.rolling_velocity_O_m_s = rolling;
    }
    estimator.update(Vector3::Zero(), observations, 0.002);
  }
  EXPECT_NEAR(estimator.v_OB_m_s()[0], 0.02, 1e-3);
  EXPECT_NEAR(estimator.p_OB_m()[0], 0.02, 2e-3);
}

}  // namespace
}  // namespace surefoot::estimation
