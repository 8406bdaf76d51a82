#include "sim_hal/world/boxes.h"

#include <cmath>

#include "core/math/elementary.h"

namespace surefoot::sim {

TerrainBox draw_box(const BoxDraw& draw, Random& random) {
  TerrainBox box;
  box.half_length_m = 0.5 * random.uniform(draw.min_side_m, draw.max_side_m);
  box.half_width_m = 0.5 * random.uniform(draw.min_side_m, draw.max_side_m);
  const double yaw = random.uniform(0.0, math::kPi);
  box.cos_yaw = std::cos(yaw);
  box.sin_yaw = std::sin(yaw);
  box.top_m = random.uniform(draw.min_height_m, draw.max_height_m);
  const double reach_x = half_extent(box, 1, 0);
  const double reach_y = half_extent(box, 0, 1);
  box.x_m = random.uniform(kFieldBegin_m + reach_x, kFieldBegin_m + draw.field_length_m - reach_x);
  box.y_m = random.uniform(-draw.field_width_m / 2 + reach_y, draw.field_width_m / 2 - reach_y);
  return box;
}

double half_extent(const TerrainBox& box, double c, double s) {
  const double along = std::fabs(box.cos_yaw * c + box.sin_yaw * s);
  const double across = std::fabs(box.cos_yaw * s - box.sin_yaw * c);
  return along * box.half_length_m + across * box.half_width_m;
}

namespace {

bool separated_along(const TerrainBox& a, const TerrainBox& b, double c, double s) {
  const double distance = std::fabs((b.x_m - a.x_m) * c + (b.y_m - a.y_m) * s);
  return distance >= half_extent(a, c, s) + half_extent(b, c, s);
}

}  // namespace

// Separating axes of two rectangles.
bool overlap(const TerrainBox& a, const TerrainBox& b) {
  return !separated_along(a, b, a.cos_yaw, a.sin_yaw) &&
         !separated_along(a, b, -a.sin_yaw, a.cos_yaw) &&
         !separated_along(a, b, b.cos_yaw, b.sin_yaw) &&
         !separated_along(a, b, -b.sin_yaw, b.cos_yaw);
}

double support_m(const std::vector<TerrainBox>& others, const TerrainBox& box) {
  double support = 0;
  for (const TerrainBox& other : others) {
    if (other.top_m > support && overlap(box, other)) support = other.top_m;
  }
  return support;
}

}  // namespace surefoot::sim
