// Sums over the points of a cell, and the plane through them.
#pragma once

#include "core/math/linear.h"

namespace surefoot::registration {

// Count, sum and second moments about a centre that the owner knows. Adding is exact enough in
// double for any number of points that a cell can see (2^40 points, moments of one cell's size).
struct Moments {
  double count = 0;
  Vector3 sum_m = Vector3::Zero();
  double xx = 0;  // second moments [m^2]
  double xy = 0;
  double xz = 0;
  double yy = 0;
  double yz = 0;
  double zz = 0;

  void add(const Vector3& offset_m);
  // Adds `other`, times `weight`, whose centre lies `offset_m` from this one's.
  void add(const Moments& other, const Vector3& offset_m, double weight);
  Vector3 mean_m() const { return sum_m / count; }
};

// The plane of least squares through the points of a Moments with count > 0.
struct PlaneFit {
  Vector3 centre_m = Vector3::Zero();
  Vector3 normal = Vector3::UnitZ();  // unit length; which of the two sides is arbitrary
  // Eigenvalues of the covariance, ascending [m^2]: across the plane, then along it.
  double across_m2 = 0;
  double narrow_m2 = 0;
  double wide_m2 = 0;
};
PlaneFit fit_plane(const Moments& moments);

}  // namespace surefoot::registration
