// Where a patch lies in another picture, to fractions of a pixel: inverse compositional alignment
// (Baker and Matthews 2004), with gain and offset of the brightness taken out.
#pragma once

#include <array>

#include "core/math/linear.h"
#include "core/stereo/images.h"
#include "core/visual_odometry/features.h"

namespace surefoot::visual_odometry {

using Matrix2 = Eigen::Matrix<double, 2, 2>;

inline constexpr int kAlignmentSteps = 8;

// The compared part of a patch and its slope in u and v, without their mean and without what looks
// like a change of brightness.
struct Template {
  std::array<double, kComparePixels> grey{};
  std::array<double, kComparePixels> slope_u{};
  std::array<double, kComparePixels> slope_v{};
  double squares = 0;  // sum of grey^2
};

// False: the patch is plain.
bool make_template(const Patch& patch, Template& out);

struct Alignment {
  Vector2 at_px = Vector2::Zero();
  double similarity = 0;   // correlation there, -1 to 1
  double information = 0;  // smaller eigenvalue of the sum of the slopes' products, grey^2 / px^2
};

// The middle of the patch in `picture`, from `start_px` on; `warp` maps offsets in the patch to
// offsets in the picture. False: it leaves the picture, moves by more than max_move_px or ends on
// no texture. Cost: at most kAlignmentSteps times kComparePixels interpolations.
bool align(const Template& patch, const Matrix2& warp, const stereo::GreyView& picture,
           const Vector2& start_px, double max_move_px, Alignment& out);

// The same along the row of a right picture, with the slopes of the surface: the patch's pixel
// (du, dv) is at u_px - disparity - per_u du - per_v dv. Variance by `grey_noise` alone.
struct DisparityFit {
  double disparity_px = 0;
  double per_u = 0;
  double per_v = 0;
  double similarity = 0;
  double variance_px2 = 0;
};
bool fit_disparity(const Template& patch, const stereo::GreyView& right, const Feature& feature,
                   double start_px, double grey_noise, DisparityFit& out);

}  // namespace surefoot::visual_odometry
