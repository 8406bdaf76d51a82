// What navigation's parts hand to each other.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/fixed_vector.h"
#include "core/base/time.h"
#include "core/math/linear.h"

namespace surefoot::navigation {

inline constexpr std::size_t kMaxRawPoints = 2048;   // cells of one searched path
inline constexpr std::size_t kMaxPathPoints = 2048;  // samples of one smooth path

struct RobotPose {
  Vector2 p_O_m = Vector2::Zero();
  double yaw_rad = 0;
};

// In the robot's heading: x forward, y left.
struct VelocityCommand {
  double forward_m_s = 0;
  double left_m_s = 0;
  double yaw_rate_rad_s = 0;
};

using RawPath = FixedVector<Vector2, kMaxRawPoints>;  // O, m: a polyline

struct PathPoint {
  Vector2 p_O_m = Vector2::Zero();
  double along_m = 0;  // arc length from the path's start
  Vector2 tangent_O = Vector2(1, 0);
  double curvature_1_m = 0;  // positive: to the left
};

using Path = FixedVector<PathPoint, kMaxPathPoints>;

constexpr double larger(double a, double b) { return a > b ? a : b; }
constexpr double smaller(double a, double b) { return a < b ? a : b; }
inline double cross(const Vector2& a, const Vector2& b) { return a[0] * b[1] - a[1] * b[0]; }
inline Vector2 left_of(const Vector2& v) { return {-v[1], v[0]}; }

// The largest whole number not above the value; |value| < 2^31.
constexpr std::int32_t floor_of(double value) {
  const auto whole = static_cast<std::int32_t>(value);
  return static_cast<double>(whole) > value ? whole - 1 : whole;
}

// A copy that touches only what is there.
template <class Vector>
void copy_used(const Vector& from, Vector& to) {
  to.clear();
  for (const auto& item : from) static_cast<void>(to.push_back(item));
}

}  // namespace surefoot::navigation
