// Conversions between rotation representations, on core/math alone.
#pragma once

#include <array>

#include "core/math/linear.h"

namespace surefoot::geometry {

// Unit quaternion, w first: rotates as v_A = q v_B q*. Kept normalised by the functions below.
struct Quaternion {
  double w = 1;
  double x = 0;
  double y = 0;
  double z = 0;
};

Quaternion operator*(const Quaternion& a, const Quaternion& b);
// Scales to unit length. A zero quaternion becomes the identity.
Quaternion normalised(const Quaternion& q);
Matrix3 to_matrix(const Quaternion& q);
// The result has w >= 0. Shepperd's method: the largest of the four squares is the divisor.
Quaternion to_quaternion(const Matrix3& rotation);
// exp of a rotation vector [rad]: axis times angle. Exact to rounding also near zero.
Quaternion from_rotation_vector(const Vector3& rotation_vector_rad);
// The rotation vector of R, length in [0, pi].
Vector3 to_rotation_vector(const Matrix3& rotation);
// R = Rz(yaw) Ry(pitch) Rx(roll).
Matrix3 from_roll_pitch_yaw(double roll_rad, double pitch_rad, double yaw_rad);
// Inverse of the above; pitch in [-pi/2, pi/2]. At pitch = +-pi/2 roll is set to 0.
Vector3 to_roll_pitch_yaw(const Matrix3& rotation);
Matrix3 cross_matrix(const Vector3& v);
Matrix3 rotation_z(double yaw_rad);
// About z, of the rotation that leads from one attitude to another: its angle if that is all of it.
double turn_about_z_rad(const Matrix3& from, const Matrix3& to);
// Every entry of R' R is within `tolerance` of the identity's, and R is no reflection. False for
// NaN and infinity.
bool is_rotation(const Matrix3& R, double tolerance);
// Interpolates from a (s = 0) to b (s = 1) along the shorter arc.
Quaternion interpolate(const Quaternion& a, const Quaternion& b, double s);

}  // namespace surefoot::geometry
