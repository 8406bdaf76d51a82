#include "core/estimation/attitude.h"

#include "core/math/elementary.h"

namespace surefoot::estimation {
namespace {

// A gap longer than this is a drop-out: the last rate is not stretched over it.
constexpr double kMaxStep_s = 0.05;

bool finite(const Vector3& v) {
  return math::is_finite(v[0]) && math::is_finite(v[1]) && math::is_finite(v[2]);
}

Vector3 from_array(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

}  // namespace

void AttitudeEstimator::reset(const AttitudeConfig& config, const robot::ImuSpecification& imu) {
  *this = AttitudeEstimator{};
  config_ = config;
  const auto& rpy = imu.mount.roll_pitch_yaw_rad;
  R_BI_ = geometry::from_roll_pitch_yaw(rpy[0], rpy[1], rpy[2]);
  p_BI_m_ = from_array(imu.mount.position_B_m);
}

void AttitudeEstimator::initialise(const Vector3& f) {
  const double roll = math::atan2(f[1], f[2]);
  const double pitch = math::atan2(-f[0], math::sqrt(f[1] * f[1] + f[2] * f[2]));
  R_OB_ = geometry::from_roll_pitch_yaw(roll, pitch, 0.0);
  q_OB_ = geometry::to_quaternion(R_OB_);
  initialised_ = true;
}

// Rotation, in B, that would bring the predicted "up" onto the measured one; zero while accelerating.
Vector3 AttitudeEstimator::gravity_correction(const Vector3& f) const {
  const double norm = math::sqrt(f.squaredNorm());
  const double excess = norm - kGravity_m_s2;
  if (excess > config_.max_gravity_error_m_s2 || -excess > config_.max_gravity_error_m_s2) {
    return Vector3::Zero();
  }
  const Vector3 up_predicted_B = R_OB_.row(2).transpose();
  return (f / norm).cross(up_predicted_B);
}

Status AttitudeEstimator::update(const hal::ImuSample& sample, bool standing_still) {
  const Vector3 gyro_B = R_BI_ * from_array(sample.angular_velocity_I_rad_s);
  const Vector3 force_B = R_BI_ * from_array(sample.specific_force_I_m_s2);
  if (!finite(gyro_B) || !finite(force_B)) return Status::kInvalid;
  if (!initialised_) {
    if (force_B.squaredNorm() < 1.0) return Status::kInvalid;  // free fall shows no "up"
    stamp_ = sample.stamp;
    specific_force_B_m_s2_ = force_B;
    initialise(force_B);
    return Status::kOk;
  }
  if (sample.stamp <= stamp_) return Status::kInvalid;
  const double step_s = math::clamp((sample.stamp - stamp_).seconds(), 0.0, kMaxStep_s);
  stamp_ = sample.stamp;

  if (standing_still) {
    gyro_bias_B_rad_s_ += (gyro_B - gyro_bias_B_rad_s_) *
                          math::clamp(config_.still_bias_gain_1_s * step_s, 0.0, 1.0);
  }
  const Vector3 error = gravity_correction(force_B);
  gyro_bias_B_rad_s_ -= error * (config_.bias_gain_1_s2 * step_s);
  angular_velocity_B_rad_s_ = gyro_B - gyro_bias_B_rad_s_;
  const Vector3 rate = angular_velocity_B_rad_s_ + error * config_.correction_gain_1_s;
  q_OB_ = geometry::normalised(q_OB_ * geometry::from_rotation_vector(rate * step_s));
  R_OB_ = geometry::to_matrix(q_OB_);

  const Vector3& omega = angular_velocity_B_rad_s_;
  specific_force_B_m_s2_ = force_B - omega.cross(omega.cross(p_BI_m_));
  return Status::kOk;
}

}  // namespace surefoot::estimation
