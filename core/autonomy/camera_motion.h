// The stereo camera as an odometer: a part of the stereo task, which has rectified the pair and,
// where the map is made of it, found its disparities. core/visual_odometry finds the motion since
// its keyframe; legs and gyro predict it.
//
// in: the rectified pictures (stereo task); the poses that the robot had
//     when the pairs were exposed (B in O)
// out: where the rectified left camera N is in the keyframe's K, stamped with the ticks in which
//     the exposures were asked for (estimation::OdometryFusion keeps the poses of those)
//
// Memory: 2.2 MB. Nothing allocates. Cost: core/visual_odometry/README.md.
#pragma once

#include "core/autonomy/camera_motion_config.h"
#include "core/autonomy/camera_motion_counters.h"
#include "core/autonomy/pose_history.h"
#include "core/estimation/odometry_fusion.h"
#include "core/geometry/frames.h"
#include "core/stereo/images.h"
#include "core/visual_odometry/visual_odometry.h"

namespace surefoot::autonomy {

using CameraInBody = geometry::Pose<geometry::Body, geometry::DepthCamera>;

class CameraMotion {
 public:
  // Without a configuration this does nothing. kInvalid: see VisualOdometry::configure().
  Status reset(const CameraMotionConfig& config, const stereo::RectifiedPair& pair,
               const CameraInBody& X_BN);
  bool enabled() const { return enabled_; }

  // O and the ground have parted, or the robot has.
  void forget();
  // In the tick that asks for an exposure.
  void note_trigger(TimeNs tick) { triggered_ = tick; }

  // A pair has come in that was exposed at `exposed`.
  void release(TimeNs exposed, const PoseHistory& history);
  // Anywhere between release and publish. disparities: of the left picture; null: not known.
  void run(const stereo::GreyView& left, const stereo::GreyView& right,
           const stereo::DisparityImage* disparities);
  // What run() has found, once.
  estimation::VisualMotion publish();

  const CameraMotionCounters& counters() const { return counters_; }
  std::int32_t inliers() const { return motion_.inliers; }

 private:
  bool predict(TimeNs exposed, const PoseHistory& history);

  bool enabled_ = false;
  CameraInBody X_BN_;
  visual_odometry::VisualOdometry odometry_;
  TimeNs triggered_;      // the newest trigger
  TimeNs exposed_;        // of the newest pair, as it was stamped
  bool started_ = false;  // exposed_ is one
  bool released_ = false;
  visual_odometry::Prediction prediction_;
  TimeNs stamp_;  // of the tick that asked for the pair
  visual_odometry::Motion motion_;
  Status status_ = Status::kUnavailable;
  CameraMotionCounters counters_;
};

}  // namespace surefoot::autonomy
