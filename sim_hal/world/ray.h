// Pieces of casting rays through rasters and boxes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/math/linear.h"
#include "sim_hal/world/terrain_box.h"

namespace surefoot::sim {

inline constexpr double kNoHit = std::numeric_limits<double>::infinity();

// Narrows [t0, t1] to where origin + t * direction lies in [low, high]; false when nowhere.
inline bool clip(double origin, double direction, double low, double high, double& t0, double& t1) {
  if (direction == 0) return origin >= low && origin <= high;
  const double inverse = 1.0 / direction;
  double near = (low - origin) * inverse;
  double far = (high - origin) * inverse;
  if (near > far) std::swap(near, far);
  t0 = std::max(t0, near);
  t1 = std::min(t1, far);
  return t0 <= t1;
}

// Smallest t > 0 on the box's surface, from outside; kNoHit when none.
inline double cast_box(const TerrainBox& box, const Vector3& origin, const Vector3& direction) {
  double t0 = 0;
  double t1 = kNoHit;
  if (!clip(origin.z(), direction.z(), box.bottom_m, box.top_m, t0, t1)) return kNoHit;
  const double dx = origin.x() - box.x_m;
  const double dy = origin.y() - box.y_m;
  const double along = box.cos_yaw * dx + box.sin_yaw * dy;
  const double along_rate = box.cos_yaw * direction.x() + box.sin_yaw * direction.y();
  if (!clip(along, along_rate, -box.half_length_m, box.half_length_m, t0, t1)) return kNoHit;
  const double across = box.cos_yaw * dy - box.sin_yaw * dx;
  const double across_rate = box.cos_yaw * direction.y() - box.sin_yaw * direction.x();
  if (!clip(across, across_rate, -box.half_width_m, box.half_width_m, t0, t1)) return kNoHit;
  return t0 > 0 ? t0 : kNoHit;
}

// Steps from raster cell to raster cell along a ray (Amanatides and Woo). The origin is given from
// the raster's corner.
struct RasterWalk {
  std::int64_t i = 0;
  std::int64_t j = 0;
  std::int64_t step_i = 0;
  std::int64_t step_j = 0;
  double next_i = kNoHit;  // t at which the ray leaves the cell in x
  double next_j = kNoHit;
  double per_i = kNoHit;
  double per_j = kNoHit;

  static void axis(double offset, double direction, double t0, double cell, std::int64_t limit,
                   std::int64_t& index, std::int64_t& step, double& next, double& per) {
    const double at = (offset + t0 * direction) / cell;
    index = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(at)), 0, limit - 1);
    if (direction == 0) return;
    step = direction > 0 ? 1 : -1;
    per = cell / std::fabs(direction);
    const double border = static_cast<double>(direction > 0 ? index + 1 : index) * cell;
    next = (border - offset) / direction;
  }
  RasterWalk(const Vector3& offset, const Vector3& direction, double t0, double cell,
             std::size_t nx, std::size_t ny) {
    axis(offset.x(), direction.x(), t0, cell, static_cast<std::int64_t>(nx), i, step_i, next_i,
         per_i);
    axis(offset.y(), direction.y(), t0, cell, static_cast<std::int64_t>(ny), j, step_j, next_j,
         per_j);
  }
  double leave() const { return std::min(next_i, next_j); }
  void advance() {
    if (next_i <= next_j) {
      i += step_i;
      next_i += per_i;
    } else {
      j += step_j;
      next_j += per_j;
    }
  }
  bool inside(std::size_t nx, std::size_t ny) const {
    return i >= 0 && j >= 0 && i < static_cast<std::int64_t>(nx) &&
           j < static_cast<std::int64_t>(ny);
  }
};

}  // namespace surefoot::sim
