// A camera that walks over rendered ground, and how well visual odometry follows it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/visual_odometry/visual_odometry.h"
#include "tests/support/textured_scene.h"
#include "tests/support/visual_odometry_setup.h"

namespace surefoot::tests {

inline constexpr double kPicturePeriod_s = 1.0 / 12;

struct WalkOptions {
  std::uint64_t seed = 1;
  int pictures = 30;
  double speed_m_s = 0.5;
  double turn_rad_s = 0.1;
  double contrast = 160;
  double grey_noise = 2;
  int boxes = 12;
  double gyro_noise_rad = 0.0005;  // of the predicted turn between two pictures
  bool with_legs = false;          // displacement by the legs, 10 % and 5 mm off
  bool changing_exposure = false;
  double object_m_s = 0;  // sideways speed of a box that fills 30 % of the picture; 0: none
  bool use_disparities = false;
};

// Where the camera is at a time: forwards, with the bounce and sway of a trot.
CameraPlace camera_at(const WalkOptions& options, double time_s);

struct WalkResult {
  int ok = 0;
  int failed = 0;
  int keyframes = 0;
  double way_m = 0;
  double end_error_m = 0;
  double turn_error_rad = 0;
  double mean_nees = 0;            // of 6
  double median_step_error_m = 0;  // of a motion from the keyframe
  double mean_inliers = 0;
};

WalkResult walk(const WalkOptions& options);

// Pose of `b` in `a`.
CameraPlace relative(const CameraPlace& a, const CameraPlace& b);
CameraPlace chain(const CameraPlace& a, const CameraPlace& b);

}  // namespace surefoot::tests
