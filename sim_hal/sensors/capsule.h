// The robot's links as cameras see them.
#pragma once

#include "core/math/linear.h"

namespace surefoot::sim {

// A sphere swept from a to b; a == b is a sphere.
struct Capsule {
  Vector3 a_m = Vector3::Zero();
  Vector3 b_m = Vector3::Zero();
  double radius_m = 0;
};

// Smallest t > 0 at which t * direction (from the origin, outside the capsule) is on its surface.
double cast_capsule(const Capsule& capsule, const Vector3& direction);

// Directions (x, y, 1) in which a camera at the origin, looking along z, may see a capsule.
struct CapsuleBounds {
  double x_low = 0;
  double x_high = 0;
  double y_low = 0;
  double y_high = 0;

  bool contains(double x, double y) const {
    return x >= x_low && x <= x_high && y >= y_low && y <= y_high;
  }
};

// Conservative: the box around both end spheres. Nothing behind the camera, everything where the
// capsule reaches its plane.
CapsuleBounds bounds_of(const Capsule& capsule_C);

}  // namespace surefoot::sim
