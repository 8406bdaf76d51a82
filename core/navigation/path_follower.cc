#include "core/navigation/path_follower.h"

#include <algorithm>

#include "core/math/elementary.h"

namespace surefoot::navigation {
namespace {

constexpr double kMaxTick_s = 0.05;
constexpr double kCreep_m_s = 0.05;   // the last centimetres to the goal
constexpr double kStopGap_m = 0.08;   // left before what blocks
constexpr double kDiscStep_m = 0.16;  // between discs of the corridor

double turned_towards(double target, double from, double step) {
  return from + math::clamp(target - from, -step, step);
}

// Up with one acceleration, down with another.
double speed_towards(double target, double from, double up, double down) {
  const bool slows = math::magnitude(target) < math::magnitude(from) || target * from < 0;
  return turned_towards(target, from, slows ? down : up);
}

}  // namespace

void PathFollower::reset(const NavigationConfig& config) {
  config_ = config;
  walkers_.reset(config);
  path_ = nullptr;
  command_ = {};
  started_ = false;
  reason_ = SpeedReason::kNoPath;
}

void PathFollower::set_path(const Path* path) {
  path_ = path != nullptr && path->size() >= 2 ? path : nullptr;
  fresh_ = true;
}

void PathFollower::locate(const RobotPose& robot) {
  const Path& path = *path_;
  std::size_t first = 0;
  std::size_t end = path.size() - 1;
  if (!fresh_) {
    first = place_.sample > kNearby / 4 ? place_.sample - kNearby / 4 : 0;
    if (place_.sample + kNearby < end) end = place_.sample + kNearby;
  }
  fresh_ = false;
  double best2 = -1;
  for (std::size_t i = first; i < end; ++i) {
    const Vector2 way_m = path[i + 1].p_O_m - path[i].p_O_m;
    const double length2 = way_m.squaredNorm();
    if (!(length2 > 0)) continue;
    const double share = math::clamp((robot.p_O_m - path[i].p_O_m).dot(way_m) / length2, 0.0, 1.0);
    const Vector2 p_O_m = path[i].p_O_m + way_m * share;
    const double far2 = (robot.p_O_m - p_O_m).squaredNorm();
    if (best2 >= 0 && far2 >= best2) continue;
    best2 = far2;
    place_.sample = i;
    place_.at_m = path[i].along_m + (path[i + 1].along_m - path[i].along_m) * share;
    place_.p_O_m = p_O_m;
  }
  const double lead_m = std::max(0.0, command_.forward_m_s) * config_.follow.reaction_s;
  place_.ahead = path[sample_at(place_.at_m + lead_m)];
  off_path_m_ = math::cross(path[place_.sample].tangent_O, robot.p_O_m - place_.p_O_m);
  to_end_m_ = path.back().along_m - place_.at_m;
}

std::size_t PathFollower::sample_at(double along_m) const {
  std::size_t i = place_.sample;
  while (i + 1 < path_->size() && (*path_)[i].along_m < along_m) ++i;
  return i;
}

double PathFollower::curve_limit_m_s() const {
  const FollowConfig& follow = config_.follow;
  double limit2 = math::square(follow.cruise_m_s);
  const double reach_m = limit2 / (2.0 * follow.braking_m_s2) + follow.cruise_m_s;
  for (std::size_t i = place_.sample; i < path_->size(); ++i) {
    const PathPoint& point = (*path_)[i];
    const double way_m = std::max(0.0, point.along_m - place_.at_m);
    if (way_m > reach_m) break;
    const double bend = math::magnitude(point.curvature_1_m);
    if (bend < 1e-3) continue;
    const double by_side = follow.side_acceleration_m_s2 / bend;
    // A share of the yaw rate is left for corrections.
    const double by_yaw = math::square(0.7 * follow.max_yaw_rate_rad_s / bend);
    limit2 = std::min(limit2, std::min(by_side, by_yaw) + 2.0 * follow.braking_m_s2 * way_m);
  }
  return math::sqrt(limit2);
}

// Numbers rise from disc to disc: what is drawn stays.
void PathFollower::draw_disc(const Vector2& p_O_m, std::uint8_t number) {
  // Without gaps between discs, and half a cell's diagonal more, so that no point is missed.
  const double radius_m =
      math::sqrt(math::square(corridor_radius_m()) + math::square(0.5 * kDiscStep_m));
  const double reach = radius_m / kGridCell_m + 0.71;
  const Vector2 at = (p_O_m - corridor_corner_O_m_) / kGridCell_m;
  const auto bound = [](std::int32_t i) { return math::clamp(i, 0, kGridSide - 1); };
  const std::int32_t y1 = bound(math::floor_of(at[1] + reach));
  for (std::int32_t y = bound(math::floor_of(at[1] - reach)); y <= y1; ++y) {
    const double width2 = reach * reach - math::square(y + 0.5 - at[1]);
    if (width2 <= 0) continue;
    const double width = math::sqrt(width2) - 0.5;
    std::uint8_t* row = corridor_.data() + y * kGridSide;
    const std::int32_t x1 = bound(math::floor_of(at[0] + width));
    for (std::int32_t x = bound(math::floor_of(at[0] - width)); x <= x1; ++x) {
      row[x] = std::min(row[x], number);
    }
  }
}

// The robot comes back to the path within about a metre.
void PathFollower::draw_corridor(const RobotPose& robot) {
  const FollowConfig& follow = config_.follow;
  const Path& path = *path_;
  corridor_.fill(kClear);
  const double side_m = kGridSide * kGridCell_m;
  corridor_corner_O_m_ = robot.p_O_m - Vector2(0.5, 0.5) * side_m;
  const double wanted_m = math::square(follow.cruise_m_s) / (2.0 * follow.braking_m_s2) +
                          follow.cruise_m_s * follow.reaction_s + config_.half_length_m + 0.3;
  const double radius_m = config_.half_width_m + config_.map.clearance_m;
  const double end_m = std::min(wanted_m, 0.5 * side_m - radius_m);
  const Vector2 off_m = robot.p_O_m - place_.p_O_m;
  discs_ = 0;
  std::size_t i = place_.sample;
  for (double way_m = 0; way_m <= end_m && discs_ < kClear; way_m += kDiscStep_m) {
    if (way_m > to_end_m_ + kDiscStep_m) break;
    const double along_m = std::min(place_.at_m + way_m, path.back().along_m);
    while (i + 2 < path.size() && path[i + 1].along_m < along_m) ++i;
    const double spacing_m = std::max(1e-9, path[i + 1].along_m - path[i].along_m);
    const double share = math::clamp((along_m - path[i].along_m) / spacing_m, 0.0, 1.0);
    Disc& disc = corridor_O_m_[discs_];
    disc.way_m = way_m;
    disc.p_O_m = path[i].p_O_m + (path[i + 1].p_O_m - path[i].p_O_m) * share +
                 off_m * std::max(0.0, 1.0 - way_m);
    disc.to_O = path[i].tangent_O;
    draw_disc(disc.p_O_m, static_cast<std::uint8_t>(discs_));
    ++discs_;
  }
  for (std::size_t k = 0; k + 1 < discs_; ++k) {
    const Vector2 step_m = corridor_O_m_[k + 1].p_O_m - corridor_O_m_[k].p_O_m;
    const double length_m = math::sqrt(step_m.squaredNorm());
    if (length_m > 1e-3) corridor_O_m_[k].to_O = step_m / length_m;
  }
}

// Straight on from the first disc that comes near the point; far: it passes beside it.
double PathFollower::way_to_touch_m(const Vector2& p_O_m, std::uint8_t number) const {
  const Disc& disc = corridor_O_m_[number];
  const Vector2 to_m = p_O_m - disc.p_O_m;
  const double aside_m = math::cross(disc.to_O, to_m);
  const double ahead_m = to_m.dot(disc.to_O);
  const double room2 = math::square(corridor_radius_m()) - aside_m * aside_m;
  const bool passed = ahead_m < 0 && ahead_m * ahead_m >= room2;
  if (room2 <= 0 || passed) return 2.0 * config_.way.sight_range_m;
  return std::max(0.0, disc.way_m + ahead_m - math::sqrt(room2));
}

void PathFollower::measure_free_way(const RobotPose& robot, const objects::Objects& objects) {
  draw_corridor(robot);
  const Vector2 off_m = robot.p_O_m - place_.p_O_m;
  near_.gather(objects, robot.p_O_m,
               corridor_O_m_[discs_ - 1].way_m + math::sqrt(off_m.squaredNorm()) + 1.0,
               config_.follow.walker_horizon_s <= 0);
  const double beside2 = 1.5 * math::square(corridor_radius_m());
  const Vector2 to_O = (*path_)[sample_at(place_.at_m + 0.3)].p_O_m - robot.p_O_m;
  const double front_m = std::max(0.0, config_.half_length_m - config_.half_width_m) + kStopGap_m;
  double touch_m = config_.way.sight_range_m + front_m;
  for (const objects::Object* object : near_.standing()) {
    for (const Vector2& p_O_m : object->points_O_m) {
      const double x = (p_O_m[0] - corridor_corner_O_m_[0]) * (1.0 / kGridCell_m);
      const double y = (p_O_m[1] - corridor_corner_O_m_[1]) * (1.0 / kGridCell_m);
      if (!(x >= 0 && y >= 0 && x < kGridSide && y < kGridSide)) continue;
      const std::int32_t cell =
          static_cast<std::int32_t>(y) * kGridSide + static_cast<std::int32_t>(x);
      const std::uint8_t number = corridor_[static_cast<std::size_t>(cell)];
      if (number == kClear || corridor_O_m_[number].way_m - kDiscStep_m > touch_m) continue;
      // Too near already: no obstacle for a way that leads off.
      const Vector2 from_robot = p_O_m - robot.p_O_m;
      if (from_robot.squaredNorm() < beside2 && from_robot.dot(to_O) <= 0) continue;
      touch_m = std::min(touch_m, way_to_touch_m(p_O_m, number));
    }
  }
  free_m_ = std::max(0.0, touch_m - front_m);
}

double PathFollower::speed_limit_m_s() {
  const FollowConfig& follow = config_.follow;
  const auto within = [&follow](double way_m) {
    // v r + v^2 / 2 a = d: the reaction's way is free as well.
    const double lost = follow.braking_m_s2 * follow.reaction_s;
    return math::sqrt(lost * lost + 2.0 * follow.braking_m_s2 * way_m) - lost;
  };
  double limit = follow.cruise_m_s;
  reason_ = SpeedReason::kNone;
  const auto lower = [&](double to, SpeedReason why) {
    if (to >= limit) return;
    limit = to;
    reason_ = why;
  };
  lower(curve_limit_m_s(), SpeedReason::kCurve);
  lower(std::max(kCreep_m_s, within(to_end_m_)), SpeedReason::kEnd);
  lower(within(free_m_), SpeedReason::kBlocked);
  return limit;
}

double PathFollower::turning_share(double error_rad) const {
  const double turn_only = config_.follow.turn_only_rad;
  return math::clamp(2.0 * (turn_only - math::magnitude(error_rad)) / turn_only, 0.0, 1.0);
}

VelocityCommand PathFollower::near_command(const RobotPose& robot, double speed_m_s) {
  const FollowConfig& follow = config_.follow;
  const Vector2 tangent = place_.ahead.tangent_O;
  const double error = math::wrap_angle(math::atan2(tangent[1], tangent[0]) - robot.yaw_rad);
  const double share = turning_share(error);
  if (share == 0) reason_ = SpeedReason::kTurning;
  const double side =
      math::clamp(-follow.side_gain_1_s * off_path_m_, -follow.max_left_m_s, follow.max_left_m_s);
  const double side_share = std::min(1.0, speed_m_s / (0.25 * follow.cruise_m_s));
  const Vector2 v_O =
      tangent * (speed_m_s * share) + math::left_of(tangent) * (side * share * side_share);
  const math::SinCos yaw = math::sin_cos(robot.yaw_rad);
  const Vector2 heading(yaw.cos, yaw.sin);
  return {v_O.dot(heading), v_O.dot(math::left_of(heading)),
          follow.yaw_gain_1_s * error + place_.ahead.curvature_1_m * speed_m_s * share};
}

VelocityCommand PathFollower::far_command(const RobotPose& robot, double speed_m_s) const {
  const FollowConfig& follow = config_.follow;
  const PathPoint& target = (*path_)[sample_at(place_.at_m + follow.target_m)];
  const Vector2 way_m = target.p_O_m - robot.p_O_m;
  const double error = math::wrap_angle(math::atan2(way_m[1], way_m[0]) - robot.yaw_rad);
  return {speed_m_s * turning_share(error), 0, follow.yaw_gain_1_s * error};
}

VelocityCommand PathFollower::steer(const RobotPose& robot, double speed_m_s) {
  const FollowConfig& follow = config_.follow;
  const double off_m = math::sqrt((robot.p_O_m - place_.p_O_m).squaredNorm());
  const double band_m = std::max(1e-3, follow.far_m - follow.near_m);
  const double far = math::clamp((off_m - follow.near_m) / band_m, 0.0, 1.0);
  const VelocityCommand a = near_command(robot, speed_m_s);
  const VelocityCommand b = far_command(robot, speed_m_s);
  return {a.forward_m_s + far * (b.forward_m_s - a.forward_m_s),
          a.left_m_s + far * (b.left_m_s - a.left_m_s),
          a.yaw_rate_rad_s + far * (b.yaw_rate_rad_s - a.yaw_rate_rad_s)};
}

VelocityCommand PathFollower::limited(const VelocityCommand& wanted, double dt_s) const {
  const FollowConfig& follow = config_.follow;
  const double forward = math::clamp(wanted.forward_m_s, -follow.max_back_m_s, follow.cruise_m_s);
  const double left = math::clamp(wanted.left_m_s, -follow.max_left_m_s, follow.max_left_m_s);
  const double yaw =
      math::clamp(wanted.yaw_rate_rad_s, -follow.max_yaw_rate_rad_s, follow.max_yaw_rate_rad_s);
  const double up = follow.acceleration_m_s2 * dt_s;
  const double down = std::max(up, follow.braking_m_s2 * dt_s);
  return {speed_towards(forward, command_.forward_m_s, up, down),
          speed_towards(left, command_.left_m_s, up, down),
          turned_towards(yaw, command_.yaw_rate_rad_s, follow.yaw_acceleration_rad_s2 * dt_s)};
}

VelocityCommand PathFollower::follow(const RobotPose& robot, const objects::Objects& objects,
                                     TimeNs stamp) {
  const double dt_s = started_ ? math::clamp((stamp - last_).seconds(), 0.0, kMaxTick_s) : 0;
  started_ = true;
  last_ = stamp;
  Intent intent;
  intent.robot = robot;
  VelocityCommand wanted;
  if (path_ != nullptr) {
    locate(robot);
    measure_free_way(robot, objects);
    intent.path = path_;
    intent.sample = place_.sample;
    intent.at_m = place_.at_m;
    intent.off_path_O_m = robot.p_O_m - place_.p_O_m;
    intent.speed_m_s = speed_limit_m_s();
  } else {
    reason_ = SpeedReason::kNoPath;
    free_m_ = 0;
    near_.gather(objects, robot.p_O_m, WalkerAvoidance::kLooksAround_m,
                 config_.follow.walker_horizon_s <= 0);
  }
  const Evasion evasion = walkers_.decide(intent, near_, stamp);
  if (evasion.aside) {
    const math::SinCos yaw = math::sin_cos(robot.yaw_rad);
    const Vector2 heading(yaw.cos, yaw.sin);
    wanted.forward_m_s = evasion.velocity_O_m_s.dot(heading);
    wanted.left_m_s = evasion.velocity_O_m_s.dot(math::left_of(heading));
    reason_ = SpeedReason::kAside;
  } else if (path_ != nullptr) {
    if (evasion.share < 1) reason_ = SpeedReason::kWalker;
    wanted = steer(robot, intent.speed_m_s * evasion.share);
  }
  command_ = limited(wanted, dt_s);
  return command_;
}

}  // namespace surefoot::navigation
