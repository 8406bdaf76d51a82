#include "core/autonomy/camera_motion.h"

namespace surefoot::autonomy {
namespace {

// From the tick that asks for a pair to the middle of its exposure, at most.
constexpr TimeNs kTriggerDelay = milliseconds(20);

}  // namespace

Status CameraMotion::reset(const CameraMotionConfig& config, const stereo::RectifiedPair& pair,
                           const CameraInBody& X_BN) {
  enabled_ = false;
  counters_ = CameraMotionCounters{};
  if (!config.present) return Status::kOk;
  const Status configured = odometry_.configure(config.camera, pair);
  if (!ok(configured)) return configured;
  X_BN_ = X_BN;
  triggered_ = TimeNs{};
  enabled_ = true;
  forget();
  return Status::kOk;
}

void CameraMotion::forget() {
  odometry_.reset();
  started_ = false;
  released_ = false;
}

void CameraMotion::release(TimeNs exposed, const PoseHistory& history) {
  released_ = false;
  if (!enabled_) return;
  if (started_ && exposed <= exposed_) {
    ++counters_.late;
    return;
  }
  const bool asked_for = exposed >= triggered_ && exposed - triggered_ <= kTriggerDelay;
  if (!asked_for || !predict(exposed, history)) {
    ++counters_.without_pose;
    return;
  }
  stamp_ = triggered_;
  exposed_ = exposed;
  started_ = true;
  released_ = true;
}

// By legs and gyro, from the pair before. After a gap that the history does not span there is no
// prediction: a new keyframe begins.
bool CameraMotion::predict(TimeNs exposed, const PoseHistory& history) {
  const Result<PastPose> now = history.at(exposed);
  if (!now.ok()) return false;
  prediction_ = visual_odometry::Prediction{};
  const Result<PastPose> before = started_ ? history.at(exposed_) : Status::kUnavailable;
  if (!before.ok()) {
    odometry_.reset();
    return true;
  }
  const auto X_PN = (before.value().X_OB() * X_BN_).inverse() * (now.value().X_OB() * X_BN_);
  prediction_.R_PN = X_PN.rotation.matrix;
  prediction_.p_PN_m = X_PN.origin.m;
  return true;
}

void CameraMotion::run(const stereo::GreyView& left, const stereo::GreyView& right,
                       const stereo::DisparityImage* disparities) {
  if (!released_) return;
  visual_odometry::Pictures pictures;
  pictures.stamp = stamp_;
  pictures.left = left;
  pictures.right = right;
  pictures.disparities = disparities;
  status_ = odometry_.update(pictures, prediction_, motion_);
}

estimation::VisualMotion CameraMotion::publish() {
  estimation::VisualMotion out;
  if (!released_) return out;
  released_ = false;
  // Stamps and sizes were checked: what is left is a prediction that is no rotation.
  if (!ok(status_)) {
    ++counters_.without_pose;
    return out;
  }
  switch (motion_.status) {
    case visual_odometry::MotionStatus::kOk: ++counters_.motions; break;
    case visual_odometry::MotionStatus::kFirst: ++counters_.first; break;
    case visual_odometry::MotionStatus::kTooFewFeatures: ++counters_.too_few_features; break;
    case visual_odometry::MotionStatus::kInconsistent: ++counters_.inconsistent; break;
  }
  out.valid = motion_.status == visual_odometry::MotionStatus::kOk;
  out.from = motion_.from;
  out.to = motion_.to;
  out.R_KN = motion_.R_KN;
  out.p_KN_m = motion_.p_KN_m;
  out.covariance = motion_.covariance;
  out.new_keyframe = motion_.new_keyframe;
  return out;
}

}  // namespace surefoot::autonomy
