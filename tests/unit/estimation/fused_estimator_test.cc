// The Estimator with a stereo camera as an odometer: legs that are off and a gyro that turns by
// itself, put right by motions of the camera.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/estimation/estimator.h"
#include "core/geometry/rotations.h"
#include "tests/support/odometry_fusion_setup.h"

namespace surefoot::estimation {
namespace {

constexpr double kTick_s = 0.002;
constexpr TimeNs kTick = milliseconds(2);
constexpr double kSpeed_m_s = 0.5;
constexpr double kTurn_rad_s = 0.05;
constexpr double kGyroBias_rad_s = 0.001;
constexpr double kLegScale = 1.03;
constexpr int kTicksPerPicture = 100;
constexpr int kLatencyTicks = 75;
constexpr int kPicturesPerKeyframe = 3;

EstimationConfig config() {
  EstimationConfig config;
  config.attitude.max_gravity_error_m_s2 = 3.0;
  return config;
}

struct Place {
  Matrix3 R = Matrix3::Identity();
  Vector3 p_m = Vector3::Zero();
};

// A body that walks in a circle, and its sensors.
class Walk {
 public:
  explicit Walk(bool camera) {
    estimator_.reset(config(), robot::RobotModel{}, kTick_s);
    R_BN_ = geometry::from_roll_pitch_yaw(-2.2, 0.0, -1.5707963267948966);
    if (camera) {
      EXPECT_EQ(estimator_.fuse_camera(tests::recommended_fusion(), R_BN_, p_BN_m_), Status::kOk);
    }
    while (!estimator_.ready()) tick(0.0, 0.0);
    estimator_.set_yaw(0.0);
    estimator_.place(Vector3::Zero());
    truth_ = Place{};
  }

  void run(double duration_s) {
    const auto ticks = static_cast<int>(duration_s / kTick_s);
    for (int i = 0; i < ticks; ++i) {
      if (i % kTicksPerPicture == kLatencyTicks) observe();
      tick(kSpeed_m_s, kTurn_rad_s);
      if (i % kTicksPerPicture == 0) expose();
    }
  }

  double error_m() const { return (estimator_.state().p_OB_m - truth_.p_m).norm(); }
  double yaw_error_rad() const {
    return geometry::to_rotation_vector(estimator_.state().R_OB * truth_.R.transpose())[2];
  }
  Estimator& estimator() { return estimator_; }
  DriftCorrection last_correction() const { return correction_; }
  Vector3 before_correction_O_m() const { return before_O_m_; }

 private:
  void tick(double speed_m_s, double turn_rad_s) {
    stamp_ = stamp_ + kTick;
    truth_.R = geometry::rotation_z(turn_rad_s * kTick_s) * truth_.R;
    truth_.p_m += truth_.R * Vector3(speed_m_s * kTick_s, 0, 0);
    hal::ImuSample imu;
    imu.stamp = stamp_;
    imu.angular_velocity_I_rad_s = {0, 0, turn_rad_s + (speed_m_s > 0 ? kGyroBias_rad_s : 0.0)};
    imu.specific_force_I_m_s2 = {0, 0, kGravity_m_s2};
    hal::GaitSample gait;
    gait.stamp = stamp_;
    gait.velocity_B_m_s = {kLegScale * speed_m_s, 0, 0};
    EXPECT_EQ(estimator_.update(stamp_, {&imu, 1}, {&gait, 1}, false), 0U);
  }

  Place camera() const { return {truth_.R * R_BN_, truth_.p_m + truth_.R * p_BN_m_}; }

  void expose() {
    exposed_ = camera();
    exposed_at_ = stamp_;
    estimator_.note_exposure(stamp_);
  }

  void observe() {
    VisualMotion motion;
    motion.valid = pictures_ > 0;
    motion.from = keyframe_at_;
    motion.to = exposed_at_;
    motion.R_KN = keyframe_.R.transpose() * exposed_.R;
    motion.p_KN_m = keyframe_.R.transpose() * (exposed_.p_m - keyframe_.p_m);
    motion.covariance.diagonal() << 1e-6, 1e-6, 1e-6, 1e-8, 1e-8, 1e-8;
    motion.new_keyframe = pictures_ % kPicturesPerKeyframe == 0;
    before_O_m_ = estimator_.state().p_OB_m;
    correction_ = estimator_.observe_motion(motion);
    ++pictures_;
    if (!motion.new_keyframe) return;
    keyframe_ = exposed_;
    keyframe_at_ = exposed_at_;
  }

  Estimator estimator_;
  Matrix3 R_BN_;
  Vector3 p_BN_m_{0.5, 0.06, 0.1};
  TimeNs stamp_;
  Place truth_;
  Place exposed_;
  TimeNs exposed_at_;
  Place keyframe_;
  TimeNs keyframe_at_;
  int pictures_ = 0;
  DriftCorrection correction_;
  Vector3 before_O_m_ = Vector3::Zero();
};

TEST(FusedEstimator, TheCameraPutsLegsAndGyroRight) {
  Walk blind(false);
  blind.run(100);
  EXPECT_GT(blind.error_m(), 0.8);
  EXPECT_NEAR(blind.yaw_error_rad(), 100 * kGyroBias_rad_s, 1e-3);
  Walk walk(true);
  walk.run(100);
  EXPECT_LT(walk.error_m(), 0.05);
  EXPECT_NEAR(walk.yaw_error_rad(), 0.0, 2e-3);
  const FusionCounters& counters = walk.estimator().fusion().counters();
  EXPECT_EQ(counters.used, 499U);
  EXPECT_EQ(counters.outliers + counters.unmatched + counters.refused, 0U);
}

// What was corrected is in the very state that the next tick starts from, and told to whoever keeps
// poses.
TEST(FusedEstimator, ACorrectionIsPartOfTheStateAtOnce) {
  Walk walk(true);
  walk.run(20 + (kLatencyTicks + 1) * kTick_s);
  const Vector3 moved_m = walk.estimator().state().p_OB_m - walk.before_correction_O_m();
  const Vector3 step_m = walk.estimator().state().v_OB_m_s * kTick_s;
  EXPECT_GT(walk.last_correction().shift_O_m.norm(), 1e-5);
  EXPECT_LT((moved_m - step_m - walk.last_correction().shift_O_m).norm(), 1e-4);
}

// The declared pose is exact, whatever the fusion had found out.
TEST(FusedEstimator, PlaceAndHeadingAreDeclared) {
  Walk walk(true);
  walk.run(10);
  walk.estimator().set_yaw(0.7);
  walk.estimator().place(Vector3(1, 2, 3));
  const RobotState& state = walk.estimator().state();
  EXPECT_EQ((state.p_OB_m - Vector3(1, 2, 3)).norm(), 0.0);
  EXPECT_NEAR(state.yaw_rad, 0.7, 1e-12);
  hal::ImuSample imu;
  imu.stamp = state.stamp + kTick;
  imu.specific_force_I_m_s2 = {0, 0, kGravity_m_s2};
  EXPECT_EQ(
      walk.estimator().update(imu.stamp, {&imu, 1}, std::span<const hal::GaitSample>{}, false), 0U);
  EXPECT_NEAR(state.yaw_rad, 0.7, 1e-5);
  EXPECT_LT((state.p_OB_m - Vector3(1, 2, 3)).norm(), 0.002);
}

TEST(FusedEstimator, WithoutAConfigurationTheCameraChangesNothing) {
  Walk walk(false);
  walk.run(10);
  const Vector3 before = walk.estimator().state().p_OB_m;
  VisualMotion motion;
  motion.valid = true;
  EXPECT_EQ(walk.estimator().observe_motion(motion).shift_O_m.norm(), 0.0);
  EXPECT_EQ((walk.estimator().state().p_OB_m - before).norm(), 0.0);
  EXPECT_EQ(walk.estimator().fusion().counters().unmatched, 0U);
  EXPECT_EQ(walk.estimator().fuse_camera({}, Matrix3::Identity(), Vector3::Zero()),
            Status::kInvalid);
}

}  // namespace
}  // namespace surefoot::estimation
