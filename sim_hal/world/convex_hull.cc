#include "sim_hal/world/convex_hull.h"

#include <cstddef>

namespace surefoot::sim {

namespace {

// 1: all other points lie behind the plane of a, b, c; -1: before it; 0: on both sides.
int side_of_all(const std::vector<Vector3>& points, std::size_t a, std::size_t b, std::size_t c) {
  const Vector3 normal = (points[b] - points[a]).cross(points[c] - points[a]);
  bool before = false;
  bool behind = false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i == a || i == b || i == c) continue;
    const double distance = normal.dot(points[i] - points[a]);
    before = before || distance > 0;
    behind = behind || distance <= 0;
    if (before && behind) return 0;
  }
  return behind ? 1 : -1;
}

}  // namespace

ConvexBody convex_hull(const std::vector<Vector3>& points_m) {
  constexpr std::uint32_t kUnused = ~0u;
  ConvexBody body;
  std::vector<std::uint32_t> renamed(points_m.size(), kUnused);
  const auto corner = [&](std::size_t i) {
    if (renamed[i] == kUnused) {
      renamed[i] = static_cast<std::uint32_t>(body.points_m.size());
      body.points_m.push_back(points_m[i]);
    }
    return renamed[i];
  };
  for (std::size_t a = 0; a < points_m.size(); ++a) {
    for (std::size_t b = a + 1; b < points_m.size(); ++b) {
      for (std::size_t c = b + 1; c < points_m.size(); ++c) {
        const int side = side_of_all(points_m, a, b, c);
        if (side == 0) continue;
        const std::size_t second = side > 0 ? b : c;
        const std::size_t third = side > 0 ? c : b;
        body.triangles.push_back({corner(a), corner(second), corner(third)});
      }
    }
  }
  return body;
}

Solid solid_of(const ConvexBody& body) {
  Solid solid;
  for (const auto& triangle : body.triangles) {
    const Vector3& a = body.points_m[triangle[0]];
    const Vector3& b = body.points_m[triangle[1]];
    const Vector3& c = body.points_m[triangle[2]];
    const double volume = a.dot(b.cross(c)) / 6;
    solid.volume_m3 += volume;
    solid.centroid_m += volume / 4 * (a + b + c);
  }
  solid.centroid_m /= solid.volume_m3;
  return solid;
}

}  // namespace surefoot::sim
