#include "core/geometry/rotations.h"

#include <cstddef>

#include "core/math/elementary.h"

namespace surefoot::geometry {
namespace {

// Squared angle [rad^2] below which sin(a) / a is 1 to the last bit, and above which squaring has
// not lost anything to underflow.
constexpr double kSmallSquare_rad2 = 1e-30;
// cos(pitch) below which roll and yaw turn about the same axis and only their sum is in the matrix.
constexpr double kGimbalCosine = 1e-12;

Quaternion conjugate(const Quaternion& q) { return {q.w, -q.x, -q.y, -q.z}; }

// The rotation vector of a unit quaternion, shorter way round. [rad]
Vector3 logarithm(const Quaternion& q) {
  const double sign = q.w < 0 ? -1.0 : 1.0;
  const Vector3 axis(sign * q.x, sign * q.y, sign * q.z);
  const double square = axis.squaredNorm();
  if (square < kSmallSquare_rad2) return axis * 2.0;
  const double sine = math::sqrt(square);
  return axis * (2.0 * math::atan2(sine, sign * q.w) / sine);
}

}  // namespace

Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,  //
          a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,  //
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,  //
          a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

Quaternion normalised(const Quaternion& q) {
  const double square = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  if (square == 0) return {};
  const double factor = 1.0 / math::sqrt(square);
  return {q.w * factor, q.x * factor, q.y * factor, q.z * factor};
}

Matrix3 to_matrix(const Quaternion& q) {
  Matrix3 r;
  r << 1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y - q.w * q.z), 2 * (q.x * q.z + q.w * q.y),
      2 * (q.x * q.y + q.w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z - q.w * q.x),
      2 * (q.x * q.z - q.w * q.y), 2 * (q.y * q.z + q.w * q.x), 1 - 2 * (q.x * q.x + q.y * q.y);
  return r;
}

Quaternion to_quaternion(const Matrix3& r) {
  const double trace = r(0, 0) + r(1, 1) + r(2, 2);
  // Four times the squares of w, x, y, z; they add up to 4, so the largest is at least 1.
  const double squares[4] = {1 + trace, 1 + 2 * r(0, 0) - trace, 1 + 2 * r(1, 1) - trace,
                             1 + 2 * r(2, 2) - trace};
  std::size_t largest = 0;
  for (std::size_t i = 1; i < 4; ++i) {
    if (squares[i] > squares[largest]) largest = i;
  }
  const double root = math::sqrt(squares[largest]);
  const double divisor = 0.5 / root;
  Quaternion q;
  switch (largest) {
    case 0:
      q = {0.5 * root, (r(2, 1) - r(1, 2)) * divisor, (r(0, 2) - r(2, 0)) * divisor,
           (r(1, 0) - r(0, 1)) * divisor};
      break;
    case 1:
      q = {(r(2, 1) - r(1, 2)) * divisor, 0.5 * root, (r(0, 1) + r(1, 0)) * divisor,
           (r(0, 2) + r(2, 0)) * divisor};
      break;
    case 2:
      q = {(r(0, 2) - r(2, 0)) * divisor, (r(0, 1) + r(1, 0)) * divisor, 0.5 * root,
           (r(1, 2) + r(2, 1)) * divisor};
      break;
    default:
      q = {(r(1, 0) - r(0, 1)) * divisor, (r(0, 2) + r(2, 0)) * divisor,
           (r(1, 2) + r(2, 1)) * divisor, 0.5 * root};
      break;
  }
  return normalised(q.w < 0 ? Quaternion{-q.w, -q.x, -q.y, -q.z} : q);
}

Quaternion from_rotation_vector(const Vector3& rotation_vector_rad) {
  const double square = rotation_vector_rad.squaredNorm();
  double w = 1;
  double factor = 0.5;
  if (square >= kSmallSquare_rad2) {
    const double angle_rad = math::sqrt(square);
    const math::SinCos half = math::sin_cos(0.5 * angle_rad);
    w = half.cos;
    factor = half.sin / angle_rad;
  }
  return normalised({w, factor * rotation_vector_rad.x(), factor * rotation_vector_rad.y(),
                     factor * rotation_vector_rad.z()});
}

Vector3 to_rotation_vector(const Matrix3& rotation) { return logarithm(to_quaternion(rotation)); }

Matrix3 from_roll_pitch_yaw(double roll_rad, double pitch_rad, double yaw_rad) {
  const math::SinCos r = math::sin_cos(roll_rad);
  const math::SinCos p = math::sin_cos(pitch_rad);
  const math::SinCos y = math::sin_cos(yaw_rad);
  Matrix3 rotation;
  rotation << y.cos * p.cos, y.cos * p.sin * r.sin - y.sin * r.cos,
      y.cos * p.sin * r.cos + y.sin * r.sin,  //
      y.sin * p.cos, y.sin * p.sin * r.sin + y.cos * r.cos,
      y.sin * p.sin * r.cos - y.cos * r.sin,  //
      -p.sin, p.cos * r.sin, p.cos * r.cos;
  return rotation;
}

Vector3 to_roll_pitch_yaw(const Matrix3& r) {
  const double cos_pitch = math::sqrt(r(0, 0) * r(0, 0) + r(1, 0) * r(1, 0));
  const double pitch_rad = math::atan2(-r(2, 0), cos_pitch);
  if (cos_pitch < kGimbalCosine) return {0, pitch_rad, math::atan2(-r(0, 1), r(1, 1))};
  const double yaw_rad = math::atan2(r(1, 0), r(0, 0));
  // Roll from the axes turned back by that very yaw: near the singularity yaw is uncertain, and
  // taking roll from the last row alone would not undo its error.
  const double sin_yaw = r(1, 0) / cos_pitch;
  const double cos_yaw = r(0, 0) / cos_pitch;
  const double roll_rad =
      math::atan2(sin_yaw * r(0, 2) - cos_yaw * r(1, 2), cos_yaw * r(1, 1) - sin_yaw * r(0, 1));
  return {roll_rad, pitch_rad, yaw_rad};
}

Matrix3 cross_matrix(const Vector3& v) {
  Matrix3 m;
  m << 0, -v.z(), v.y(),  //
      v.z(), 0, -v.x(),   //
      -v.y(), v.x(), 0;
  return m;
}

Matrix3 rotation_z(double yaw_rad) {
  const math::SinCos y = math::sin_cos(yaw_rad);
  Matrix3 m;
  m << y.cos, -y.sin, 0,  //
      y.sin, y.cos, 0,    //
      0, 0, 1;
  return m;
}

double turn_about_z_rad(const Matrix3& from, const Matrix3& to) {
  const Matrix3 turn = to * from.transpose();
  return math::atan2(turn(1, 0) - turn(0, 1), turn(0, 0) + turn(1, 1));
}

bool is_rotation(const Matrix3& R, double tolerance) {
  const Matrix3 error = R.transpose() * R - Matrix3::Identity();
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      if (!(error(row, column) <= tolerance && error(row, column) >= -tolerance)) return false;
    }
  }
  return R.determinant() > 0;
}

Quaternion interpolate(const Quaternion& a, const Quaternion& b, double s) {
  const Vector3 arc_rad = logarithm(conjugate(a) * b);
  return normalised(a * from_rotation_vector(arc_rad * s));
}

}  // namespace surefoot::geometry
