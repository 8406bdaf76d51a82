// Upright boxes for the worlds that are made of them: how they are drawn, and how they lie.
#pragma once

#include <vector>

#include "core/base/random.h"
#include "sim_hal/world/terrain.h"

namespace surefoot::sim {

// What a box is drawn from. The field begins at x = kFieldBegin_m and lies symmetric to y = 0.
struct BoxDraw {
  double min_side_m = 0;
  double max_side_m = 0;
  double min_height_m = 0;
  double max_height_m = 0;
  double field_length_m = 0;
  double field_width_m = 0;
};

// A box of random size, yaw and place, wholly inside the field, standing on the ground.
TerrainBox draw_box(const BoxDraw& draw, Random& random);

// From the box's centre to its outline along the unit vector (c, s).
double half_extent(const TerrainBox& box, double c, double s);
// Whether the rectangles of two boxes have a point in common, seen from above.
bool overlap(const TerrainBox& a, const TerrainBox& b);
// The highest top among the boxes under this one; 0: the ground.
double support_m(const std::vector<TerrainBox>& others, const TerrainBox& box);

}  // namespace surefoot::sim
