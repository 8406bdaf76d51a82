// The recommended settings of core/visual_odometry, as in its README.
#pragma once

#include "core/visual_odometry/config.h"

namespace surefoot::tests {

inline visual_odometry::VisualOdometryConfig recommended_visual_odometry() {
  visual_odometry::VisualOdometryConfig config;
  config.min_corner = 1;
  config.min_disparity_px = 1;
  config.max_disparity_px = 64;
  config.min_similarity = 0.7;
  config.disparity_noise_px = 0.1;
  config.search_px = 8;
  config.max_step_m = 0.05;
  config.gate_sigma = 3;
  config.track_noise_px = 0.08;
  config.grey_noise = 2.5;
  config.min_inliers = 15;
  config.min_inlier_share = 0.7;
  config.gyro_tolerance_rad = 0.03;
  config.keep_share = 0.5;
  config.keep_parallax = 0.15;
  config.keep_turn_rad = 0.2;
  config.max_failures = 2;
  return config;
}

}  // namespace surefoot::tests
