#include "core/navigation/planner.h"

#include <algorithm>
#include <limits>

#include "core/math/elementary.h"

namespace surefoot::navigation {
namespace {

constexpr double kDoubted_s = 300.0;  // what was remembered for longer may have changed
constexpr double kWayOut = 3.0;       // lethal radii: farther is no way out of a tight place

// From a segment to the nearest point of what stands.
double room_beside_m(const objects::Objects& objects, const Vector2& from, const Vector2& to) {
  const Vector2 way = to - from;
  const double length_m2 = way.squaredNorm();
  double nearest_m2 = std::numeric_limits<double>::max();
  for (const objects::Object& object : objects) {
    if (object.kind == objects::ObjectClass::kGround || object.moving) continue;
    for (const Vector2& p : object.points_O_m) {
      const double share =
          length_m2 > 0 ? math::clamp((p - from).dot(way) / length_m2, 0.0, 1.0) : 0.0;
      nearest_m2 = std::min(nearest_m2, (p - from - share * way).squaredNorm());
    }
  }
  return math::sqrt(nearest_m2);
}

}  // namespace

void Planner::reset(const NavigationConfig& config) {
  config_ = config;
  map_.reset(config);
  memory_.reset(config);
  stability_.reset(config.shape);
  smoothing_.reset(config.shape);
  started_ = false;
  forget();
}

void Planner::forget() {
  stability_.forget();
  watch_.reset(config_.way);
  enclosed_plans_ = 0;
  forgot_ = false;
}

double Planner::metres(std::uint32_t cost) const {
  return cost * map_.cell_m() / (static_cast<double>(kFreeCost) * kStraight);
}

void Planner::make_map(const PlanInput& input) {
  map_.clear(input.robot.p_O_m);
  map_.add_standing(input.objects);
  memory_.update(map_, input.robot);
  map_.add_walkers(input.objects, input.robot.p_O_m, config_.follow.cruise_m_s);
}

Cell Planner::choose_start(const PlanInput& input) {
  const Vector2 robot_O_m = input.robot.p_O_m;
  Vector2 start_O_m = stability_.start_O_m(robot_O_m);
  // The last path is of no use where it is blocked, or where something stands between.
  if (map_.lethal_at(start_O_m) ||
      (!map_.lethal_at(robot_O_m) && !map_.passable(robot_O_m, start_O_m))) {
    stability_.leave_path();
    start_O_m = robot_O_m;
  }
  Cell start = map_.cell_of(start_O_m);
  return map_.lethal(start) ? way_out(input, start) : start;
}

// Something stands nearer than the clearance. The robot leaves to the nearest cell that leads on,
// not nearer to anything than it is; free cells between obstacles would be taken for a prison.
Cell Planner::way_out(const PlanInput& input, Cell from) {
  reach_.flood_from_outside(map_, ends_);
  const Vector2 robot_O_m = input.robot.p_O_m;
  const double room_m =
      std::min(config_.half_width_m, room_beside_m(input.objects, robot_O_m, robot_O_m));
  const auto leads_on = [&](Cell cell) {
    if (!reach_.contains(map_.index(cell))) return false;
    return room_beside_m(input.objects, robot_O_m, map_.centre_of_O_m(cell)) >= room_m;
  };
  Cell out = from;
  const auto rings = static_cast<std::int32_t>(kWayOut * map_.lethal_radius_m() / map_.cell_m());
  if (map_.nearest(from, rings, leads_on, out)) return out;
  static_cast<void>(map_.nearest_free(from, map_.side(), out));
  return out;
}

// Border cells from where the field leads on, of those that can be reached.
bool Planner::find_ends_beyond(const PlanInput& input, bool lenient) {
  if (!field_.spread(memory_, input.goal_O_m, config_.way.unknown_factor, lenient)) return false;
  border_ends(map_, input.goal_O_m, &field_, &reach_, ends_);
  return !ends_.list.empty();
}

// Whether anything leads from the goal to the map's border.
bool Planner::goal_leads_out(const PlanInput& input) {
  if (ends_.list.empty()) return !map_.inside(map_.cell_of(input.goal_O_m));
  reach_.flood(map_, map_.cell(ends_.list[0].cell));
  return reach_.touches_border();
}

// Floods tell beforehand whether there is a way: at most one search, and that one finds.
SearchResult Planner::search(const PlanInput& input, Cell start, Plan& plan) {
  reach_.flood(map_, start);
  plan.to_goal = !ends_.list.empty() && reach_.contains(ends_.list[0].cell);
  if (!plan.to_goal) {
    if (!goal_leads_out(input)) {
      plan.outcome = PlanOutcome::kGoalEnclosed;
      return {};
    }
    reach_.flood(map_, start);
    if (!find_ends_beyond(input, false) && !find_ends_beyond(input, true)) {
      plan.outcome = PlanOutcome::kRobotEnclosed;
      return {};
    }
  }
  const SearchResult result = search_.search(map_, start, ends_, searched_O_m_);
  plan.to_goal = plan.to_goal && result.found;
  if (!result.found && !result.partial) plan.outcome = PlanOutcome::kRobotEnclosed;
  return result;
}

void Planner::shape(const PlanInput& input, const SearchResult& result, Plan& plan) {
  plan.outcome = result.partial ? PlanOutcome::kPartial : PlanOutcome::kPath;
  const Cell goal = map_.cell_of(input.goal_O_m);
  if (plan.to_goal && map_.inside(goal) && result.end_cell == map_.index(goal) &&
      !result.truncated) {
    searched_O_m_.back() = input.goal_O_m;
  }
  stability_.take(searched_O_m_, input.robot.p_O_m, input.past_O_m, raw_O_m_);
  plan.smoothing = smoothing_.smooth(map_, raw_O_m_, plan.path);
  smoothing_.over_smooth(searched_O_m_, over_smoothed_O_m_);
  stability_.take_over_smoothed(over_smoothed_O_m_);
}

void Planner::judge(const PlanInput& input, const SearchResult& result, Plan& plan) {
  if (result.found || result.partial) {
    enclosed_plans_ = 0;
    plan.rest_m = metres(result.cost);
    plan.live_lock = watch_.stuck(plan.rest_m, memory_.learnt(), input.stamp);
    return;
  }
  stability_.forget();
  ++enclosed_plans_;
  if (enclosed_plans_ < config_.way.no_path_plans) return;
  const bool old = (input.stamp - known_since_).seconds() > kDoubted_s;
  if (forgot_ || !old) {
    plan.enclosed = true;
    return;
  }
  forgot_ = true;
  known_since_ = input.stamp;
  enclosed_plans_ = 0;
  memory_.forget_far(input.robot.p_O_m);
}

void Planner::run(const PlanInput& input, Plan& plan) {
  plan.to_goal = false;
  plan.enclosed = false;
  plan.live_lock = false;
  plan.rest_m = 0;
  plan.smoothing = {};
  plan.goal_number = input.goal_number;
  plan.stamp = input.stamp;
  plan.path.clear();
  if (!started_) known_since_ = input.stamp;
  started_ = true;
  make_map(input);
  goal_ends(map_, input.goal_O_m, config_.follow.arrive_m + map_.lethal_radius_m(), ends_);
  const Cell start = choose_start(input);
  stability_.discount(map_, input.robot.p_O_m);
  const SearchResult result = search(input, start, plan);
  plan.closed = result.closed;
  if (result.found || result.partial) shape(input, result, plan);
  judge(input, result, plan);
}

}  // namespace surefoot::navigation
