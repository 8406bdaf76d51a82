// Attitude from gyro and accelerometer: R_OB, and the gyro bias.
//
// The gyro is integrated as rotation vectors; the accelerometer's "up" pulls roll and pitch back
// with a first-order gain and teaches the gyro bias with an integral gain (explicit complementary
// filter, Mahony, Hamel, Pflimlin, IEEE TAC 2008, eq. 32). Yaw has no reference here: it drifts
// with the gyro unless correct_yaw() is told. While the robot lies still the bias of all three axes
// is learned directly and gravity pulls harder.
#pragma once

#include "core/base/status.h"
#include "core/base/time.h"
#include "core/estimation/config.h"
#include "core/geometry/rotations.h"
#include "core/math/gravity.h"
#include "core/math/linear.h"
#include "core/robot/robot_model.h"
#include "hal/api/imu_port.h"

namespace surefoot::estimation {

class AttitudeEstimator {
 public:
  void reset(const AttitudeConfig& config, const robot::ImuSpecification& imu);

  // Takes the next sample. Roll and pitch start from the mean specific force of the first
  // kStartSamples in a row that look like rest (gravity alone within max_gravity_error_m_s2), yaw =
  // 0. kInvalid: a value is not finite, or the stamp is not after the last one; nothing changed.
  // feet_carry: the measured "up" does not pull; level_by_feet() does.
  Status update(const hal::ImuSample& sample, bool lying_still, bool feet_carry = false);

  // correction_O_m_s: what the feet have put right of the velocity that the accelerometer gave. On
  // average it is the share of gravity that a wrong "up" takes for acceleration.
  void level_by_feet(const Vector3& correction_O_m_s);

  // At rest on ground that is known to be level: up_B says where up is, whatever the accelerometer
  // says. Turns the estimate by `share` of the difference and learns the accelerometer's bias.
  void level(const Vector3& up_B, double share);

  // Turns about O's up axis and shifts the gyro's bias about it.
  void correct_yaw(double yaw_rad, double bias_rad_s);
  // Turns the whole estimate about the vertical so that the heading becomes yaw_rad.
  void set_yaw(double yaw_rad);

  bool initialised() const { return initialised_; }
  const geometry::Quaternion& q_OB() const { return q_OB_; }
  const Matrix3& R_OB() const { return R_OB_; }
  // Bias removed.
  const Vector3& angular_velocity_B_rad_s() const { return angular_velocity_B_rad_s_; }
  // At the trunk's origin: bias and the lever arm's centripetal part are removed.
  const Vector3& specific_force_B_m_s2() const { return specific_force_B_m_s2_; }
  const Vector3& gyro_bias_B_rad_s() const { return gyro_bias_B_rad_s_; }
  const Vector3& accelerometer_bias_B_m_s2() const { return accelerometer_bias_B_m_s2_; }
  TimeNs stamp() const { return stamp_; }

 private:
  static constexpr int kStartSamples = 50;

  bool looks_like_rest(const Vector3& specific_force_B_m_s2) const;
  void gather_start(const Vector3& specific_force_B_m_s2);
  Vector3 gravity_correction(const Vector3& specific_force_B_m_s2) const;
  void turn_O(const Vector3& rotation_rad);

  AttitudeConfig config_;
  Matrix3 R_BI_ = Matrix3::Identity();
  Vector3 p_BI_m_ = Vector3::Zero();
  bool initialised_ = false;
  int start_samples_ = 0;
  Vector3 start_sum_m_s2_ = Vector3::Zero();
  TimeNs stamp_;
  geometry::Quaternion q_OB_;
  Matrix3 R_OB_ = Matrix3::Identity();
  Vector3 angular_velocity_B_rad_s_ = Vector3::Zero();
  Vector3 specific_force_B_m_s2_ = Vector3::Zero();
  Vector3 gyro_bias_B_rad_s_ = Vector3::Zero();
  Vector3 accelerometer_bias_B_m_s2_ = Vector3::Zero();
};

}  // namespace surefoot::estimation
