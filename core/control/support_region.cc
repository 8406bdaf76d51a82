#include "core/control/support_region.h"

#include "core/math/elementary.h"

namespace surefoot::control {
namespace {

constexpr double kRounding_m = 1e-9;  // a corner lies on its lines only so nearly
constexpr double kParallel = 1e-12;

double cross(const Vector2& a, const Vector2& b) { return a[0] * b[1] - a[1] * b[0]; }

}  // namespace

double Triangle::inradius_m() const {
  const Vector2 ab = corners_O_m[1] - corners_O_m[0];
  const Vector2 bc = corners_O_m[2] - corners_O_m[1];
  const Vector2 ca = corners_O_m[0] - corners_O_m[2];
  const double perimeter_m = ab.norm() + bc.norm() + ca.norm();
  return perimeter_m > 0 ? math::magnitude(cross(ab, bc)) / perimeter_m : 0.0;
}

Status SupportRegion::add(const Triangle& triangle, double margin_m) {
  if (lines_.size() + 3 > lines_.capacity()) return Status::kExhausted;
  if (triangle.inradius_m() <= kRounding_m) return Status::kInvalid;
  const auto& p = triangle.corners_O_m;
  const double turn = cross(p[1] - p[0], p[2] - p[1]) < 0 ? -1.0 : 1.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector2 edge = (p[(i + 1) % 3] - p[i]).normalized();
    const Vector2 inward = turn * Vector2(-edge[1], edge[0]);
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
      const double sine = cross(line.inward, other.inward);
      if (math::magnitude(sine) < kParallel) continue;
      try_point({(line.offset_m * other.inward[1] - other.offset_m * line.inward[1]) / sine,
                 (other.offset_m * line.inward[0] - line.offset_m * other.inward[0]) / sine});
    }
  }
  if (!found) return Status::kNotFound;
  return best;
}

}  // namespace surefoot::control
