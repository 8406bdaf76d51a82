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

}  // namespace surefoot::navigation
