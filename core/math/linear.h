// Fixed-size linear algebra types used throughout core.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

namespace surefoot {

using Vector2 = Eigen::Matrix<double, 2, 1>;
using Vector3 = Eigen::Matrix<double, 3, 1>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix3 = Eigen::Matrix<double, 3, 3>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

namespace math {

// In the plane: of a x b along the third axis; positive: b lies to the left of a.
inline double cross(const Vector2& a, const Vector2& b) { return a[0] * b[1] - a[1] * b[0]; }
// Turned by a quarter to the left.
inline Vector2 left_of(const Vector2& v) { return {-v[1], v[0]}; }

}  // namespace math

}  // namespace surefoot
