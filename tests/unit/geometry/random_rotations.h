// Seeded rotations and vectors for the geometry tests.
#pragma once

#include "core/base/random.h"
#include "core/geometry/rotations.h"

namespace surefoot::geometry {

inline Vector3 random_vector(Random& random, double size) {
  const double x = random.uniform(-size, size);
  const double y = random.uniform(-size, size);
  const double z = random.uniform(-size, size);
  return {x, y, z};
}

// Evenly over all rotations: a point of the unit ball of quaternions, scaled to length one.
inline Quaternion random_quaternion(Random& random) {
  for (;;) {
    const double w = random.uniform(-1, 1);
    const double x = random.uniform(-1, 1);
    const double y = random.uniform(-1, 1);
    const double z = random.uniform(-1, 1);
    const double square = w * w + x * x + y * y + z * z;
    if (square > 0.01 && square < 1) return normalised({w, x, y, z});
  }
}

inline Matrix3 random_rotation(Random& random) { return to_matrix(random_quaternion(random)); }

// Greatest difference of two matrices' or vectors' entries.
template <class A, class B>
double distance(const A& a, const B& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

}  // namespace surefoot::geometry
