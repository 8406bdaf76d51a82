// Models of the two cameras of a stereo pair, and the rectified pair that follows from them.
//
// Frames (docs/frames_and_units.md): V is the left camera's optical frame, E the right one's, N the
// rectified one: origin of V, x along the baseline. Pixel (0, 0) is the centre of the first.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/status.h"
#include "core/math/linear.h"
#include "core/robot/robot_model.h"

namespace surefoot::stereo {

// Pinhole with the distortion of OpenCV's calibration (Brown, with the rational denominator):
// k1, k2, p1, p2, k3, k4, k5, k6; unused ones are 0.
struct CameraModel {
  std::uint16_t width_px = 0;
  std::uint16_t height_px = 0;
  double fx_px = 0;
  double fy_px = 0;
  double cx_px = 0;
  double cy_px = 0;
  std::array<double, 8> distortion{};

  // Where the camera sees the direction (x, y, 1) of its optical frame.
  Vector2 project(double x, double y) const;
  // The direction that a pixel sees: inverse of project() by kUndistortSteps fixed-point steps.
  Vector2 direction(double u_px, double v_px) const;
};

inline constexpr int kUndistortSteps = 20;

struct StereoCalibration {
  CameraModel left;
  CameraModel right;
  Matrix3 R_EV = Matrix3::Identity();  // turns the left camera's axes into the right one's
  Vector3 p_EV_m = Vector3::Zero();    // the left camera from the right one; OpenCV's T
};

// The same from a robot's file.
StereoCalibration stereo_calibration(const robot::StereoCameraCalibration& file);

// Two ideal cameras side by side: disparity = focal * baseline / z.
struct RectifiedPair {
  std::uint16_t width_px = 0;
  std::uint16_t height_px = 0;
  double focal_px = 0;
  double cx_px = 0;  // the same in both
  double cy_px = 0;
  double baseline_m = 0;
  Matrix3 R_NV = Matrix3::Identity();
  Matrix3 R_NE = Matrix3::Identity();
};

// Turns both cameras by half of their difference, then about the shortest way until x lies along
// the baseline (Bouguet; the rotations are those of OpenCV's stereoRectify). The picture has the
// given size; a focal length of 0 chooses the mean of the cameras' scaled to that width. The middle
// of the picture is the middle of what the cameras see.
// kInvalid: a value is not finite or outside its domain (sizes 16 to the capacity, focal lengths
// above 1 px, R_EV a rotation within 1e-6, the same size of both cameras).
// kOutOfRange: the baseline is not mainly along x or below 1 mm, or the cameras are swapped.
// out is unchanged then.
Status rectify(const StereoCalibration& calibration, std::uint16_t width_px,
               std::uint16_t height_px, double focal_px, RectifiedPair& out);

}  // namespace surefoot::stereo
