// The sums of one Gauss-Newton step on the point-to-plane error of paper 001, section II, footnote:
// E = sum w ((R p + T - q) . n)^2.
#pragma once

#include "core/math/linear.h"

namespace surefoot::registration {

// A source surfel at its present place and the target surfel it is compared with.
struct Pair {
  Vector3 p_m = Vector3::Zero();  // R p + T
  Vector3 q_m = Vector3::Zero();
  Vector3 normal = Vector3::UnitZ();
  double variance_m2 = 1;         // of the residual, by what is known of the surfels
  double tilt_variance_rad2 = 0;  // of the normal, per tangent direction
};

inline double residual_m(const Pair& pair) { return (pair.p_m - pair.q_m).dot(pair.normal); }

// d residual / d (t, w), for a small displacement t [m] and a small rotation w [rad] about
// `centre_m`, both in the target's axes: p -> p + t + w x (p - centre).
inline Vector6 jacobian(const Pair& pair, const Vector3& centre_m) {
  Vector6 row;
  row << pair.normal, (pair.p_m - centre_m).cross(pair.normal);
  return row;
}

// Sums of the pairs. Rotations are measured about `centre_m` and in units that move the points by
// one metre, so that all six unknowns compare: u = (t, lever_m w).
struct NormalEquations {
  Vector3 centre_m = Vector3::Zero();
  double lever_m = 1;  // rms distance of the points from the centre
  Matrix6 information = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();  // information * u = gradient is the undisturbed step
  // What `information` holds on average only because the normals are noisy, as an upper bound: the
  // information of the tilts, taken in all directions.
  Matrix6 feigned = Matrix6::Zero();
};

// In the order of the pairs. `weights` of each pair include 1 / variance [1/m^2].
// Without any weight: all zero.
NormalEquations sum_up(const Pair* pairs, const double* weights, std::size_t count);

}  // namespace surefoot::registration
