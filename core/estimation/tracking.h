// What a tracking camera says about the drift of O: slow corrections of position and yaw.
//
// The camera's trunk pose in O is the chain of paper 002, equation (1), X_OB = X_OS X_ST X_TB; it
// is compared with the estimator's own pose at the sample's stamp. Of the difference a small share
// is given back per sample, at a bounded rate: O stays continuous, its corrections are of the size
// of the drift they remove, and the map in it does not tear (docs/decisions/007). The way is summed
// up increment by increment, so that neither a turn of S nor a jump is multiplied by the distance.
//
// The camera drifts too, over a short way more than legs that do not slip. An error that may be its
// own is all but left to it (own_error_share of the gains remains, for drift that lasts); what is
// more must be the legs'.
//
// Increments that differ from the estimator's by more than a step of the body and the odometry's
// own drift can explain are the camera's: relocalisation, restart, return from an outage. They move
// S and leave O alone. Gravity is the estimator's: the tilt of S follows it slowly.
//
// Cost: a few 3 x 3 products per sample. Memory: < 1 kB.
#pragma once

#include <cstdint>

#include "core/base/status.h"
#include "core/base/time.h"
#include "core/estimation/camera_pose.h"
#include "core/estimation/config.h"
#include "core/geometry/rotations.h"
#include "core/math/linear.h"
#include "core/robot/robot_model.h"
#include "hal/api/pose_port.h"

namespace surefoot::estimation {

// To be added to the estimate now.
struct DriftCorrection {
  Vector3 shift_O_m = Vector3::Zero();
  double yaw_rad = 0;
  double yaw_bias_rad_s = 0;  // to the gyro's bias, about up
};

// Every sample that arrives ends in one of the first four.
struct TrackingCounters {
  std::uint64_t used = 0;
  std::uint64_t refused = 0;         // not finite, not a rotation, out of order
  std::uint64_t low_confidence = 0;  // below min_confidence
  std::uint64_t without_pose = 0;    // stamp outside the pose history: all, while O has no place
  std::uint64_t jumps = 0;           // of those used: S was moved
  std::uint64_t relocations = 0;     // after a fall the camera said where it is

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("used", self.used);
    visit("refused", self.refused);
    visit("low_confidence", self.low_confidence);
    visit("without_pose", self.without_pose);
    visit("jumps", self.jumps);
    visit("relocations", self.relocations);
  }
};

class DriftEstimator {
 public:
  void reset(const TrackingConfig& config);

  // O was placed anew: the next sample finds S.
  void restart() { anchored_ = false; }

  // Before the next sample is used. kInvalid: not finite, no unit quaternion, or not after the last
  // one. kUnavailable: confidence too low. Counted.
  Status check(const hal::PoseSample& sample);
  // Takes the next sample.
  DriftCorrection observe(const CameraPose& camera, const PoseAtStamp& own);
  // Instead, for a sample whose stamp has no pose.
  void count_without_pose() { ++counters_.without_pose; }
  void count_relocation() { ++counters_.relocations; }

  // Camera minus estimate at the last sample; zero before the first.
  const Vector3& position_error_O_m() const { return error_O_m_; }
  double yaw_error_rad() const { return rotation_error_O_rad_[2]; }
  const TrackingCounters& counters() const { return counters_; }

 private:
  struct Observation {
    CameraPose camera;
    Matrix3 R_OB;  // own
    Vector3 p_OB_m;
  };

  void anchor(const Observation& now);
  void compare(const Observation& now, double span_s);
  void average(const Observation& now);
  double weight(double error, double own) const;
  DriftCorrection correction(double step_s) const;

  TrackingConfig config_;
  bool anchored_ = false;
  bool checked_any_ = false;
  TimeNs checked_stamp_;  // of the last sample that passed
  int averaged_ = 0;      // samples since S was found or moved
  TimeNs stamp_;
  Matrix3 R_OS_ = Matrix3::Identity();
  Vector3 p_OB_camera_m_ = Vector3::Zero();  // the camera's way, summed up in O
  Vector3 p_SB_m_ = Vector3::Zero();         // of the sample before
  Vector3 error_O_m_ = Vector3::Zero();
  Vector3 rotation_error_O_rad_ = Vector3::Zero();
  Vector3 kept_error_O_m_ = Vector3::Zero();  // what a move of S must not change
  Vector3 kept_rotation_O_rad_ = Vector3::Zero();
  TrackingCounters counters_;
};

}  // namespace surefoot::estimation
