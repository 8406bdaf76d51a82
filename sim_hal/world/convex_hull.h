// Convex hulls of a few points, for the rock generator.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math/linear.h"

namespace surefoot::sim {

// Points of a body and the triangles of its surface, counter-clockwise seen from outside.
struct ConvexBody {
  std::vector<Vector3> points_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// Tries every triple of points: O(n^4), meant for at most some 30 points in general position (no
// four on a plane, which random draws never are). Points inside are dropped.
ConvexBody convex_hull(const std::vector<Vector3>& points_m);

struct Solid {
  double volume_m3 = 0;
  Vector3 centroid_m = Vector3::Zero();
};
Solid solid_of(const ConvexBody& body);

}  // namespace surefoot::sim
