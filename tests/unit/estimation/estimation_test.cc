// The estimators against synthetic motion with an analytic truth.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/random.h"
#include "core/estimation/attitude.h"
#include "core/estimation/body_state.h"
#include "core/estimation/estimator.h"
#include "tests/support/mini_cheetah.h"

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

// Feet that stand still undo what a wrong "up" makes of gravity; the tilt decays with the gain.
TEST(Attitude, FeetThatStandLevelIt) {
  AttitudeConfig config = attitude_config();
  config.bias_gain_1_s2 = 0.0;
  AttitudeEstimator estimator;
  estimator.reset(config, robot::ImuSpecification{});
  const Matrix3 wrong = geometry::from_roll_pitch_yaw(0.02, -0.03, 0.0);
  const int first = start(estimator, wrong.transpose() * Vector3(0, 0, 9.81));
  estimator.set_yaw(0.8);
  const Vector3 force(0, 0, 9.81);  // level in truth
  for (int i = first; i < first + 10000; ++i) {
    ASSERT_EQ(estimator.update(sample_at(i, Vector3::Zero(), force), false, true), Status::kOk);
    estimator.level_by_feet((estimator.R_OB() * force - Vector3(0, 0, 9.81)) * -0.001);
  }
  const Vector3 rpy = geometry::to_roll_pitch_yaw(estimator.R_OB());
  EXPECT_NEAR(rpy[0], 0.02 * std::exp(-2.0), 2e-4);
  EXPECT_NEAR(rpy[1], -0.03 * std::exp(-2.0), 2e-4);
  EXPECT_NEAR(rpy[2], 0.8, 1e-3);
}

// A running trunk surges in step with its bouncing: the mean direction of the specific force is not
// up although the mean force is. Feet that follow the true motion have nothing to correct.
TEST(Attitude, LevelGroundTellsTheAccelerometersBias) {
  AttitudeEstimator estimator;
  estimator.reset(attitude_config(), robot::ImuSpecification{});
  const Vector3 bias(0.05, -0.04, 0.02);
  const Vector3 force = Vector3(0, 0, 9.81) + bias;
  int i = start(estimator, force);
  EXPECT_GT(std::acos(estimator.R_OB()(2, 2)), 0.005);  // it takes the bias for a tilt
  for (int end = i + 3000; i < end; ++i) {
    ASSERT_EQ(estimator.update(sample_at(i, Vector3::Zero(), force), false, true), Status::kOk);
    estimator.level(Vector3::UnitZ(), 0.004);
  }
  EXPECT_LT(std::acos(std::min(estimator.R_OB()(2, 2), 1.0)), 1e-4);
  EXPECT_LT((estimator.accelerometer_bias_B_m_s2() - bias).norm(), 1e-3);
  // From then on the measured "up" is up.
  for (int end = i + 20000; i < end; ++i) {
    ASSERT_EQ(estimator.update(sample_at(i, Vector3::Zero(), force), false), Status::kOk);
  }
  EXPECT_LT(std::acos(std::min(estimator.R_OB()(2, 2), 1.0)), 2e-4);
}

TEST(Attitude, ASurgeInStepWithABounceTiltsTheMeasuredUpButNotTheFeet) {
  const auto pitch_after = [](bool by_feet) {
    AttitudeEstimator estimator;
    estimator.reset(attitude_config(), robot::ImuSpecification{});
    const int first = start(estimator, Vector3(0, 0, 9.81));
    for (int i = first; i < first + 20000; ++i) {
      const double swing = std::sin(2.0 * 3.14159265358979 * 0.006666 * i);
      const Vector3 acceleration(1.0 * swing, 0.0, 6.0 * swing);
      const Vector3 force = acceleration + Vector3(0, 0, 9.81);  // the trunk stays level
      EXPECT_EQ(estimator.update(sample_at(i, Vector3::Zero(), force), false, by_feet),
                Status::kOk);
      const Vector3 measured = estimator.R_OB() * force - Vector3(0, 0, 9.81);
      if (by_feet) estimator.level_by_feet((acceleration - measured) * 0.001);
    }
    return geometry::to_roll_pitch_yaw(estimator.R_OB())[1];
  };
  EXPECT_GT(std::fabs(pitch_after(false)), 0.005);
  EXPECT_LT(std::fabs(pitch_after(true)), 1e-9);
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

// What the feet put right of a biased accelerometer adds up to what the bias did; a place that was
// only said to be at rest says nothing of it.
TEST(BodyState, TellsWhatTheFeetPutRight) {
  BodyStateEstimator estimator;
  estimator.reset(body_config());
  estimator.initialise(Vector3(0, 0, 0.3));
  std::array<FootObservation, 4> feet;
  for (FootObservation& foot : feet) {
    foot.in_contact = true;
    foot.from_body_O_m = Vector3(0, 0, -0.3);
  }
  const Vector3 bias(0.2, -0.1, 0.05);
  EXPECT_FALSE(estimator.carried());
  Vector3 sum = Vector3::Zero();
  for (int tick = 0; tick < 2000; ++tick) {
    estimator.update(bias, feet, 0.002);
    EXPECT_TRUE(estimator.carried());
    sum += estimator.correction_O_m_s();
  }
  EXPECT_LT((sum + bias * 4.0).norm(), 0.02 * bias.norm() * 4.0);

  for (FootObservation& foot : feet) foot.velocity_from_body_O_m_s = Vector3(0.1, 0, 0);
  for (int tick = 0; tick < 10; ++tick) {
    estimator.initialise(Vector3(0, 0, 0.3));
    EXPECT_FALSE(estimator.carried());
    estimator.update(bias, feet, 0.002);
    EXPECT_EQ(estimator.correction_O_m_s().norm(), 0.0);
  }
  for (FootObservation& foot : feet) foot.in_contact = false;
  estimator.update(bias, feet, 0.002);
  EXPECT_FALSE(estimator.carried());
  EXPECT_EQ(estimator.correction_O_m_s().norm(), 0.0);
}

// The heading is declared, the tilt stays, and from there on the gyro turns it.
TEST(Estimator, CarriesTheBodyByAnothersLegOdometry) {
  EstimationConfig config;
  config.attitude = attitude_config();
  Estimator estimator;
  estimator.reset(config, robot::RobotModel{}, 0.002);
  int i = 1;
  for (; !estimator.ready(); ++i) {
    const hal::ImuSample imu = sample_at(i, Vector3::Zero(), Vector3(0, 0, 9.81));
    EXPECT_EQ(
        estimator.update(milliseconds(i), {&imu, 1}, std::span<const hal::GaitSample>{}, false),
        0u);
  }
  EXPECT_EQ(estimator.gait(), nullptr);
  estimator.set_yaw(1.5707963267948966);
  estimator.place(Vector3(0, 0, 0.3));
  hal::GaitSample gait;
  gait.velocity_B_m_s = {0.5, 0.0, 0.0};
  for (int k = 0; k <= 1000; ++k, ++i) {
    gait.stamp = milliseconds(2 * k);
    const hal::ImuSample imu = sample_at(i, Vector3::Zero(), Vector3(0, 0, 9.81));
    EXPECT_EQ(estimator.update(milliseconds(i), {&imu, 1}, {&gait, 1}, false), 0u);
  }
  EXPECT_NEAR(estimator.state().p_OB_m[0], 0.0, 1e-6);
  EXPECT_NEAR(estimator.state().p_OB_m[1], 1.0, 1e-6);
  EXPECT_NEAR(estimator.state().v_OB_m_s[1], 0.5, 1e-9);
  ASSERT_NE(estimator.gait(), nullptr);
  // Not newer, and not finite: refused, nothing moves.
  const Vector3 before = estimator.state().p_OB_m;
  EXPECT_EQ(estimator.update(milliseconds(i), {}, {&gait, 1}, false), 1u);
  gait.stamp = gait.stamp + milliseconds(2);
  gait.velocity_B_m_s[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(estimator.update(milliseconds(i), {}, {&gait, 1}, false), 1u);
  EXPECT_EQ((estimator.state().p_OB_m - before).norm(), 0.0);
}

TEST(Estimator, SetYawTurnsTheHeadingAndKeepsTheTilt) {
  EstimationConfig config;
  config.attitude = attitude_config();
  config.attitude.correction_gain_1_s = 0.0;
  config.attitude.bias_gain_1_s2 = 0.0;
  config.body = body_config();
  config.contact.observer_gain_1_s = 200.0;
  config.contact.touchdown_force_N = 1e6;
  config.contact.surprise_force_N = 1e6;
  Estimator estimator;
  estimator.reset(config, robot::full_mini_cheetah(), 0.002);
  const Matrix3 R = geometry::from_roll_pitch_yaw(0.1, -0.2, 0.0);
  const Vector3 force = R.transpose() * Vector3(0, 0, 9.81);
  std::array<actuation::JointState, robot::kJoints> joints;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    constexpr double kStanding_rad[3] = {0.0, -0.8, 1.6};
    joints[i].position_rad = kStanding_rad[i % robot::kJointsPerLeg];
    joints[i].valid = true;
  }
  const Vector3 rate_B = R.transpose() * Vector3(0, 0, 0.5);
  int sample = 0;
  const auto run = [&](int ticks, const Vector3& gyro) {
    for (int tick = 0; tick < ticks; ++tick) {
      ++sample;
      const hal::ImuSample imu = sample_at(2 * sample, gyro, force);
      ASSERT_EQ(estimator.update(imu.stamp, {&imu, 1}, joints, {}, false), 0u);
    }
  };
  run(60, Vector3::Zero());
  ASSERT_TRUE(estimator.ready());
  estimator.set_yaw(2.5);
  EXPECT_NEAR(estimator.state().yaw_rad, 2.5, 1e-12);
  const Matrix3 expected = geometry::from_roll_pitch_yaw(0.1, -0.2, 2.5);
  EXPECT_LT((estimator.state().R_OB - expected).norm(), 1e-9);
  EXPECT_LT((geometry::to_matrix(estimator.state().q_OB) - expected).norm(), 1e-9);
  // A declared place takes the feet along.
  estimator.place(Vector3(5, -3, 1));
  for (const FootState& foot : estimator.state().feet) {
    EXPECT_LT((foot.p_O_m - Vector3(5, -3, 1) - expected * foot.p_B_m).norm(), 1e-9);
  }
  run(500, rate_B);  // half a radian in a second, beyond pi
  EXPECT_NEAR(estimator.state().yaw_rad, 3.0, 1e-6);
  run(500, rate_B);
  EXPECT_NEAR(estimator.state().yaw_rad, 3.5 - 2.0 * 3.14159265358979324, 1e-6);
}

}  // namespace
}  // namespace surefoot::estimation
