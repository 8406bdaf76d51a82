#include "core/navigation/walker_avoidance.h"

#include <algorithm>

#include "core/math/elementary.h"

namespace surefoot::navigation {
namespace {

constexpr std::array<double, 5> kShareOf{1.0, 0.75, 0.5, 0.25, 0.0};
constexpr double kHysteresis_m = 0.10;  // more room asked for before going faster again
constexpr double kStepAside_m = 0.8;    // of free ground that a step aside needs
constexpr double kMaxAge_s = 5.0;       // since it was seen; then it may be anywhere
constexpr double kGap_m = 0.05;         // kept from what stands

}  // namespace

void WalkerAvoidance::reset(const NavigationConfig& config) {
  half_length_m_ = config.half_length_m;
  half_width_m_ = config.half_width_m;
  radius_m_ = math::sqrt(math::square(half_length_m_) + math::square(half_width_m_));
  config_ = config.follow;
  last_share_ = 0;
  last_direction_ = kDirections;
}

void WalkerAvoidance::gather(const Intent& intent, const NearObjects& near, TimeNs stamp) {
  walkers_.clear();
  for (const auto& moving : near.moving()) {
    const objects::Object& object = *moving.object;
    Walker walker;
    walker.velocity_O_m_s = object.velocity_O_m_s;
    const double age_s = std::max(0.0, (stamp - object.last_seen).seconds());
    if (age_s > kMaxAge_s) continue;
    walker.p_O_m = object.centre_O_m + object.velocity_O_m_s * age_s;
    double radius2 = 0;
    for (const Vector2& p_O_m : object.points_O_m) {
      radius2 = std::max(radius2, (p_O_m - object.centre_O_m).squaredNorm());
    }
    walker.keep_m = math::sqrt(radius2) + radius_m_ + config_.walker_margin_m;
    walker.now_m = math::sqrt((walker.p_O_m - intent.robot.p_O_m).squaredNorm());
    const double speed_m_s = math::sqrt(walker.velocity_O_m_s.squaredNorm()) + config_.cruise_m_s;
    if (walker.now_m > walker.keep_m + speed_m_s * config_.walker_horizon_s) continue;
    static_cast<void>(walkers_.push_back(walker));
  }
}

// Least distance beyond what is to be kept, both moving straight from one time to another. Nearer
// than that from the start: relative to the start's distance.
double WalkerAvoidance::room_m(const Walker& walker, const Vector2& from_O_m,
                               const Vector2& velocity_O_m_s, double from_s, double to_s) const {
  const Vector2 apart_m = walker.p_O_m + walker.velocity_O_m_s * from_s - from_O_m;
  const Vector2 closing_m_s = walker.velocity_O_m_s - velocity_O_m_s;
  const double speed2 = closing_m_s.squaredNorm();
  double t_s = 0;
  if (speed2 > 1e-9) t_s = math::clamp(-apart_m.dot(closing_m_s) / speed2, 0.0, to_s - from_s);
  const double least_m = math::sqrt((apart_m + closing_m_s * t_s).squaredNorm());
  return least_m - std::min(walker.keep_m, walker.now_m - 0.02);
}

// From all walkers.
double WalkerAvoidance::room_at_m(const Vector2& from_O_m, const Vector2& velocity_O_m_s,
                                  double from_s, double to_s) const {
  double room = config_.walker_horizon_s * 10.0;
  for (const Walker& walker : walkers_) {
    room = std::min(room, room_m(walker, from_O_m, velocity_O_m_s, from_s, to_s));
  }
  return room;
}

double WalkerAvoidance::room_along_m(const Intent& intent, double share, double asked_m) const {
  Vector2 at_O_m = intent.robot.p_O_m;
  const bool stands = intent.path == nullptr || intent.path->empty() || share <= 0;
  if (stands) return room_at_m(at_O_m, Vector2::Zero(), 0, config_.walker_horizon_s);
  const double step_s = config_.walker_horizon_s / static_cast<double>(kSteps);
  const Path& path = *intent.path;
  double room = config_.walker_horizon_s * 10.0;
  std::size_t sample = intent.sample;
  for (std::size_t i = 0; i < kSteps && room >= asked_m; ++i) {
    const double ahead_m = share * intent.speed_m_s * step_s * static_cast<double>(i + 1);
    while (sample + 1 < path.size() && path[sample].along_m < intent.at_m + ahead_m) ++sample;
    const Vector2 next_O_m =
        path[sample].p_O_m + intent.off_path_O_m * std::min(1.0, 1.0 / (1.0 + ahead_m));
    const double from_s = step_s * static_cast<double>(i);
    room = std::min(room, room_at_m(at_O_m, (next_O_m - at_O_m) / step_s, from_s, from_s + step_s));
    at_O_m = next_O_m;
  }
  return room;
}

// As fast as the limits allow; direction 0 is forward, then in turns of 45 degrees to the left.
Vector2 WalkerAvoidance::step_O_m_s(const RobotPose& robot, std::size_t direction) const {
  const math::SinCos to = math::sin_cos(math::kPi / 4.0 * static_cast<double>(direction));
  const math::SinCos yaw = math::sin_cos(robot.yaw_rad);
  const double along = to.cos > 0 ? config_.cruise_m_s : config_.max_back_m_s;
  const double forward = to.cos * along;
  const double left = to.sin * config_.max_left_m_s;
  return {yaw.cos * forward - yaw.sin * left, yaw.sin * forward + yaw.cos * left};
}

// Directions in which something stands.
void WalkerAvoidance::close_ways(const RobotPose& robot, const NearObjects& near) {
  std::array<Vector2, kDirections> unit;
  for (std::size_t i = 0; i < kDirections; ++i) {
    const Vector2 step = step_O_m_s(robot, i);
    const double speed = math::sqrt(step.squaredNorm());
    open_[i] = speed > 0.05;
    unit[i] = open_[i] ? Vector2(step / speed) : Vector2(1, 0);
  }
  const double keep_m = radius_m_ + kGap_m;
  for (const objects::Object* object : near.standing()) {
    for (const Vector2& p_O_m : object->points_O_m) {
      const Vector2 to_m = p_O_m - robot.p_O_m;
      if (to_m.squaredNorm() > math::square(kStepAside_m + keep_m)) continue;
      for (std::size_t i = 0; i < kDirections; ++i) {
        const double along_m = to_m.dot(unit[i]);
        if (along_m <= 0) continue;
        const double rest_m = along_m > kStepAside_m ? along_m - kStepAside_m : 0;
        const double aside_m = math::cross(unit[i], to_m);
        if (rest_m * rest_m + aside_m * aside_m < keep_m * keep_m) open_[i] = false;
      }
    }
  }
}

Evasion WalkerAvoidance::step_aside(const Intent& intent, const NearObjects& near) {
  close_ways(intent.robot, near);
  Evasion evasion;
  evasion.share = 0;
  double best_m = room_at_m(intent.robot.p_O_m, Vector2::Zero(), 0, config_.walker_horizon_s);
  std::size_t chosen = kDirections;
  for (std::size_t i = 0; i < kDirections; ++i) {
    if (!open_[i]) continue;
    const Vector2 velocity = step_O_m_s(intent.robot, i);
    double room = room_at_m(intent.robot.p_O_m, velocity, 0, config_.walker_horizon_s);
    if (i == last_direction_) room += 2.0 * kHysteresis_m;
    if (room <= best_m) continue;
    best_m = room;
    chosen = i;
  }
  last_direction_ = chosen;
  if (chosen == kDirections) return evasion;
  evasion.aside = true;
  evasion.velocity_O_m_s = step_O_m_s(intent.robot, chosen);
  return evasion;
}

Evasion WalkerAvoidance::decide(const Intent& intent, const NearObjects& near, TimeNs stamp) {
  gather(intent, near, stamp);
  if (walkers_.empty()) {
    last_share_ = 0;
    last_direction_ = kDirections;
    return {};
  }
  for (std::size_t i = 0; i < kShares; ++i) {
    const double asked_m =
        i < last_share_ || (last_direction_ != kDirections) ? kHysteresis_m : 0.0;
    if (room_along_m(intent, kShareOf[i], asked_m) < asked_m) continue;
    last_share_ = i;
    last_direction_ = kDirections;
    return {kShareOf[i], false, Vector2::Zero()};
  }
  last_share_ = kShares;
  return step_aside(intent, near);
}

}  // namespace surefoot::navigation
