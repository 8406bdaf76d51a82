// Frame tags and frame-tagged geometry: adding a point of one frame to a vector of another, or
// chaining poses in the wrong order, does not compile (tests/compile_fail). The letters are defined
// in docs/frames_and_units.md.
#pragma once

#include "core/math/linear.h"

namespace surefoot::geometry {

struct Odometry {};     // O: gravity-aligned, where the estimator started; the robot's own world
struct Body {};         // B: trunk
struct Imu {};          // I
struct DepthCamera {};  // C: optical frame, x right, y down, z forward
struct World {};        // W: the simulator's truth; never appears in core's logic

// A displacement, velocity, force ... expressed in the axes of Frame.
template <class Frame>
struct Vector {
  Vector3 v = Vector3::Zero();

  Vector operator+(const Vector& other) const { return {v + other.v}; }
  Vector operator-(const Vector& other) const { return {v - other.v}; }
  Vector operator*(double factor) const { return {v * factor}; }
};

// A place [m], from the origin of Frame in the axes of Frame.
template <class Frame>
struct Point {
  Vector3 m = Vector3::Zero();

  Point operator+(const Vector<Frame>& offset) const { return {m + offset.v}; }
  Point operator-(const Vector<Frame>& offset) const { return {m - offset.v}; }
  Vector<Frame> operator-(const Point& other) const { return {m - other.m}; }
};

// Turns the axes: v_A = Rotation<A, B> * v_B.
template <class A, class B>
struct Rotation {
  Matrix3 matrix = Matrix3::Identity();

  Vector<A> operator*(const Vector<B>& vector) const { return {matrix * vector.v}; }
  template <class C>
  Rotation<A, C> operator*(const Rotation<B, C>& other) const {
    return {matrix * other.matrix};
  }
  Rotation<B, A> inverse() const { return {matrix.transpose()}; }
};

// Where B is, seen from A: p_A = Pose<A, B> * p_B.
template <class A, class B>
struct Pose {
  Rotation<A, B> rotation;
  Point<A> origin;

  Point<A> operator*(const Point<B>& point) const { return {rotation.matrix * point.m + origin.m}; }
  Vector<A> operator*(const Vector<B>& vector) const { return rotation * vector; }
  template <class C>
  Pose<A, C> operator*(const Pose<B, C>& other) const {
    return {rotation * other.rotation, *this * other.origin};
  }
  Pose<B, A> inverse() const {
    const Matrix3 transposed = rotation.matrix.transpose();
    return {{transposed}, {transposed * -origin.m}};
  }
};

}  // namespace surefoot::geometry
