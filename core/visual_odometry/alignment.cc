#include "core/visual_odometry/alignment.h"

#include "core/math/elementary.h"

namespace surefoot::visual_odometry {
namespace {

using Samples = std::array<double, kComparePixels>;

constexpr double kSettled_px = 0.005;
constexpr double kMaxDisparityMove_px = 1.5;
constexpr double kMaxSlope = 0.6;        // px of disparity per px
constexpr double kExpectedSlope = 0.15;  // one sigma of it
constexpr double kMinInformation = 50;   // grey^2 / px^2: texture of a third of a grey level

// Calls visit(index, du, dv) for the compared pixels in reading order.
template <class Visit>
void for_each_pixel(Visit&& visit) {
  std::size_t i = 0;
  for (int dv = -kCompareRadius_px; dv <= kCompareRadius_px; ++dv) {
    for (int du = -kCompareRadius_px; du <= kCompareRadius_px; ++du) visit(i++, du, dv);
  }
}

void remove_mean(Samples& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  const double mean = sum / kComparePixels;
  for (double& value : values) value -= mean;
}

double dot(const Samples& a, const Samples& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

void remove_share(const Samples& of, double squares, Samples& from) {
  const double share = dot(of, from) / squares;
  for (std::size_t i = 0; i < from.size(); ++i) from[i] -= share * of[i];
}

// Bilinear; the place and its right and lower neighbours lie in the picture.
double sample(const stereo::GreyView& picture, double u, double v) {
  const auto left = static_cast<std::size_t>(u);
  const auto top = static_cast<std::size_t>(v);
  const double wu = u - static_cast<double>(left);
  const double wv = v - static_cast<double>(top);
  const std::uint8_t* upper = picture.row(top) + left;
  const std::uint8_t* lower = upper + picture.width_px;
  const double above = upper[0] + wu * (upper[1] - upper[0]);
  const double below = lower[0] + wu * (lower[1] - lower[0]);
  return above + wv * (below - above);
}

// Written so that a NaN is outside.
bool inside(const stereo::GreyView& picture, double u, double v) {
  return u >= 0 && v >= 0 && u < picture.width_px - 1.0 && v < picture.height_px - 1.0;
}

// Whether a patch that is warped like this lies inside: its corners do.
bool patch_inside(const stereo::GreyView& picture, const Matrix2& warp, const Vector2& at) {
  constexpr double kReach = kCompareRadius_px;
  const Vector2 a = warp * Vector2(kReach, kReach);
  const Vector2 b = warp * Vector2(kReach, -kReach);
  return inside(picture, at.x() + a.x(), at.y() + a.y()) &&
         inside(picture, at.x() - a.x(), at.y() - a.y()) &&
         inside(picture, at.x() + b.x(), at.y() + b.y()) &&
         inside(picture, at.x() - b.x(), at.y() - b.y());
}

void sample_patch(const stereo::GreyView& picture, const Matrix2& warp, const Vector2& at,
                  Samples& out) {
  for_each_pixel([&](std::size_t i, int du, int dv) {
    const double u = at.x() + warp(0, 0) * du + warp(0, 1) * dv;
    const double v = at.y() + warp(1, 0) * du + warp(1, 1) * dv;
    out[i] = sample(picture, u, v);
  });
  remove_mean(out);
}

// What `seen` differs by from the patch once its gain is taken out, and how alike both are.
struct Comparison {
  double similarity = 0;
  double inverse_gain = 0;
};
Comparison compare(const Template& patch, const Samples& seen) {
  const double common = dot(patch.grey, seen);
  const double squares = dot(seen, seen);
  if (!(squares > kMinInformation) || !(common > 0)) return {};
  return {common / math::sqrt(squares * patch.squares), patch.squares / common};
}

double smaller_eigenvalue(const Matrix2& m) {
  const double half = 0.5 * (m(0, 0) - m(1, 1));
  return 0.5 * (m(0, 0) + m(1, 1)) - math::sqrt(half * half + m(0, 1) * m(0, 1));
}

}  // namespace

bool make_template(const Patch& patch, Template& out) {
  if (patch.inverse_norm == 0) return false;
  for_each_pixel([&](std::size_t i, int du, int dv) {
    out.grey[i] = patch.at(du, dv);
    out.slope_u[i] = 0.5 * (patch.at(du + 1, dv) - patch.at(du - 1, dv));
    out.slope_v[i] = 0.5 * (patch.at(du, dv + 1) - patch.at(du, dv - 1));
  });
  remove_mean(out.grey);
  out.squares = dot(out.grey, out.grey);
  for (Samples* slope : {&out.slope_u, &out.slope_v}) {
    remove_mean(*slope);
    remove_share(out.grey, out.squares, *slope);
  }
  return true;
}

bool align(const Template& patch, const Matrix2& warp, const stereo::GreyView& picture,
           const Vector2& start_px, double max_move_px, Alignment& out) {
  Matrix2 information;
  information(0, 0) = dot(patch.slope_u, patch.slope_u);
  information(0, 1) = dot(patch.slope_u, patch.slope_v);
  information(1, 0) = information(0, 1);
  information(1, 1) = dot(patch.slope_v, patch.slope_v);
  out.information = smaller_eigenvalue(information);
  if (!(out.information > kMinInformation)) return false;
  const Matrix2 inverse = information.inverse();
  out.at_px = start_px;
  Samples seen;
  for (int step = 0; step <= kAlignmentSteps; ++step) {
    if (!patch_inside(picture, warp, out.at_px)) return false;
    sample_patch(picture, warp, out.at_px, seen);
    const Comparison now = compare(patch, seen);
    if (now.inverse_gain == 0) return false;
    out.similarity = now.similarity;
    if (step == kAlignmentSteps) break;
    // The slopes hold none of the patch itself, so only what is seen counts.
    const Vector2 pull =
        now.inverse_gain * Vector2(dot(patch.slope_u, seen), dot(patch.slope_v, seen));
    const Vector2 move = inverse * pull;
    out.at_px -= warp * move;
    if (!((out.at_px - start_px).squaredNorm() <= math::square(max_move_px))) return false;
    if (move.squaredNorm() < math::square(kSettled_px)) break;
  }
  return true;
}

namespace {

// d grey / d (disparity, per_u, per_v) of the patch, brightness taken out.
struct DisparityJacobian {
  std::array<Samples, 3> columns;
  Matrix3 inverse = Matrix3::Zero();
};

bool make_jacobian(const Template& patch, double grey_noise, DisparityJacobian& out) {
  for_each_pixel([&](std::size_t i, int du, int dv) {
    out.columns[0][i] = patch.slope_u[i];
    out.columns[1][i] = patch.slope_u[i] * du;
    out.columns[2][i] = patch.slope_u[i] * dv;
  });
  Matrix3 information;
  for (std::size_t column = 1; column < 3; ++column) {
    remove_mean(out.columns[column]);
    remove_share(patch.grey, patch.squares, out.columns[column]);
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      information(i, j) =
          dot(out.columns[static_cast<std::size_t>(i)], out.columns[static_cast<std::size_t>(j)]);
    }
  }
  if (!(information(0, 0) > kMinInformation)) return false;
  const double prior = (1.0 + math::square(grey_noise)) / math::square(kExpectedSlope);
  information(1, 1) += prior;
  information(2, 2) += prior;
  out.inverse = information.inverse();
  return out.inverse(0, 0) > 0;
}

}  // namespace

bool fit_disparity(const Template& patch, const stereo::GreyView& right, const Feature& feature,
                   double start_px, double grey_noise, DisparityFit& out) {
  DisparityJacobian jacobian;
  if (!make_jacobian(patch, grey_noise, jacobian)) return false;
  const double prior = (1.0 + math::square(grey_noise)) / math::square(kExpectedSlope);
  Vector3 fit(start_px, 0, 0);
  Samples seen;
  for (int step = 0; step <= kAlignmentSteps; ++step) {
    Matrix2 warp = Matrix2::Identity();
    warp(0, 0) -= fit[1];
    warp(0, 1) = -fit[2];
    const Vector2 at(feature.u_px - fit[0], feature.v_px);
    if (!patch_inside(right, warp, at)) return false;
    sample_patch(right, warp, at, seen);
    const Comparison now = compare(patch, seen);
    if (now.inverse_gain == 0) return false;
    out.similarity = now.similarity;
    if (step == kAlignmentSteps) break;
    Vector3 pull;
    for (int i = 0; i < 3; ++i) {
      pull[i] = now.inverse_gain * dot(jacobian.columns[static_cast<std::size_t>(i)], seen);
    }
    pull[1] -= prior * fit[1];
    pull[2] -= prior * fit[2];
    const Vector3 move = jacobian.inverse * pull;
    fit += move;
    if (!(math::magnitude(fit[0] - start_px) <= kMaxDisparityMove_px)) return false;
    if (math::magnitude(fit[1]) > kMaxSlope || math::magnitude(fit[2]) > kMaxSlope) return false;
    if (math::magnitude(move[0]) < kSettled_px) break;
  }
  out.disparity_px = fit[0];
  out.per_u = fit[1];
  out.per_v = fit[2];
  out.variance_px2 = math::square(grey_noise) * jacobian.inverse(0, 0);
  return true;
}

}  // namespace surefoot::visual_odometry
