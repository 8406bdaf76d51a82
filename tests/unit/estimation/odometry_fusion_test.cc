// Fusion of the legs' and the camera's odometry over 200 m: drift, consistency, dropouts.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "core/base/random.h"
#include "core/estimation/odometry_fusion.h"
#include "core/geometry/rotations.h"
#include "core/math/elementary.h"
#include "tests/support/odometry_fusion_setup.h"
#include "tests/support/samples.h"

namespace surefoot::estimation {
namespace {

constexpr double kTick_s = 0.01;
constexpr int kTicksPerPicture = 8;
constexpr int kLatencyTicks = 6;
constexpr std::uint64_t kSeeds = tests::samples(24, 2);

struct WorldOptions {
  std::uint64_t seed = 1;
  double speed_m_s = 0.5;
  double way_m = 200;
  bool legs = true;
  bool camera = true;
  double camera_off_from_s = -1;  // for 30 s
  double leg_scale = 0;           // a share of the speed that is not in the model
  bool slips_seen = true;         // the legs say that they slip
  double blur = 0;                // the camera's sigma grows by this over (speed / 1 m/s)^2
};

// A robot that walks in slow curves, its IMU, its legs and its camera, with the errors that the
// filter is told about.
class World {
 public:
  explicit World(const WorldOptions& options)
      : options_(options), config_(tests::recommended_fusion()), random_(options.seed, 3) {
    R_BN_ << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    R_BN_ = geometry::from_roll_pitch_yaw(0, 0.5, 0) * R_BN_;
    EXPECT_EQ(fusion_.configure(config_, R_BN_, p_BN_m_), Status::kOk);
    rate_error_rad_s_ = config_.gyro_bias_rad_s * random_.normal();
    for (int i = 0; i < 2; ++i) tilt_rad_[i] = config_.tilt_rad * random_.normal();
    R_ = attitude();
  }

  void run() {
    const int ticks = static_cast<int>(options_.way_m / options_.speed_m_s / kTick_s);
    for (int tick = 0; tick < ticks; ++tick) step(tick);
  }

  double way_m() const { return way_m_; }
  Vector3 error_m() const { return fusion_.p_OB_m() - p_m_; }
  double drift() const { return error_m().norm() / way_m_; }
  double nees() const {
    Eigen::Matrix<double, 4, 1> error;
    const Matrix3 off = fusion_.R_OB() * R_.transpose();
    error << error_m(), geometry::to_rotation_vector(off).z();
    return error.dot(Eigen::LDLT<Eigen::Matrix4d>(fusion_.pose_covariance()).solve(error));
  }
  const OdometryFusion& fusion() const { return fusion_; }

 private:
  struct Exposed {
    TimeNs stamp;
    Matrix3 R = Matrix3::Identity();
    Vector3 p_m = Vector3::Zero();
  };

  Vector3 normals(double sigma) {
    Vector3 v;
    for (int i = 0; i < 3; ++i) v[i] = sigma * random_.normal();
    return v;
  }

  Matrix3 attitude() const {
    const double phase = 15.7 * time_s_;
    return geometry::from_roll_pitch_yaw(0.03 * std::sin(0.5 * phase), 0.02 * std::sin(phase),
                                         yaw_rad_);
  }

  void step(int tick) {
    time_s_ = tick * kTick_s;
    const double speed = options_.speed_m_s;
    yaw_rad_ += kTick_s * 0.25 * std::sin(2 * math::kPi * time_s_ / 60);
    R_ = attitude();
    const Vector3 v_O(speed * std::cos(yaw_rad_), speed * std::sin(yaw_rad_),
                      0.05 * std::cos(15.7 * time_s_));
    p_m_ += v_O * kTick_s;
    way_m_ += speed * kTick_s;
    imu_and_legs(v_O);
    if (tick % kTicksPerPicture == 0) expose();
    if (tick % kTicksPerPicture == kLatencyTicks) deliver();
  }

  void imu_and_legs(const Vector3& v_O) {
    rate_error_rad_s_ += config_.gyro_drift_rad_s_sqrt_s * std::sqrt(kTick_s) * random_.normal();
    yaw_error_rad_ += rate_error_rad_s_ * kTick_s +
                      config_.gyro_noise_rad_sqrt_s * std::sqrt(kTick_s) * random_.normal();
    const double keep_tilt = 1 / (1 + kTick_s / config_.tilt_memory_s);
    for (int i = 0; i < 2; ++i) {
      tilt_rad_[i] = keep_tilt * tilt_rad_[i] +
                     config_.tilt_rad * std::sqrt(1 - keep_tilt * keep_tilt) * random_.normal();
    }
    const Matrix3 wrong =
        geometry::rotation_z(-yaw_error_rad_) * geometry::to_matrix(geometry::from_rotation_vector(
                                                    Vector3(-tilt_rad_[0], -tilt_rad_[1], 0)));
    if (slip_ticks_ == 0 && random_.uniform() < kTick_s / 5) slip_ticks_ = 25;
    const double slip = slip_ticks_ > 0 ? 0.5 : 0.0;
    slip_ticks_ = std::max(0, slip_ticks_ - 1);
    const double keep = 1 / (1 + kTick_s / config_.leg_memory_s);
    const double speed = options_.speed_m_s;
    for (int i = 0; i < 3; ++i) {
      const double factor = i == 2 ? config_.leg_vertical_factor : 1;
      const double steady = factor * (config_.leg_error_m_s + config_.leg_error_share * speed);
      const double sigma = std::hypot(steady, slip * config_.leg_slip_m_s);
      leg_error_[i] = keep * leg_error_[i] + sigma * std::sqrt(1 - keep * keep) * random_.normal();
    }
    LegOdometry legs;
    legs.valid = options_.legs;
    legs.v_B_m_s = (1 + options_.leg_scale) * (R_.transpose() * v_O) + leg_error_ +
                   normals(config_.leg_noise_m_sqrt_s / std::sqrt(kTick_s));
    legs.slip = options_.slips_seen ? slip : 0;
    EXPECT_EQ(fusion_.update(wrong * R_, legs, kTick_s), Status::kOk);
  }

  void expose() {
    now_ = {TimeNs{static_cast<std::int64_t>(1e9 * time_s_) + 1}, R_, p_m_};
    fusion_.note_exposure(now_.stamp);
  }

  bool camera_sees() const {
    const double since = time_s_ - options_.camera_off_from_s;
    const bool off = options_.camera_off_from_s >= 0 && since >= 0 && since < 30;
    return options_.camera && !off;
  }

  // Motions fail at times; the keyframe stays for a quarter of a metre or a fifth of a radian.
  void deliver() {
    if (!camera_sees()) {
      has_key_ = false;
      return;
    }
    VisualMotion motion;
    motion.to = now_.stamp;
    if (!has_key_) {
      motion.new_keyframe = true;
    } else if (random_.uniform() > 0.05) {
      motion = measure();
    }
    static_cast<void>(fusion_.observe(motion));
    if (!motion.new_keyframe) return;
    has_key_ = true;
    key_ = now_;
    for (int i = 0; i < 6; ++i) common_[i] = random_.normal();
  }

  VisualMotion measure() {
    VisualMotion motion;
    motion.valid = true;
    motion.from = key_.stamp;
    motion.to = now_.stamp;
    const Matrix3 R_KO = (key_.R * R_BN_).transpose();
    const Vector3 way = now_.p_m + now_.R * p_BN_m_ - key_.p_m - key_.R * p_BN_m_;
    motion.R_KN = R_KO * now_.R * R_BN_;
    motion.p_KN_m = R_KO * way;
    const double blur = 1 + options_.blur * math::square(options_.speed_m_s);
    const double sigma_m = blur * (0.0005 + 0.004 * way.norm());
    const double sigma_rad = blur * (0.0003 + 0.001 * way.norm());
    Matrix6 root = Matrix6::Zero();
    for (int i = 0; i < 3; ++i) root(i, i) = sigma_m;
    for (int i = 3; i < 6; ++i) root(i, i) = sigma_rad;
    root(3, 1) = 0.5 * sigma_rad;  // a turn looks like a step aside
    root(4, 0) = -0.5 * sigma_rad;
    motion.covariance = root * root.transpose();
    Vector6 own;
    for (int i = 0; i < 6; ++i) own[i] = random_.normal();
    const double share = config_.common_share;
    const Vector6 error = root * (std::sqrt(share) * common_ + std::sqrt(1 - share) * own);
    motion.p_KN_m += error.head<3>();
    motion.R_KN =
        geometry::to_matrix(geometry::from_rotation_vector(error.tail<3>())) * motion.R_KN;
    const double turn = geometry::to_rotation_vector(motion.R_KN).norm();
    motion.new_keyframe = way.norm() > 0.25 || turn > 0.2;
    return motion;
  }

  WorldOptions options_;
  FusionConfig config_;
  Random random_;
  OdometryFusion fusion_;
  Matrix3 R_BN_ = Matrix3::Identity();
  Vector3 p_BN_m_ = Vector3(0.3, 0, 0.1);
  double time_s_ = 0;
  double yaw_rad_ = 0;
  Vector3 p_m_ = Vector3::Zero();
  Matrix3 R_ = Matrix3::Identity();
  double way_m_ = 0;
  double yaw_error_rad_ = 0;
  double rate_error_rad_s_ = 0;
  Vector2 tilt_rad_ = Vector2::Zero();
  Vector3 leg_error_ = Vector3::Zero();
  int slip_ticks_ = 0;
  bool has_key_ = false;
  Exposed key_;
  Exposed now_;
  Vector6 common_ = Vector6::Zero();
};

struct Drifts {
  std::vector<double> shares;
  double nees = 0;  // mean, of 4
  double median() const { return shares[shares.size() / 2]; }
  double p90() const { return shares[shares.size() * 9 / 10]; }
  double worst() const { return shares.back(); }
};

Drifts run_seeds(const char* name, WorldOptions options) {
  Drifts drifts;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    options.seed = seed;
    World world(options);
    world.run();
    drifts.shares.push_back(world.drift());
    drifts.nees += world.nees() / kSeeds;
    EXPECT_EQ(world.fusion().counters().refused, 0u);
  }
  std::sort(drifts.shares.begin(), drifts.shares.end());
  std::printf("%-26s drift median %.2f %%, 90 %% %.2f %%, worst %.2f %%, NEES %.2f of 4\n", name,
              100 * drifts.median(), 100 * drifts.p90(), 100 * drifts.worst(), drifts.nees);
  return drifts;
}

// Mean of the seeds' chi squares of four degrees each, 95 %: chi2(96) / 24, or chi2(8) / 2.
constexpr double kNeesLow = kSeeds == 24 ? 2.95 : 1.09;
constexpr double kNeesHigh = kSeeds == 24 ? 5.21 : 8.77;

TEST(OdometryFusion, BothTogetherDriftLittleAndSaySo) {
  const Drifts drifts = run_seeds("both", WorldOptions{});
  EXPECT_LE(drifts.worst(), 0.005);
  EXPECT_GT(drifts.nees, kNeesLow);
  EXPECT_LT(drifts.nees, kNeesHigh);
}

TEST(OdometryFusion, TheCameraMayBeOffForHalfAMinute) {
  WorldOptions options;
  options.camera_off_from_s = 150;
  const Drifts drifts = run_seeds("camera off for 30 s", options);
  EXPECT_LE(drifts.worst(), 0.015);
  EXPECT_GT(drifts.nees, kNeesLow);
  EXPECT_LT(drifts.nees, kNeesHigh);
}

TEST(OdometryFusion, LegsThatAreOffByAShareAndSlipUnseen) {
  WorldOptions options;
  options.leg_scale = 0.03;
  options.slips_seen = false;
  EXPECT_LE(run_seeds("legs 3 % off, slips unseen", options).worst(), 0.005);
  options.camera_off_from_s = 150;
  EXPECT_LE(run_seeds("and camera off for 30 s", options).worst(), 0.015);
}

TEST(OdometryFusion, EitherAlone) {
  WorldOptions options;
  options.legs = false;
  EXPECT_LE(run_seeds("camera alone", options).worst(), 0.005);
  options.legs = true;
  options.camera = false;
  EXPECT_LE(run_seeds("legs alone", options).worst(), 0.06);
}

// Standard deviation of the place after 20 m with both, over that with the legs alone.
double share_of_legs(double speed_m_s) {
  WorldOptions options;
  options.speed_m_s = speed_m_s;
  options.way_m = 20;
  options.blur = 10;
  double fused = 0;
  double legs = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    options.seed = seed;
    options.camera = true;
    World both(options);
    both.run();
    options.camera = false;
    World alone(options);
    alone.run();
    fused += both.fusion().pose_covariance().topLeftCorner<2, 2>().trace();
    legs += alone.fusion().pose_covariance().topLeftCorner<2, 2>().trace();
  }
  return std::sqrt(fused / legs);
}

TEST(OdometryFusion, TheCameraCountsAtLowSpeedAndTheLegsAtHighSpeed) {
  const double slow = share_of_legs(0.1);
  const double fast = share_of_legs(2.0);
  std::printf("sigma of both over that of the legs alone: %.2f at 0.1 m/s, %.2f at 2 m/s\n", slow,
              fast);
  EXPECT_LT(slow, 0.4);
  EXPECT_GT(fast, 0.6);
}

TEST(OdometryFusion, DoesNotDriftAtStandstillWithTheCamera) {
  WorldOptions options;
  options.speed_m_s = 1e-6;
  options.way_m = 60e-6;  // one minute
  double worst_m = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    options.seed = seed;
    World world(options);
    world.run();
    worst_m = std::max(worst_m, world.error_m().norm());
  }
  std::printf("a minute in place: worst %.4f m\n", worst_m);
  EXPECT_LT(worst_m, 0.02);
}

TEST(OdometryFusion, RefusesWhatIsNoInput) {
  OdometryFusion fusion;
  EXPECT_EQ(fusion.configure({}, Matrix3::Identity(), Vector3::Zero()), Status::kInvalid);
  ASSERT_EQ(fusion.configure(tests::recommended_fusion(), Matrix3::Identity(), Vector3::Zero()),
            Status::kOk);
  LegOdometry legs;
  legs.valid = true;
  legs.v_B_m_s.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(fusion.update(Matrix3::Identity(), legs, 0.002), Status::kInvalid);
  legs.v_B_m_s.setZero();
  EXPECT_EQ(fusion.update(2 * Matrix3::Identity(), legs, 0.002), Status::kInvalid);
  EXPECT_EQ(fusion.update(Matrix3::Identity(), legs, 0), Status::kInvalid);
  EXPECT_EQ(fusion.p_OB_m(), Vector3(Vector3::Zero()));
}

// A keyframe and a picture 10 cm ahead of it.
struct Pair {
  OdometryFusion fusion;
  VisualMotion motion;

  Pair() {
    EXPECT_EQ(fusion.configure(tests::recommended_fusion(), Matrix3::Identity(), Vector3::Zero()),
              Status::kOk);
    LegOdometry legs;
    legs.valid = true;
    legs.v_B_m_s.x() = 0.5;
    fusion.note_exposure(TimeNs{1});
    VisualMotion first;
    first.to = TimeNs{1};
    first.new_keyframe = true;
    EXPECT_EQ(fusion.observe(first), Status::kOk);
    for (int i = 0; i < 20; ++i) {
      EXPECT_EQ(fusion.update(Matrix3::Identity(), legs, 0.01), Status::kOk);
    }
    fusion.note_exposure(TimeNs{2});
    motion.valid = true;
    motion.from = TimeNs{1};
    motion.to = TimeNs{2};
    motion.p_KN_m = Vector3(0.102, 0, 0);
    motion.covariance = 1e-8 * Matrix6::Identity();
  }
};

TEST(OdometryFusion, AMotionMovesThePose) {
  Pair pair;
  EXPECT_NEAR(pair.fusion.p_OB_m().x(), 0.1, 1e-9);
  EXPECT_EQ(pair.fusion.observe(pair.motion), Status::kOk);
  EXPECT_NEAR(pair.fusion.p_OB_m().x(), 0.102, 3e-4);
}

TEST(OdometryFusion, RefusesMotionsThatAreNone) {
  Pair pair;
  VisualMotion wrong = pair.motion;
  wrong.from = TimeNs{7};
  EXPECT_EQ(pair.fusion.observe(wrong), Status::kUnavailable);
  wrong = pair.motion;
  wrong.p_KN_m.x() = 2;
  EXPECT_EQ(pair.fusion.observe(wrong), Status::kOutOfRange);
  wrong = pair.motion;
  wrong.covariance.setZero();
  EXPECT_EQ(pair.fusion.observe(wrong), Status::kInvalid);
  wrong = pair.motion;
  wrong.R_KN *= 1.1;
  EXPECT_EQ(pair.fusion.observe(wrong), Status::kInvalid);
  wrong = pair.motion;
  wrong.p_KN_m.y() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(pair.fusion.observe(wrong), Status::kInvalid);
  EXPECT_EQ(pair.fusion.counters().refused, 3u);
  EXPECT_EQ(pair.fusion.counters().outliers, 1u);
  EXPECT_EQ(pair.fusion.counters().unmatched, 1u);
  EXPECT_NEAR(pair.fusion.p_OB_m().x(), 0.1, 1e-9) << "unchanged";
  EXPECT_EQ(pair.fusion.observe(pair.motion), Status::kOk);
}

}  // namespace
}  // namespace surefoot::estimation
