#include "sim_hal/sensors/capsule.h"

#include <algorithm>
#include <cmath>

#include "sim_hal/world/ray.h"

namespace surefoot::sim {

namespace {

constexpr double kNearest_m = 0.01;  // along the axis

// Both z-depth rays and the capsule live in C: hits at z = t because direction.z = 1.
double cast_sphere(const Vector3& centre, double radius, const Vector3& direction) {
  const double a = direction.squaredNorm();
  const double b = direction.dot(centre);
  const double c = centre.squaredNorm() - radius * radius;
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return kNoHit;
  const double t = (b - std::sqrt(discriminant)) / a;
  return t > 0 ? t : kNoHit;
}

double cast_cylinder(const Capsule& capsule, const Vector3& direction) {
  const Vector3 axis = capsule.b_m - capsule.a_m;
  const double axis2 = axis.squaredNorm();
  if (axis2 == 0) return kNoHit;
  const double direction_axis = direction.dot(axis);
  const double a_axis = capsule.a_m.dot(axis);
  // |t d - a|^2 off the axis, times axis2.
  const double qa = axis2 * direction.squaredNorm() - direction_axis * direction_axis;
  const double qb = axis2 * direction.dot(capsule.a_m) - direction_axis * a_axis;
  const double qc =
      axis2 * (capsule.a_m.squaredNorm() - capsule.radius_m * capsule.radius_m) - a_axis * a_axis;
  const double discriminant = qb * qb - qa * qc;
  if (discriminant < 0 || qa <= 0) return kNoHit;
  const double t = (qb - std::sqrt(discriminant)) / qa;
  const double along = t * direction_axis - a_axis;
  return t > 0 && along >= 0 && along <= axis2 ? t : kNoHit;
}

// Extent of x / z over a ball around (x, z).
void ratio_bounds(double x, double z, double r, double& low, double& high) {
  for (const double depth : {z - r, z + r}) {
    low = std::min(low, (x - r) / depth);
    high = std::max(high, (x + r) / depth);
  }
}

}  // namespace

double cast_capsule(const Capsule& capsule, const Vector3& direction) {
  const double side = cast_cylinder(capsule, direction);
  const double a = cast_sphere(capsule.a_m, capsule.radius_m, direction);
  const double b = cast_sphere(capsule.b_m, capsule.radius_m, direction);
  return std::min(side, std::min(a, b));
}

CapsuleBounds bounds_of(const Capsule& capsule_C) {
  const double r = capsule_C.radius_m;
  const double nearest = std::min(capsule_C.a_m.z(), capsule_C.b_m.z()) - r;
  CapsuleBounds bounds{kNoHit, -kNoHit, kNoHit, -kNoHit};
  if (std::max(capsule_C.a_m.z(), capsule_C.b_m.z()) + r < kNearest_m) return bounds;
  if (nearest < kNearest_m) return {-kNoHit, kNoHit, -kNoHit, kNoHit};
  for (const Vector3& p : {capsule_C.a_m, capsule_C.b_m}) {
    ratio_bounds(p.x(), p.z(), r, bounds.x_low, bounds.x_high);
    ratio_bounds(p.y(), p.z(), r, bounds.y_low, bounds.y_high);
  }
  return bounds;
}

}  // namespace surefoot::sim
