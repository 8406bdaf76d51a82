#include "core/registration/normal_equations.h"

#include <cstddef>

#include "core/geometry/rotations.h"
#include "core/math/elementary.h"

namespace surefoot::registration {
namespace {

// Centre and lever of the weighted points.
void find_scale(const Pair* pairs, const double* weights, std::size_t count, NormalEquations& out) {
  double total = 0;
  double squares = 0;
  Vector3 sum = Vector3::Zero();
  const Vector3 origin_m = pairs[0].p_m;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3 offset_m = pairs[i].p_m - origin_m;
    total += weights[i];
    sum += weights[i] * offset_m;
    squares += weights[i] * offset_m.squaredNorm();
  }
  if (!(total > 0)) return;
  const Vector3 mean_m = sum / total;
  out.centre_m = origin_m + mean_m;
  const double lever2_m2 = squares / total - mean_m.squaredNorm();
  out.lever_m = lever2_m2 > 1e-12 ? math::sqrt(lever2_m2) : 1e-6;
}

}  // namespace

NormalEquations sum_up(const Pair* pairs, const double* weights, std::size_t count) {
  NormalEquations out;
  if (count == 0) return out;
  find_scale(pairs, weights, count, out);
  double tilt = 0;
  Vector3 tilt_arm = Vector3::Zero();
  Matrix3 tilt_arms = Matrix3::Zero();
  const double per_lever = 1.0 / out.lever_m;
  for (std::size_t i = 0; i < count; ++i) {
    const double weight = weights[i];
    if (!(weight > 0)) continue;
    Vector6 row = jacobian(pairs[i], out.centre_m);
    for (int k = 3; k < 6; ++k) row[k] *= per_lever;
    const Vector6 weighted = weight * row;
    for (int column = 0; column < 6; ++column) {
      for (int line = 0; line <= column; ++line) {
        out.information(line, column) += weighted[line] * row[column];
      }
    }
    out.gradient -= residual_m(pairs[i]) * weighted;
    const Vector3 arm = (pairs[i].p_m - out.centre_m) * per_lever;
    const double share = weight * pairs[i].tilt_variance_rad2;
    tilt += share;
    tilt_arm += share * arm;
    tilt_arms += share * arm * arm.transpose();
  }
  for (int column = 0; column < 6; ++column) {
    for (int line = column + 1; line < 6; ++line) {
      out.information(line, column) = out.information(column, line);
    }
  }
  // A point moves by t + w x arm: the sum of G' G with G = [I, -arm x].
  const Matrix3 arm_cross = geometry::cross_matrix(tilt_arm);
  out.feigned.topLeftCorner<3, 3>() = tilt * Matrix3::Identity();
  out.feigned.topRightCorner<3, 3>() = -arm_cross;
  out.feigned.bottomLeftCorner<3, 3>() = arm_cross;
  out.feigned.bottomRightCorner<3, 3>() = tilt_arms.trace() * Matrix3::Identity() - tilt_arms;
  return out;
}

}  // namespace surefoot::registration
