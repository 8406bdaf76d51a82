// Places of what was matched, with their uncertainty.
#pragma once

#include <cstdint>

#include "core/base/fixed_vector.h"
#include "core/base/parameters.h"
#include "core/base/status.h"
#include "core/math/linear.h"
#include "core/stereo/calibration.h"
#include "core/stereo/images.h"

namespace surefoot::stereo {

inline constexpr std::size_t kMaxPoints = 320 * 240;

// How sure a disparity is.
struct DisparityNoise {
  double disparity_floor_px = 0;
  double grey_noise = 0;
  double relief_share = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("disparity_floor_px", self.disparity_floor_px, {0.001, 2.0},
               "one sigma of a disparity where contrast is high");
    visit.real("grey_noise", self.grey_noise, {0.0, 100.0},
               "one sigma of a disparity, in pixels, times the grey levels of contrast");
    visit.real("relief_share", self.relief_share, {0.0, 4.0},
               "one sigma of a disparity per pixel by which the surface around it is no plane");
  }
};

struct PointConfig {
  std::uint8_t stride = 1;
  double min_range_m = 0;  // z in N
  double max_range_m = 0;
  DisparityNoise noise;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.integer("stride", self.stride, {1, 16}, "every n-th pixel and row becomes a point");
    visit.real("min_range_m", self.min_range_m, {0.01, 100.0}, "nearest point along the axis");
    visit.real("max_range_m", self.max_range_m, {0.01, 1000.0}, "farthest point along the axis");
    DisparityNoise::describe(self.noise, visit);
  }
};

struct StereoPoint {
  Vector3 p_N_m = Vector3::Zero();
  double variance_m2 = 0;  // of z: the place moves along its ray with the disparity
  std::uint16_t u_px = 0;
  std::uint16_t v_px = 0;
};

using PointCloud = FixedVector<StereoPoint, kMaxPoints>;

// Variance of the disparity at a pixel that has one, floor^2 + (grey_noise / contrast)^2 +
// (relief_share * relief)^2. The relief says by how much the disparities kReliefReach_px to both
// sides and above and below leave the line through the pixel: the windows of census and smoothing
// take such a surface for a plane. Neighbours beyond the picture or without disparity tell nothing.
inline constexpr std::size_t kReliefReach_px = 3;
double disparity_variance_px2(const DisparityImage& image, std::size_t u, std::size_t v,
                              const DisparityNoise& noise);

// Whether something farther away, by more than step_px of disparity, lies within rim_px of the
// pixel, along the row or the column: census and smoothing see the nearer surface wherever it fills
// part of their window, so that what stands in front grows by about that much. Pixels without
// disparity tell nothing; the pixel itself must have one.
bool is_foreground_rim(const DisparityImage& image, std::size_t u, std::size_t v,
                       std::size_t rim_px, double step_px);

// sigma_z = z^2 / (focal baseline) sigma_d.
// kExhausted: kMaxPoints reached, the rows below are left out. kInvalid: sizes differ, or a value
// of the configuration is out of range; the cloud is empty then. Cost: O(pixels).
Status make_points(const DisparityImage& image, const RectifiedPair& pair,
                   const PointConfig& config, PointCloud& out);

}  // namespace surefoot::stereo
