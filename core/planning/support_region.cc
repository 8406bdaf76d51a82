#include "core/planning/support_region.h"

#include "core/math/elementary.h"

namespace surefoot::planning {
namespace {

constexpr double kRounding_m = 1e-9;  // a corner lies on its lines only so nearly
constexpr double kParallel = 1e-12;

constexpr double kOfRoom = 0.95;

// Whether an edge of `a` has all of `b` on its outside.
bool edge_separates(const Triangle& a, const Triangle& b) {
  const auto& p = a.corners_O_m;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector2 edge = p[(i + 1) % 3] - p[i];
    const bool inside_left = math::cross(edge, p[(i + 2) % 3] - p[i]) > 0;
    bool all_outside = true;
    for (const Vector2& corner : b.corners_O_m) {
      const double side = math::cross(edge, corner - p[i]);
      all_outside = all_outside && (inside_left ? side < 0 : side > 0);
    }
    if (all_outside) return true;
  }
  return false;
}

double distance_m2(const Vector2& point, const Vector2& from, const Vector2& to) {
  const Vector2 edge = to - from;
  const double length_m2 = edge.squaredNorm();
  double along = 0;
  if (length_m2 > 0) along = math::clamp((point - from).dot(edge) / length_m2, 0.0, 1.0);
  return (point - from - along * edge).squaredNorm();
}

// From the corners of `a` to the edges of `b`.
double corner_distance_m2(const Triangle& a, const Triangle& b) {
  const auto& p = b.corners_O_m;
  double least_m2 = distance_m2(a.corners_O_m[0], p[0], p[1]);
  for (const Vector2& corner : a.corners_O_m) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double m2 = distance_m2(corner, p[i], p[(i + 1) % 3]);
      if (m2 < least_m2) least_m2 = m2;
    }
  }
  return least_m2;
}

}  // namespace

double kept_margin_m(double inradius_m, double margin_m) {
  return inradius_m < margin_m ? kOfRoom * inradius_m : margin_m;
}

double distance_m(const Triangle& a, const Triangle& b) {
  if (!edge_separates(a, b) && !edge_separates(b, a)) return 0.0;
  const double there_m2 = corner_distance_m2(a, b);
  const double back_m2 = corner_distance_m2(b, a);
  return math::sqrt(there_m2 < back_m2 ? there_m2 : back_m2);
}

Triangle Triangle::drawn_in(double margin_m) const {
  const auto& p = corners_O_m;
  const double a_m = (p[2] - p[1]).norm();
  const double b_m = (p[0] - p[2]).norm();
  const double c_m = (p[1] - p[0]).norm();
  const double perimeter_m = a_m + b_m + c_m;
  if (!(perimeter_m > 0)) return *this;
  const double radius_m = math::magnitude(math::cross(p[1] - p[0], p[2] - p[1])) / perimeter_m;
  if (radius_m <= kRounding_m) return *this;
  const Vector2 centre = (a_m * p[0] + b_m * p[1] + c_m * p[2]) / perimeter_m;
  const double share = 1.0 - kept_margin_m(radius_m, margin_m) / radius_m;
  Triangle inner;
  for (std::size_t i = 0; i < 3; ++i) inner.corners_O_m[i] = centre + share * (p[i] - centre);
  return inner;
}

double Triangle::inradius_m() const {
  const Vector2 ab = corners_O_m[1] - corners_O_m[0];
  const Vector2 bc = corners_O_m[2] - corners_O_m[1];
  const Vector2 ca = corners_O_m[0] - corners_O_m[2];
  const double perimeter_m = ab.norm() + bc.norm() + ca.norm();
  return perimeter_m > 0 ? math::magnitude(math::cross(ab, bc)) / perimeter_m : 0.0;
}

Status SupportRegion::add(const Triangle& triangle, double margin_m) {
  if (lines_.size() + 3 > lines_.capacity()) return Status::kExhausted;
  if (triangle.inradius_m() <= kRounding_m) return Status::kInvalid;
  const auto& p = triangle.corners_O_m;
  const double turn = math::cross(p[1] - p[0], p[2] - p[1]) < 0 ? -1.0 : 1.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector2 edge = (p[(i + 1) % 3] - p[i]).normalized();
    const Vector2 inward = turn * math::left_of(edge);
    static_cast<void>(lines_.push_back({inward, inward.dot(p[i]) + margin_m}));
  }
  return Status::kOk;
}

bool SupportRegion::contains(const Vector2& point_O_m) const {
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    if (lines_[i].inward.dot(point_O_m) < lines_[i].offset_m - kRounding_m) return false;
  }
  return true;
}

// The region is convex: the nearest point is `wanted` itself, its foot on one of the lines, or a
// corner.
Result<Vector2> SupportRegion::nearest(const Vector2& wanted_O_m) const {
  if (contains(wanted_O_m)) return wanted_O_m;
  bool found = false;
  Vector2 best = Vector2::Zero();
  double best_m2 = 0;
  const auto try_point = [&](const Vector2& point) {
    if (!contains(point)) return;
    const double distance_m2 = (point - wanted_O_m).squaredNorm();
    if (found && distance_m2 >= best_m2) return;
    found = true;
    best = point;
    best_m2 = distance_m2;
  };
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const Line& line = lines_[i];
    try_point(wanted_O_m + (line.offset_m - line.inward.dot(wanted_O_m)) * line.inward);
    for (std::size_t j = i + 1; j < lines_.size(); ++j) {
      const Line& other = lines_[j];
      const double sine = math::cross(line.inward, other.inward);
      if (math::magnitude(sine) < kParallel) continue;
      try_point({(line.offset_m * other.inward[1] - other.offset_m * line.inward[1]) / sine,
                 (other.offset_m * line.inward[0] - line.offset_m * other.inward[0]) / sine});
    }
  }
  if (!found) return Status::kNotFound;
  return best;
}

}  // namespace surefoot::planning
