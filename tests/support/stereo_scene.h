// Pictures of a made-up scene by two ideal cameras side by side, with the true disparity: stones on
// rough ground, a pattern on many scales that is fixed to them. A pixel is the mean of four rays.
#pragma once

#include <cstdint>
#include <vector>

#include "core/stereo/images.h"

namespace surefoot::tests {

struct StereoSceneOptions {
  std::uint64_t seed = 1;
  std::uint16_t width_px = 320;
  std::uint16_t height_px = 240;
  double focal_px = 260;
  double baseline_m = 0.06;
  double camera_height_m = 0.35;
  double pitch_rad = 0.75;  // downwards
  int stones = 40;
  double contrast = 100;  // grey levels; the pattern's deviation is about a tenth of it
  double grey_noise = 2;  // one sigma
  double right_gain = 1;  // brightness of the right camera
};

// What makes matching easy or hard, from plain to faint and noisy.
struct StereoSurroundings {
  double contrast;
  double grey_noise;
  double right_gain;
};
inline constexpr StereoSurroundings kStereoSurroundings[] = {
    {180, 2, 1.0}, {180, 2, 1.15}, {100, 2, 1.0}, {60, 2, 1.0}, {45, 3, 1.1}};

inline StereoSceneOptions options_in(const StereoSurroundings& around, std::uint64_t seed) {
  StereoSceneOptions options;
  options.seed = seed;
  options.contrast = around.contrast;
  options.grey_noise = around.grey_noise;
  options.right_gain = around.right_gain;
  return options;
}

struct StereoScene {
  std::uint16_t width_px = 0;
  std::uint16_t height_px = 0;
  double focal_px = 0;
  double baseline_m = 0;
  std::vector<std::uint8_t> left;
  std::vector<std::uint8_t> right;
  std::vector<float> disparity_px;  // of the middle of each left pixel

  stereo::GreyView left_view() const { return {left.data(), width_px, height_px}; }
  stereo::GreyView right_view() const { return {right.data(), width_px, height_px}; }
};

StereoScene render_stereo_scene(const StereoSceneOptions& options);

// How good disparities are, over the pixels from `first_column` on whose truth is above 0.
struct DisparityQuality {
  double density = 0;  // share that has one
  double wrong = 0;    // share of these that is off by more than 2 px
  double rms_px = 0;   // of those within 1 px
};

// `values` in 1/scale px, negative where there is none.
DisparityQuality judge_disparities(const std::int16_t* values, double scale,
                                   const std::vector<float>& truth_px, std::size_t width_px,
                                   std::size_t first_column);

}  // namespace surefoot::tests
