#include "core/obstacles/avoidance.h"

#include <algorithm>

#include "core/math/elementary.h"

namespace surefoot::obstacles {

void Avoidance::reset(const ObstacleConfig& config, const Footprint& footprint) {
  config_ = config;
  footprint_ = footprint;
  side_ = 0;
}

Avoidance::Axis Avoidance::axis(const RobotPlace& place) const {
  const math::SinCos yaw = math::sin_cos(place.yaw_rad);
  return {place.p_O_m, Vector2(yaw.cos, yaw.sin)};
}

Avoidance::Contact Avoidance::contact(const Field& field, const Axis& axis) const {
  const Vector2 to_field = field.centre_O_m - axis.p_O_m;
  const double along_m = math::clamp(to_field.dot(axis.heading_O), -footprint_.half_length_m,
                                     footprint_.half_length_m);
  const Vector2 away = axis.heading_O * along_m - to_field;
  const double distance_m = math::sqrt(away.squaredNorm());
  Contact contact;
  // A centre on the robot's axis: any direction is as good.
  contact.away_O = distance_m > 0 ? Vector2(away / distance_m) : Vector2(-axis.heading_O);
  contact.free_m = distance_m - room_m();
  return contact;
}

// From a field's centre to the robot's axis where the free space ends. A cell of the object may lie
// two radii from the centre.
double Avoidance::room_m() const {
  return 2.0 * config_.field_radius_m + footprint_.radius_m + config_.margin_m;
}

double Avoidance::push_m_s(double free_m) const {
  if (free_m >= config_.reach_m) return 0;
  return config_.push_m_s * math::square(1.0 - free_m / config_.reach_m);
}

double Avoidance::potential(const Fields& fields, const RobotPlace& place) const {
  const Axis robot = axis(place);
  double sum = 0;
  for (const Field& field : fields) {
    const double rest = 1.0 - contact(field, robot).free_m / config_.reach_m;
    if (rest > 0) sum += config_.push_m_s * config_.reach_m / 3.0 * rest * rest * rest;
  }
  return sum;
}

Vector2 Avoidance::push_O_m_s(const Fields& fields, const RobotPlace& place) const {
  const Axis robot = axis(place);
  Vector2 sum = Vector2::Zero();
  for (const Field& field : fields) {
    const Contact found = contact(field, robot);
    sum += found.away_O * push_m_s(found.free_m);
  }
  return sum;
}

double Avoidance::free_space_m(const Fields& fields, const RobotPlace& place) const {
  const Axis robot = axis(place);
  double least_m = config_.reach_m;
  for (const Field& field : fields) least_m = std::min(least_m, contact(field, robot).free_m);
  return least_m;
}

// One look over the fields ahead: those in the robot's way, or too near to what is in its way to
// pass between.
void Avoidance::extend(const Fields& fields, const RobotPlace& place, const Vector2& path_O,
                       Extent& extent) const {
  const double sight_m = room_m() + footprint_.half_length_m + 2.0 * config_.reach_m;
  for (const Field& field : fields) {
    const Vector2 to_field = field.centre_O_m - place.p_O_m;
    const double along_m = to_field.dot(path_O);
    if (along_m < 0 || along_m > sight_m) continue;
    const double left_m = math::cross(path_O, to_field);
    const double near_m = extent.any ? extent.low_m - 2.0 * room_m() : -room_m();
    const double far_m = extent.any ? extent.high_m + 2.0 * room_m() : room_m();
    if (left_m < near_m || left_m > far_m) continue;
    extent.low_m = extent.any ? std::min(extent.low_m, left_m) : left_m;
    extent.high_m = extent.any ? std::max(extent.high_m, left_m) : left_m;
    extent.any = true;
  }
}

// Once something is in the way: the side of the shorter detour, kept until nothing is.
void Avoidance::choose_side(const Fields& fields, const RobotPlace& place, const Wish& wish) {
  Extent extent;
  extend(fields, place, wish.path_O, extent);
  if (!extent.any) side_ = 0;
  if (side_ != 0 || !extent.any) return;
  // Each pass takes one more field in, or is the last.
  for (std::size_t pass = 0; pass < kMaxFields; ++pass) {
    const Extent before = extent;
    extend(fields, place, wish.path_O, extent);
    if (extent.low_m == before.low_m && extent.high_m == before.high_m) break;
  }
  // There, and back to the line.
  const double left_m = extent.high_m + room_m();
  const double right_m = room_m() - extent.low_m;
  const double left_cost = left_m + std::max(0.0, wish.off_path_m + left_m);
  const double right_cost = right_m + std::max(0.0, right_m - wish.off_path_m);
  side_ = left_cost <= right_cost ? 1 : -1;
}

Vector2 Avoidance::bounded(const Vector2& v_O_m_s, const Vector2& heading_O) const {
  const double forward =
      math::clamp(v_O_m_s.dot(heading_O), -config_.max_back_m_s, config_.max_forward_m_s);
  const double left = math::clamp(math::cross(heading_O, v_O_m_s), -config_.max_sideways_m_s,
                                  config_.max_sideways_m_s);
  return heading_O * forward + math::left_of(heading_O) * left;
}

// Towards a field no faster than the free space before it allows. What one field takes away may
// point into another: hence a second pass.
Vector2 Avoidance::slowed(const Vector2& v_O_m_s, const Fields& fields, const Axis& axis) const {
  Vector2 v = v_O_m_s;
  for (int pass = 0; pass < 2; ++pass) {
    for (const Field& field : fields) {
      const Contact found = contact(field, axis);
      if (found.free_m >= config_.reach_m) continue;
      const double limit = config_.approach_gain_1_s * std::max(found.free_m, 0.0);
      const double towards = -v.dot(found.away_O);
      if (towards > limit) v += found.away_O * (towards - limit);
    }
  }
  return v;
}

Vector2 Avoidance::velocity_O_m_s(const Fields& fields, const RobotPlace& place, const Wish& wish) {
  choose_side(fields, place, wish);
  const Axis robot = axis(place);
  const Vector2 aside = math::left_of(wish.path_O) * static_cast<double>(side_);
  bool in_reach = false;
  Vector2 v = wish.velocity_O_m_s;
  for (const Field& field : fields) {
    const Contact found = contact(field, robot);
    if (found.free_m >= config_.reach_m) continue;
    in_reach = true;
    const double push = push_m_s(found.free_m);
    const double ahead = std::max(0.0, -found.away_O.dot(wish.path_O));
    v += found.away_O * push;
    v += aside * (config_.swirl * push * ahead);
  }
  if (!in_reach) return wish.velocity_O_m_s;
  return slowed(bounded(v, robot.heading_O), fields, robot);
}

}  // namespace surefoot::obstacles
