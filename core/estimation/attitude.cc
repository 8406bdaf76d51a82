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

bool AttitudeEstimator::looks_like_rest(const Vector3& f) const {
  const double excess = math::sqrt(f.squaredNorm()) - kGravity_m_s2;
  return excess <= config_.max_gravity_error_m_s2 && -excess <= config_.max_gravity_error_m_s2;
}

void AttitudeEstimator::gather_start(const Vector3& f) {
  if (!looks_like_rest(f)) {
    start_samples_ = 0;
    start_sum_m_s2_.setZero();
    return;
  }
  start_sum_m_s2_ += f;
  if (++start_samples_ < kStartSamples) return;
  const Vector3& up = start_sum_m_s2_;
  const double roll = math::atan2(up[1], up[2]);
  const double pitch = math::atan2(-up[0], math::sqrt(up[1] * up[1] + up[2] * up[2]));
  R_OB_ = geometry::from_roll_pitch_yaw(roll, pitch, 0.0);
  q_OB_ = geometry::to_quaternion(R_OB_);
  initialised_ = true;
}

void AttitudeEstimator::set_yaw(double yaw_rad) {
  const double turn = yaw_rad - math::atan2(R_OB_(1, 0), R_OB_(0, 0));
  turn_O(Vector3(0.0, 0.0, turn));
}

// Rotation, in B, that would bring the predicted "up" onto the measured one; zero while
// accelerating.
Vector3 AttitudeEstimator::gravity_correction(const Vector3& f) const {
  if (!looks_like_rest(f)) return Vector3::Zero();
  const Vector3 up_predicted_B = R_OB_.row(2).transpose();
  return (f / math::sqrt(f.squaredNorm())).cross(up_predicted_B);
}

Status AttitudeEstimator::update(const hal::ImuSample& sample, bool lying_still, bool feet_carry) {
  const Vector3 gyro_B = R_BI_ * from_array(sample.angular_velocity_I_rad_s);
  const Vector3 force_B =
      R_BI_ * from_array(sample.specific_force_I_m_s2) - accelerometer_bias_B_m_s2_;
  if (!finite(gyro_B) || !finite(force_B)) return Status::kInvalid;
  if (sample.stamp <= stamp_) return Status::kInvalid;
  if (!initialised_) {
    stamp_ = sample.stamp;
    specific_force_B_m_s2_ = force_B;
    gather_start(force_B);
    return Status::kOk;
  }
  const double step_s = math::clamp((sample.stamp - stamp_).seconds(), 0.0, kMaxStep_s);
  stamp_ = sample.stamp;

  if (lying_still) {
    gyro_bias_B_rad_s_ +=
        (gyro_B - gyro_bias_B_rad_s_) * math::clamp(config_.still_bias_gain_1_s * step_s, 0.0, 1.0);
  }
  const Vector3 error = feet_carry ? Vector3(Vector3::Zero()) : gravity_correction(force_B);
  gyro_bias_B_rad_s_ -= error * (config_.bias_gain_1_s2 * step_s);
  angular_velocity_B_rad_s_ = gyro_B - gyro_bias_B_rad_s_;
  const double gain = lying_still ? config_.still_correction_gain_1_s : config_.correction_gain_1_s;
  const Vector3 rate = angular_velocity_B_rad_s_ + error * gain;
  q_OB_ = geometry::normalised(q_OB_ * geometry::from_rotation_vector(rate * step_s));
  R_OB_ = geometry::to_matrix(q_OB_);

  const Vector3& omega = angular_velocity_B_rad_s_;
  specific_force_B_m_s2_ = force_B - omega.cross(omega.cross(p_BI_m_));
  return Status::kOk;
}

// An estimate turned by phi takes phi x g for acceleration, dt long; the feet undo it with
// c = -g dt (phi x up), and up x c / g = -dt phi.
void AttitudeEstimator::level_by_feet(const Vector3& correction_O_m_s) {
  const Vector3 error_O_rad_s = Vector3::UnitZ().cross(correction_O_m_s) / kGravity_m_s2;
  gyro_bias_B_rad_s_ -= R_OB_.transpose() * error_O_rad_s * config_.bias_gain_1_s2;
  turn_O(error_O_rad_s * config_.correction_gain_1_s);
}

void AttitudeEstimator::level(const Vector3& up_B, double share) {
  if (!initialised_) return;
  const Vector3 error_O_rad = (R_OB_ * up_B).cross(Vector3::UnitZ());
  turn_O(error_O_rad * share);
  accelerometer_bias_B_m_s2_ += (specific_force_B_m_s2_ - up_B * kGravity_m_s2) * share;
}

void AttitudeEstimator::correct_yaw(double yaw_rad, double bias_rad_s) {
  if (!initialised_) return;
  const Vector3 up_B = R_OB_.row(2).transpose();
  gyro_bias_B_rad_s_ += up_B * bias_rad_s;
  turn_O(Vector3(0.0, 0.0, yaw_rad));
}

void AttitudeEstimator::turn_O(const Vector3& rotation_rad) {
  q_OB_ = geometry::normalised(geometry::from_rotation_vector(rotation_rad) * q_OB_);
  R_OB_ = geometry::to_matrix(q_OB_);
}

}  // namespace surefoot::estimation
