// The motion that puts the keyframe's points where they are seen now: robust Gauss-Newton on the
// reprojection error.
#pragma once

#include <array>

#include "core/base/fixed_vector.h"
#include "core/math/linear.h"
#include "core/stereo/calibration.h"
#include "core/visual_odometry/features.h"

namespace surefoot::visual_odometry {

inline constexpr int kSolverSteps = 8;

// A point of the keyframe and the pixel where it is seen now.
struct Observation {
  std::uint16_t feature = 0;
  Vector3 p_K_m = Vector3::Zero();
  double disparity_px = 0;
  double disparity_variance_px2 = 0;
  Vector2 seen_px = Vector2::Zero();
  double seen_variance_px2 = 0;  // of either coordinate
  bool inlier = true;            // within the gate at the end
};
using Observations = FixedVector<Observation, kMaxFeatures>;

// Turns points of K into points of N.
struct KeyframeView {
  Matrix3 R_NK = Matrix3::Identity();
  Vector3 t_NK_m = Vector3::Zero();
};

struct Solution {
  KeyframeView view;
  Matrix6 information = Matrix6::Zero();  // of (displacement, rotation) of the points, in N
  std::size_t inliers = 0;
  double chi2 = 0;         // of the inliers, two coordinates each
  double residual_px = 0;  // root mean square of the inliers, per coordinate
};

// Where K's point of a feature lies.
Vector3 point_of(const stereo::RectifiedPair& pair, double u_px, double v_px, double disparity_px);
Vector2 project(const stereo::RectifiedPair& pair, const Vector3& p_N_m);

// From `start` on. The noise of a residual is that of what is seen and that of the keyframe's
// disparity as far as it shows. Huber's weights first; in the last kCleanSteps only what is within
// gate_sigma counts, all alike. False: fewer than 3 points count or they do not fix the motion.
// Cost: O(observations) kSolverSteps times.
bool solve_motion(const stereo::RectifiedPair& pair, const KeyframeView& start, double gate_sigma,
                  Observations& observations, Solution& out);

}  // namespace surefoot::visual_odometry
