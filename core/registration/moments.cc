#include "core/registration/moments.h"

#include <array>
#include <cstddef>

#include "core/math/elementary.h"

namespace surefoot::registration {
namespace {

constexpr int kNewtonSteps = 24;

// The smallest root of x^3 - a x^2 + b x - c, all of whose roots are real and not negative, by
// Newton's method from 0: left of the first root the cubic is concave and rising, so that the steps
// go up and never beyond it. The trace a is 1. A double root is approached by halves; then there is
// no plane anyhow.
double smallest_root(double b, double c) {
  double x = 0;
  for (int step = 0; step < kNewtonSteps; ++step) {
    const double value = ((x - 1.0) * x + b) * x - c;
    const double slope = (3.0 * x - 2.0) * x + b;
    if (!(slope > 0) || !(value < 0)) break;
    const double next = x - value / slope;
    if (!(next > x)) break;
    x = next;
  }
  return x;
}

// A vector that all three rows are perpendicular to: the longest of their cross products.
Vector3 null_vector(const Matrix3& rows) {
  const std::array<Vector3, 3> candidates = {rows.row(0).cross(rows.row(1)).transpose(),
                                             rows.row(1).cross(rows.row(2)).transpose(),
                                             rows.row(2).cross(rows.row(0)).transpose()};
  std::size_t longest = 0;
  for (std::size_t i = 1; i < candidates.size(); ++i) {
    if (candidates[i].squaredNorm() > candidates[longest].squaredNorm()) longest = i;
  }
  const double length = math::sqrt(candidates[longest].squaredNorm());
  if (!(length > 0)) return Vector3::UnitZ();
  return candidates[longest] / length;
}

}  // namespace

void Moments::add(const Vector3& offset_m) {
  count += 1.0;
  sum_m += offset_m;
  xx += offset_m.x() * offset_m.x();
  xy += offset_m.x() * offset_m.y();
  xz += offset_m.x() * offset_m.z();
  yy += offset_m.y() * offset_m.y();
  yz += offset_m.y() * offset_m.z();
  zz += offset_m.z() * offset_m.z();
}

void Moments::add(const Moments& other, const Vector3& offset_m, double weight) {
  // Of p = q + o over the points q: sum p p' = sum q q' + sum q o' + o sum (q + o)'.
  const Vector3& s = other.sum_m;
  const Vector3& o = offset_m;
  const Vector3 shifted = s + other.count * o;
  count += weight * other.count;
  sum_m += weight * shifted;
  xx += weight * (other.xx + s.x() * o.x() + o.x() * shifted.x());
  xy += weight * (other.xy + s.x() * o.y() + o.x() * shifted.y());
  xz += weight * (other.xz + s.x() * o.z() + o.x() * shifted.z());
  yy += weight * (other.yy + s.y() * o.y() + o.y() * shifted.y());
  yz += weight * (other.yz + s.y() * o.z() + o.y() * shifted.z());
  zz += weight * (other.zz + s.z() * o.z() + o.z() * shifted.z());
}

PlaneFit fit_plane(const Moments& moments) {
  PlaneFit fit;
  fit.centre_m = moments.mean_m();
  const Vector3& m = fit.centre_m;
  const double xx = moments.xx / moments.count - m.x() * m.x();
  const double yy = moments.yy / moments.count - m.y() * m.y();
  const double zz = moments.zz / moments.count - m.z() * m.z();
  const double trace_m2 = xx + yy + zz;
  if (!(trace_m2 > 0)) return fit;  // one point, or all in one place
  const double scale = 1.0 / trace_m2;
  const double xy = scale * (moments.xy / moments.count - m.x() * m.y());
  const double xz = scale * (moments.xz / moments.count - m.x() * m.z());
  const double yz = scale * (moments.yz / moments.count - m.y() * m.z());
  Matrix3 covariance;
  covariance << scale * xx, xy, xz, xy, scale * yy, yz, xz, yz, scale * zz;
  const Matrix3& c = covariance;
  const double minors =
      c(0, 0) * c(1, 1) - xy * xy + c(0, 0) * c(2, 2) - xz * xz + c(1, 1) * c(2, 2) - yz * yz;
  const double determinant = c(0, 0) * (c(1, 1) * c(2, 2) - yz * yz) -
                             xy * (xy * c(2, 2) - yz * xz) + xz * (xy * yz - c(1, 1) * xz);
  const double smallest = smallest_root(minors, determinant);
  // The others: their sum is 1 - smallest, their product minors - smallest (1 - smallest).
  const double half_sum = 0.5 * (1.0 - smallest);
  const double square = half_sum * half_sum - (minors - smallest * (1.0 - smallest));
  const double half_difference = square > 0 ? math::sqrt(square) : 0.0;
  fit.across_m2 = trace_m2 * smallest;
  fit.narrow_m2 = trace_m2 * (half_sum - half_difference);
  fit.wide_m2 = trace_m2 * (half_sum + half_difference);
  fit.normal = null_vector(covariance - smallest * Matrix3::Identity());
  return fit;
}

}  // namespace surefoot::registration
