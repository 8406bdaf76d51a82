#include "sim_hal/world/solid.h"

#include <algorithm>
#include <cmath>

#include "sim_hal/world/ray.h"

namespace surefoot::sim {

namespace {

Vector2 plan(const Vector3& p) { return {p.x(), p.y()}; }

double nearest_parameter(const Vector2& p, const Vector2& a, const Vector2& b) {
  const Vector2 along = b - a;
  const double length2 = along.squaredNorm();
  return length2 > 0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
}

Vector2 nearest_on(const Vector2& p, const Vector2& a, const Vector2& b) {
  return a + nearest_parameter(p, a, b) * (b - a);
}

double cross(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }

bool crossing(const Vector2& a, const Vector2& b, const Vector2& c, const Vector2& d) {
  const double side_c = cross(b - a, c - a);
  const double side_d = cross(b - a, d - a);
  const double side_a = cross(d - c, a - c);
  const double side_b = cross(d - c, b - c);
  return side_c * side_d < 0 && side_a * side_b < 0;
}

// From the segment c-d to a-b, shortest; zero when they cross.
Vector2 gap_between(const Vector2& a, const Vector2& b, const Vector2& c, const Vector2& d) {
  if (crossing(a, b, c, d)) return Vector2::Zero();
  Vector2 best = a - nearest_on(a, c, d);
  const auto take = [&](const Vector2& gap) {
    if (gap.squaredNorm() < best.squaredNorm()) best = gap;
  };
  take(b - nearest_on(b, c, d));
  take(nearest_on(c, a, b) - c);
  take(nearest_on(d, a, b) - d);
  return best;
}

double capsule_distance(const Capsule& capsule, const Vector2& a, const Vector2& b, Vector2& away) {
  const Vector2 c = plan(capsule.a_m);
  const Vector2 d = plan(capsule.b_m);
  const Vector2 gap = gap_between(a, b, c, d);
  const double distance = gap.norm();
  if (distance > 1e-9) {
    away = gap / distance;
  } else {  // crossed: back across the longer axis
    const Vector2 axis = (d - c).squaredNorm() > (b - a).squaredNorm() ? d - c : b - a;
    const Vector2 normal = axis.norm() > 0 ? Vector2(-axis.y(), axis.x()) : Vector2(1, 0);
    const double side = normal.dot((a + b) - (c + d)) < 0 ? -1.0 : 1.0;
    away = side * normal.normalized();
  }
  return distance - capsule.radius_m;
}

Vector2 clamp_to(const Vector2& p, double x, double y) {
  return {std::clamp(p.x(), -x, x), std::clamp(p.y(), -y, y)};
}

// In the box's own axes.
double rectangle_distance(double x, double y, const Vector2& a, const Vector2& b, Vector2& away) {
  double t0 = 0;
  double t1 = 1;
  const Vector2 along = b - a;
  if (clip(a.x(), along.x(), -x, x, t0, t1) && clip(a.y(), along.y(), -y, y, t0, t1)) {
    const double depths[4] = {x - std::min(a.x(), b.x()), std::max(a.x(), b.x()) + x,
                              y - std::min(a.y(), b.y()), std::max(a.y(), b.y()) + y};
    const auto* least = std::min_element(std::begin(depths), std::end(depths));
    const auto side = least - std::begin(depths);
    const double sign = side % 2 == 0 ? 1.0 : -1.0;
    away = side < 2 ? Vector2(sign, 0) : Vector2(0, sign);
    return -*least;
  }
  Vector2 gap = a - clamp_to(a, x, y);
  const auto take = [&](const Vector2& other) {
    if (other.squaredNorm() < gap.squaredNorm()) gap = other;
  };
  take(b - clamp_to(b, x, y));
  for (const double cx : {-x, x}) {
    for (const double cy : {-y, y}) {
      const Vector2 corner(cx, cy);
      take(nearest_on(corner, a, b) - corner);
    }
  }
  const double distance = gap.norm();
  away = distance > 0 ? Vector2(gap / distance) : Vector2(1, 0);
  return distance;
}

double box_distance(const TerrainBox& box, const Vector2& a_m, const Vector2& b_m, Vector2& away) {
  const auto to_box = [&](const Vector2& p) {
    const double dx = p.x() - box.x_m;
    const double dy = p.y() - box.y_m;
    return Vector2(box.cos_yaw * dx + box.sin_yaw * dy, box.cos_yaw * dy - box.sin_yaw * dx);
  };
  Vector2 own;
  const double distance =
      rectangle_distance(box.half_length_m, box.half_width_m, to_box(a_m), to_box(b_m), own);
  away = Vector2(box.cos_yaw * own.x() - box.sin_yaw * own.y(),
                 box.sin_yaw * own.x() + box.cos_yaw * own.y());
  return distance;
}

}  // namespace

double Solid::top_m() const {
  if (is_box()) return box.top_m;
  return std::max(capsule.a_m.z(), capsule.b_m.z()) + capsule.radius_m;
}

PlanBounds plan_bounds(const Solid& solid) {
  if (solid.is_box()) {
    const TerrainBox& box = solid.box;
    const double c = std::fabs(box.cos_yaw);
    const double s = std::fabs(box.sin_yaw);
    const double reach_x = c * box.half_length_m + s * box.half_width_m;
    const double reach_y = s * box.half_length_m + c * box.half_width_m;
    return {box.x_m - reach_x, box.y_m - reach_y, box.x_m + reach_x, box.y_m + reach_y};
  }
  const Capsule& c = solid.capsule;
  return {std::min(c.a_m.x(), c.b_m.x()) - c.radius_m, std::min(c.a_m.y(), c.b_m.y()) - c.radius_m,
          std::max(c.a_m.x(), c.b_m.x()) + c.radius_m, std::max(c.a_m.y(), c.b_m.y()) + c.radius_m};
}

// Of a capsule: the highest of the balls along its axis, whose height over (x, y) has one maximum.
double top_at(const Solid& solid, double x_m, double y_m) {
  if (solid.is_box()) return solid.box.covers(x_m, y_m) ? solid.box.top_m : -kNoHit;
  const Capsule& capsule = solid.capsule;
  const Vector2 a = plan(capsule.a_m);
  const Vector2 b = plan(capsule.b_m);
  const Vector2 p(x_m, y_m);
  const auto ball = [&](double s) {
    const double off2 = (p - a - s * (b - a)).squaredNorm();
    const double rest = capsule.radius_m * capsule.radius_m - off2;
    if (rest < 0) return -kNoHit;
    return capsule.a_m.z() + s * (capsule.b_m.z() - capsule.a_m.z()) + std::sqrt(rest);
  };
  const double length = (b - a).norm();
  if (length < 1e-9) return std::max(ball(0.0), ball(1.0));
  const double middle = nearest_parameter(p, a, b);
  const double off2 = (p - a - middle * (b - a)).squaredNorm();
  const double half2 = capsule.radius_m * capsule.radius_m - off2;
  if (half2 < 0) return -kNoHit;
  double low = std::max(0.0, middle - std::sqrt(half2) / length);
  double high = std::min(1.0, middle + std::sqrt(half2) / length);
  for (int i = 0; i < 60; ++i) {
    const double third = (high - low) / 3;
    if (ball(low + third) < ball(high - third)) {
      low += third;
    } else {
      high -= third;
    }
  }
  return std::max(ball(0.5 * (low + high)), ball(middle));
}

double cast_solid(const Solid& solid, const Vector3& origin, const Vector3& direction) {
  if (solid.is_box()) return cast_box(solid.box, origin, direction);
  const Capsule& c = solid.capsule;
  return cast_capsule({c.a_m - origin, c.b_m - origin, c.radius_m}, direction);
}

double plan_distance_m(const Solid& solid, const Vector2& a_m, const Vector2& b_m, Vector2& away) {
  return solid.is_box() ? box_distance(solid.box, a_m, b_m, away)
                        : capsule_distance(solid.capsule, a_m, b_m, away);
}

}  // namespace surefoot::sim
