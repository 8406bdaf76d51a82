#include "core/navigation/planner.h"

namespace surefoot::navigation {
namespace {

constexpr double kDoubted_s = 300.0;  // what was remembered for longer may have changed

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
  if (map_.lethal(start)) static_cast<void>(map_.nearest_free(start, map_.side(), start));
  return start;
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
  goal_ends(map_, input.goal_O_m, config_.follow.arrive_m + map_.lethal_radius_m(), ends_);
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
  const Cell start = choose_start(input);
  stability_.discount(map_, input.robot.p_O_m);
  const SearchResult result = search(input, start, plan);
  plan.closed = result.closed;
  if (result.found || result.partial) shape(input, result, plan);
  judge(input, result, plan);
}

}  // namespace surefoot::navigation
