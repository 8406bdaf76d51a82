// What can be tuned about visual odometry. Recommended values: README.md.
#pragma once

#include <cstdint>

#include "core/base/parameters.h"
#include "core/base/status.h"

namespace surefoot::visual_odometry {

// Defaults are none on purpose (core/base/parameters.h).
struct VisualOdometryConfig {
  // Corners and their depth
  double min_corner = 0;
  double min_disparity_px = 0;
  double max_disparity_px = 0;
  double min_similarity = 0;
  double disparity_noise_px = 0;
  // Matching
  double search_px = 0;
  double max_step_m = 0;
  double gate_sigma = 0;
  // Motion
  double track_noise_px = 0;
  double grey_noise = 0;
  std::int32_t min_inliers = 0;
  double min_inlier_share = 0;
  double gyro_tolerance_rad = 0;
  // Keyframes
  double keep_share = 0;
  double keep_parallax = 0;
  double keep_turn_rad = 0;
  std::int32_t max_failures = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("min_corner", self.min_corner, {0.1, 1e4},
               "smaller eigenvalue of a corner's mean gradient tensor, grey^2 / px^2");
    visit.real("min_disparity_px", self.min_disparity_px, {0.1, 200.0}, "farther is not used");
    visit.real("max_disparity_px", self.max_disparity_px, {8.0, 255.0}, "nearer is not found");
    visit.real("min_similarity", self.min_similarity, {0.0, 0.99},
               "correlation of two patches that may show the same");
    visit.real("disparity_noise_px", self.disparity_noise_px, {0.01, 2.0},
               "one sigma of a corner's disparity where contrast is high");
    visit.real("search_px", self.search_px, {1.0, 100.0},
               "how far a corner may lie from where the prediction puts it, besides max_step_m");
    visit.real("max_step_m", self.max_step_m, {0.001, 2.0},
               "how far the camera may come from where the prediction puts it, between pictures");
    visit.real("gate_sigma", self.gate_sigma, {1.0, 10.0},
               "distances and places farther off do not agree");
    visit.real("track_noise_px", self.track_noise_px, {0.01, 2.0},
               "one sigma of a tracked place where contrast is high");
    visit.real("grey_noise", self.grey_noise, {0.0, 50.0}, "one sigma of a pixel, grey levels");
    visit.integer("min_inliers", self.min_inliers, {6, 400}, "fewer are no motion");
    visit.real("min_inlier_share", self.min_inlier_share, {0.0, 1.0},
               "of what was tracked that must agree");
    visit.real("gyro_tolerance_rad", self.gyro_tolerance_rad, {0.001, 1.0},
               "a motion whose turn is farther from the predicted one is not believed");
    visit.real("keep_share", self.keep_share, {0.05, 1.0},
               "of the keyframe's points that must agree for it to stay");
    visit.real("keep_parallax", self.keep_parallax, {0.005, 1.0},
               "displacement over the points' median depth up to which it stays");
    visit.real("keep_turn_rad", self.keep_turn_rad, {0.005, 1.0}, "turn up to which it stays");
    visit.integer("max_failures", self.max_failures, {0, 100},
                  "pictures in a row without motion before it is given up");
  }
};

// kInvalid: a value is outside describe()'s range, or the disparities are in the wrong order.
Status validate(const VisualOdometryConfig& config);

}  // namespace surefoot::visual_odometry
