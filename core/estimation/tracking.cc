#include "core/estimation/tracking.h"

#include "core/math/elementary.h"

namespace surefoot::estimation {
namespace {

// Samples whose mean places S: white noise of one would stay in O as an error of heading.
constexpr int kAveraged = 40;
// A gap longer than this is an outage: the sample after it compares, those that follow correct.
constexpr double kMaxStep_s = 0.05;
Matrix3 turn(const Vector3& rotation_rad) {
  return geometry::to_matrix(geometry::from_rotation_vector(rotation_rad));
}

}  // namespace

void DriftEstimator::reset(const TrackingConfig& config) {
  *this = DriftEstimator{};
  config_ = config;
}

Status DriftEstimator::check(const hal::PoseSample& sample) {
  const bool later = !checked_any_ || sample.stamp > checked_stamp_;
  if (!is_pose(sample) || !later) {
    ++counters_.refused;
    return Status::kInvalid;
  }
  if (sample.confidence < config_.min_confidence) {
    ++counters_.low_confidence;
    return Status::kUnavailable;
  }
  checked_any_ = true;
  checked_stamp_ = sample.stamp;
  return Status::kOk;
}

void DriftEstimator::anchor(const Observation& now) {
  anchored_ = true;
  averaged_ = 0;
  R_OS_ = now.R_OB * now.camera.R_SB.transpose();
  p_OB_camera_m_ = now.p_OB_m;
  error_O_m_.setZero();
  rotation_error_O_rad_.setZero();
  kept_error_O_m_.setZero();
  kept_rotation_O_rad_.setZero();
}

// The errors with this sample; S is moved when they changed more than they can.
void DriftEstimator::compare(const Observation& now, double span_s) {
  p_OB_camera_m_ += R_OS_ * (now.camera.p_SB_m - p_SB_m_);
  const Vector3 error = p_OB_camera_m_ - now.p_OB_m;
  const Vector3 rotation =
      geometry::to_rotation_vector(R_OS_ * now.camera.R_SB * now.R_OB.transpose());
  const double allowed_m = config_.jump_m + config_.odometry_drift_m_s * span_s;
  const double allowed_rad = config_.jump_rad + config_.odometry_drift_rad_s * span_s;
  if ((error - error_O_m_).squaredNorm() > math::square(allowed_m) ||
      (rotation - rotation_error_O_rad_).squaredNorm() > math::square(allowed_rad)) {
    ++counters_.jumps;
    averaged_ = 0;
    kept_error_O_m_ = error_O_m_;
    kept_rotation_O_rad_ = rotation_error_O_rad_;
  }
  error_O_m_ = error;
  rotation_error_O_rad_ = rotation;
}

// Moves S so that the mean error of the samples since it was found or moved is what it was before.
void DriftEstimator::average(const Observation& now) {
  const double share = 1.0 / (averaged_ + 1);
  ++averaged_;
  R_OS_ = turn((kept_rotation_O_rad_ - rotation_error_O_rad_) * share) * R_OS_;
  p_OB_camera_m_ += (kept_error_O_m_ - error_O_m_) * share;
  error_O_m_ = p_OB_camera_m_ - now.p_OB_m;
  rotation_error_O_rad_ =
      geometry::to_rotation_vector(R_OS_ * now.camera.R_SB * now.R_OB.transpose());
}

// Of the gain on an error: a leaky dead zone.
double DriftEstimator::weight(double error, double own) const {
  const double size = math::magnitude(error);
  const double beyond = size > own ? (size - own) / size : 0.0;
  return config_.own_error_share + (1.0 - config_.own_error_share) * beyond;
}

DriftCorrection DriftEstimator::correction(double step_s) const {
  const double off_m = math::sqrt(error_O_m_.head<2>().squaredNorm());
  Vector3 rate_m_s = error_O_m_ * config_.position_gain_1_s;
  rate_m_s.head<2>() *= weight(off_m, config_.own_horizontal_m);
  rate_m_s[2] *= weight(error_O_m_[2], config_.own_vertical_m);
  const double horizontal_m_s = math::sqrt(rate_m_s.head<2>().squaredNorm());
  if (horizontal_m_s > config_.max_horizontal_m_s) {
    rate_m_s.head<2>() *= config_.max_horizontal_m_s / horizontal_m_s;
  }
  rate_m_s[2] = math::clamp(rate_m_s[2], -config_.max_vertical_m_s, config_.max_vertical_m_s);
  const double yaw_rad = yaw_error_rad() * weight(yaw_error_rad(), config_.own_yaw_rad);
  const double wanted_rad_s = config_.yaw_gain_1_s * yaw_rad;
  DriftCorrection out;
  out.shift_O_m = rate_m_s * step_s;
  out.yaw_rad =
      math::clamp(wanted_rad_s, -config_.max_yaw_rate_rad_s, config_.max_yaw_rate_rad_s) * step_s;
  // An error beyond the bound is an outage's: it says nothing about the bias of now.
  const bool bounded =
      wanted_rad_s > config_.max_yaw_rate_rad_s || wanted_rad_s < -config_.max_yaw_rate_rad_s;
  if (!bounded) out.yaw_bias_rad_s = -config_.yaw_bias_gain_1_s2 * yaw_rad * step_s;
  return out;
}

DriftCorrection DriftEstimator::observe(const CameraPose& camera, const PoseAtStamp& own) {
  ++counters_.used;
  const Observation now{camera, geometry::to_matrix(own.q_OB), own.p_OB_m};
  const double span_s = anchored_ ? (camera.stamp - stamp_).seconds() : 0.0;
  if (anchored_) {
    compare(now, span_s);
  } else {
    anchor(now);
  }
  p_SB_m_ = camera.p_SB_m;
  stamp_ = camera.stamp;
  if (averaged_ < kAveraged) average(now);
  const double step_s = span_s > kMaxStep_s ? 0.0 : span_s;
  Vector3 tilt_rad = rotation_error_O_rad_;
  tilt_rad[2] = 0.0;
  R_OS_ = turn(tilt_rad * (-config_.tilt_gain_1_s * step_s)) * R_OS_;
  return correction(step_s);
}

}  // namespace surefoot::estimation
