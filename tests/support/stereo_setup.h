// The recommended settings of core/stereo, as in its README.
#pragma once

#include "core/stereo/matcher_config.h"
#include "core/stereo/point_cloud.h"

namespace surefoot::tests {

inline stereo::MatcherConfig recommended_matcher() {
  stereo::MatcherConfig config;
  config.min_disparity_px = 0;
  config.disparities = 64;
  config.step_penalty = 5;
  config.jump_penalty = 40;
  config.edge_relief = 16;
  config.uniqueness_percent = 5;
  config.left_right_tolerance_px = 1;
  config.min_contrast = 8;
  config.speckle_pixels = 50;
  config.speckle_step_px = 1;
  config.smooth_radius_px = 2;
  return config;
}

inline stereo::DisparityNoise recommended_noise() {
  stereo::DisparityNoise noise;
  noise.disparity_floor_px = 0.08;
  noise.grey_noise = 4.5;
  noise.relief_share = 0.15;
  return noise;
}

inline stereo::PointConfig recommended_points() {
  stereo::PointConfig config;
  config.stride = 1;
  config.min_range_m = 0.1;
  config.max_range_m = 3.0;
  config.noise = recommended_noise();
  return config;
}

}  // namespace surefoot::tests
