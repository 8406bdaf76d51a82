#include "sim_hal/world/grid_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace surefoot::sim {

namespace {

constexpr double kSameNormal = 0.94;  // cos 20 degrees
constexpr std::size_t kMaxCandidates = 32;

Vector3 nearest_on_segment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 along = b - a;
  const double s = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return a + s * along;
}

std::size_t first_cell(double offset_m, double cell_m) {
  return static_cast<std::size_t>(std::max(0.0, std::floor(offset_m / cell_m)));
}

std::size_t end_cell(double offset_m, double cell_m, std::size_t nodes) {
  const double end =
      std::clamp(std::floor(offset_m / cell_m) + 1, 0.0, static_cast<double>(nodes - 1));
  return static_cast<std::size_t>(end);
}

// Contacts found so far; when full, the shallowest gives way.
struct Candidates {
  std::array<GridContact, kMaxCandidates> items;
  std::size_t count = 0;

  void add(const GridContact& contact) {
    if (count < items.size()) {
      items[count++] = contact;
      return;
    }
    const auto shallowest = std::min_element(
        items.begin(), items.end(),
        [](const GridContact& a, const GridContact& b) { return a.depth_m < b.depth_m; });
    if (contact.depth_m > shallowest->depth_m) *shallowest = contact;
  }
};

void touch(const Vector3& centre, double radius, const Vector3& a, const Vector3& b,
           const Vector3& c, Candidates& found) {
  const Vector3 point = nearest_on_triangle(centre, a, b, c);
  const Vector3 out = centre - point;
  const double distance2 = out.squaredNorm();
  if (distance2 >= radius * radius || distance2 < 1e-18) return;
  const double distance = std::sqrt(distance2);
  found.add({point, out / distance, radius - distance});
}

// Where the grid ends the ground falls off to height 0: a wall along each of its four sides.
struct Side {
  Vector3 normal;   // outwards
  double inside_m;  // how far the centre is inside of the wall
};
std::array<Side, 4> sides(const HeightGrid& grid, const Vector3& centre) {
  return {{{Vector3(-1, 0, 0), centre.x() - grid.x0_m},
           {Vector3(1, 0, 0), grid.end_x_m() - centre.x()},
           {Vector3(0, -1, 0), centre.y() - grid.y0_m},
           {Vector3(0, 1, 0), grid.end_y_m() - centre.y()}}};
}

// The centre is outside of the grid: the wall beside it, where that is as high.
void touch_sides(const HeightGrid& grid, const Vector3& centre, double radius, Candidates& found) {
  for (const Side& side : sides(grid, centre)) {
    if (side.inside_m > 0 || side.inside_m <= -radius) continue;
    const Vector3 foot = centre + side.inside_m * side.normal;
    const double x = std::clamp(foot.x(), grid.x0_m, grid.end_x_m());
    const double y = std::clamp(foot.y(), grid.y0_m, grid.end_y_m());
    const Vector3 point(x, y, std::clamp(centre.z(), 0.0, std::max(0.0, grid.height_m(x, y))));
    const Vector3 out = centre - point;
    const double distance = out.norm();
    if (distance >= radius) continue;
    const Vector3 normal = distance > 1e-9 ? Vector3(out / distance) : side.normal;
    found.add({point, normal, radius - distance});
  }
}

// The centre itself is under the surface: the nearer of the face above it and a wall beside it
// pushes.
GridContact buried(const HeightGrid& grid, const Vector3& centre, double radius, double ground) {
  const double e = 0.25 * grid.cell_m;
  const double x1 = std::min(centre.x() + e, grid.end_x_m());
  const double y1 = std::min(centre.y() + e, grid.end_y_m());
  const double slope_x = (grid.height_m(x1, centre.y()) - grid.height_m(x1 - e, centre.y())) / e;
  const double slope_y = (grid.height_m(centre.x(), y1) - grid.height_m(centre.x(), y1 - e)) / e;
  const Vector3 normal = Vector3(-slope_x, -slope_y, 1).normalized();
  const double below = (ground - centre.z()) * normal.z();
  GridContact nearest{centre + below * normal, normal, radius + below};
  for (const Side& side : sides(grid, centre)) {
    if (radius + side.inside_m >= nearest.depth_m) continue;
    nearest = {centre + side.inside_m * side.normal, side.normal, radius + side.inside_m};
  }
  return nearest;
}

}  // namespace

Vector3 nearest_on_triangle(const Vector3& p, const Vector3& a, const Vector3& b,
                            const Vector3& c) {
  const Vector3 normal = (b - a).cross(c - a);
  const Vector3 foot = p - normal * (normal.dot(p - a) / normal.squaredNorm());
  const bool inside = normal.dot((b - a).cross(foot - a)) >= 0 &&
                      normal.dot((c - b).cross(foot - b)) >= 0 &&
                      normal.dot((a - c).cross(foot - c)) >= 0;
  if (inside) return foot;
  Vector3 nearest = nearest_on_segment(p, a, b);
  for (const Vector3& other : {nearest_on_segment(p, b, c), nearest_on_segment(p, c, a)}) {
    if ((p - other).squaredNorm() < (p - nearest).squaredNorm()) nearest = other;
  }
  return nearest;
}

std::size_t sphere_on_grid(const HeightGrid& grid, const Vector3& centre_m, double radius_m,
                           std::span<GridContact> out) {
  if (grid.contains(centre_m.x(), centre_m.y())) {
    const double ground = grid.height_m(centre_m.x(), centre_m.y());
    if (centre_m.z() <= ground) {
      out[0] = buried(grid, centre_m, radius_m, ground);
      return 1;
    }
  }
  const double x = centre_m.x() - grid.x0_m;
  const double y = centre_m.y() - grid.y0_m;
  const std::size_t i_end = end_cell(x + radius_m, grid.cell_m, grid.nx);
  const std::size_t j_end = end_cell(y + radius_m, grid.cell_m, grid.ny);
  const double lowest = centre_m.z() - radius_m;
  Candidates found;
  touch_sides(grid, centre_m, radius_m, found);
  for (std::size_t j = first_cell(y - radius_m, grid.cell_m); j < j_end; ++j) {
    for (std::size_t i = first_cell(x - radius_m, grid.cell_m); i < i_end; ++i) {
      const double x0 = grid.x0_m + grid.cell_m * static_cast<double>(i);
      const double y0 = grid.y0_m + grid.cell_m * static_cast<double>(j);
      const Vector3 p00(x0, y0, grid.at(i, j));
      const Vector3 p10(x0 + grid.cell_m, y0, grid.at(i + 1, j));
      const Vector3 p01(x0, y0 + grid.cell_m, grid.at(i, j + 1));
      const Vector3 p11(x0 + grid.cell_m, y0 + grid.cell_m, grid.at(i + 1, j + 1));
      if (std::max(std::max(p00.z(), p10.z()), std::max(p01.z(), p11.z())) < lowest) continue;
      touch(centre_m, radius_m, p00, p10, p11, found);
      touch(centre_m, radius_m, p00, p11, p01, found);
    }
  }
  const auto begin = found.items.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(found.count);
  std::size_t count = 0;
  while (count < out.size()) {
    // The deepest left, ties by order; done when all left are shallower copies of kept ones.
    const auto deepest = std::max_element(
        begin, end,
        [](const GridContact& a, const GridContact& b) { return a.depth_m < b.depth_m; });
    if (deepest == end || deepest->depth_m <= 0) break;
    out[count++] = *deepest;
    for (auto item = begin; item != end; ++item) {
      if (item->normal.dot(out[count - 1].normal) > kSameNormal) item->depth_m = 0;
    }
  }
  return count;
}

}  // namespace surefoot::sim
