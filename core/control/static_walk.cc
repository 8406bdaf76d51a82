#include "core/control/static_walk.h"

#include <algorithm>

#include "core/control/joint_commands.h"
#include "core/control/quintic.h"
#include "core/geometry/rotations.h"
#include "core/math/elementary.h"
#include "core/math/gravity.h"
#include "core/robot/kinematics.h"

namespace surefoot::control {
namespace {

constexpr double kFeelsGround = 0.5;     // of a swing: before, the toe has caught on something
constexpr double kShortestShift = 0.25;  // of shift_s: the load still goes from foot to foot
constexpr double kQuinticPeak = 5.7735;  // curvature of the blend: 10 / sqrt(3)
constexpr double kMaxHeadingLag_rad = 0.15;
constexpr double kRetry_s = 0.1;
constexpr double kTipping_m = 0.01;  // of the capture point beyond the triangle
constexpr double kStalled_s = 0.25;  // the trunk waits so long for a foot that lost its ground

}  // namespace

void StaticWalk::reset(const ControlConfig& config, const robot::RobotModel& model) {
  config_ = config;
  model_ = model;
  shape_ = {config.body.height_m, config.body.slope_share, config.foothold.lateral_offset_m,
            config.static_walk.margin_m};
  footholds_.reset(config.foothold, model);
  footsteps_.reset(config.footsteps, model, shape_);
  map_offset_.reset(config.foothold.max_map_offset_m, model.foot_radius_m);
  whole_body_.reset(config.whole_body, model);
  stand();
  feet_.reset(config.swing, config.static_walk);
  counters_ = StaticWalkCounters{};
  joints_ = actuation::JointCommands{};
}

void StaticWalk::stand() {
  stage_ = Stage::kStand;
  turn_ = 0;
  shifted_ = false;
  velocity_ = VelocityCommand{};
  blocked_s_ = 0;
  since_try_s_ = 0;
  avoided_O_m_.clear();
  homeward_ = false;
  asked_ = 0;
  cautious_ = 0;
  stalled_ = false;
  stalled_s_ = 0;
  pace_ = 1;
  legs_.fill(LegStatus{});
  load_.fill(1.0);
}

void StaticWalk::start(const estimation::RobotState& state) {
  stand();
  map_offset_.clear();
  Vector2 centre = Vector2::Zero();
  double feet_m = 0;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const Vector3& foot = state.feet[leg].p_O_m;
    legs_[leg].anchor_O_m = foot;
    legs_[leg].foothold.nominal_O_m = foot;
    legs_[leg].foothold.position_O_m = foot;
    centre += foot.head<2>() / static_cast<double>(robot::kLegs);
    feet_m += foot[2] / static_cast<double>(robot::kLegs);
  }
  feet_.take(state);
  yaw_rad_ = state.yaw_rad;
  to_ = {centre, feet_m - model_.foot_radius_m + config_.body.height_m,
         Vector3(0.0, 0.0, state.yaw_rad)};
  from_ = {state.p_OB_m.head<2>(), state.p_OB_m[2], geometry::to_roll_pitch_yaw(state.R_OB)};
  progress_ = 0;
  duration_s_ = config_.static_walk.shift_s;
}

std::size_t StaticWalk::leg() const { return planning::step_leg(turn_); }

const actuation::JointCommands& StaticWalk::update(const estimation::RobotState& state,
                                                   const mapping::MapWindow* window,
                                                   const terrain::TerrainMap* terrain,
                                                   const VelocityCommand& velocity, bool walking,
                                                   GroundRule rule, double step_s) {
  const bool filled = terrain != nullptr && terrain->ground.cell_size_m > 0;
  const Ground ground{filled ? &terrain->ground : window, filled ? terrain : nullptr, rule};
  map_offset_.update(state, legs_, ground.window);
  feet_.follow(state, legs_, load_, step_s);
  shifted_ = false;
  if (!stalled_) progress_ = math::clamp(progress_ + step_s / duration_s_, 0.0, 1.0);
  follow(velocity, step_s);
  if (walking) {
    yaw_rad_ = state.yaw_rad + math::clamp(math::wrap_angle(yaw_rad_ - state.yaw_rad) +
                                               velocity_.yaw_rate_rad_s * step_s,
                                           -kMaxHeadingLag_rad, kMaxHeadingLag_rad);
  }
  switch (stage_) {
    case Stage::kStand:
      if (!walking) blocked_s_ = 0;
      if (walking) try_step(state, ground, step_s);
      break;
    case Stage::kShift: shift(state, ground.window, step_s); break;
    case Stage::kRetreat:
      if (progress_ >= 1.0) stage_ = Stage::kStand;
      break;
    case Stage::kSwing: swing(state, ground.window, step_s); break;
  }
  command(state);
  return joints_;
}

// A foot lifts off when the trunk is where the others carry it, and comes to rest there.
void StaticWalk::shift(const estimation::RobotState& state, const mapping::MapWindow* window,
                       double step_s) {
  load_[leg()] = 1.0 - quintic(progress_).value;
  if (must_retreat(state, step_s)) return retreat();
  if (stalled_) return;
  if (progress_ < 1.0) return;
  shifted_ = may_lift(state);
  if (shifted_) return lift(state, window);
  waited_s_ += step_s;
  if (waited_s_ < config_.static_walk.patience_s) return;
  ++counters_.waited;
  be_cautious();
  load_[leg()] = 1.0;
  stage_ = Stage::kStand;
}

// During a shift: a foot slips, the trunk tips, or waits in vain for a foot that lost its ground.
bool StaticWalk::must_retreat(const estimation::RobotState& state, double step_s) {
  stalled_ = feet_.have_lost_ground(leg());
  if (stalled_) {
    stalled_s_ += step_s;
    return stalled_s_ > kStalled_s;
  }
  if (feet_.have_slipped(state, leg())) {
    ++counters_.slipped;
    feet_.take(state);
    return true;
  }
  return is_tipping_over_all(state);
}

// Back over the middle of the feet, with all of them on the ground; then another try.
void StaticWalk::retreat() {
  ++counters_.retreated;
  be_cautious();
  stalled_ = false;
  load_.fill(1.0);
  from_ = pose_now().pose;
  to_ = planning::trunk_over(model_, shape_, feet_.places_O_m(), yaw_rad_);
  set_duration();
  stage_ = Stage::kRetreat;
}

double StaticWalk::cycle_s() const {
  const StaticWalkConfig& config = config_.static_walk;
  return static_cast<double>(robot::kLegs) * config.swing_s + 2.0 * config.shift_s;
}

// The trunk sways from side to side with every cycle; whoever steers by its place commands that
// sway's opposite. The mean over a cycle is what is meant.
void StaticWalk::follow(const VelocityCommand& velocity, double step_s) {
  const double share = math::clamp(step_s / cycle_s(), 0.0, 1.0);
  velocity_.forward_m_s += share * (velocity.forward_m_s - velocity_.forward_m_s);
  velocity_.left_m_s += share * (velocity.left_m_s - velocity_.left_m_s);
  velocity_.yaw_rate_rad_s += share * (velocity.yaw_rate_rad_s - velocity_.yaw_rate_rad_s);
}

// Way of the trunk per four steps. A command that is too fast for strides loses its speed, not what
// it says of the way to the side.
Vector2 StaticWalk::stride_O_m() const {
  const double longest_m = config_.static_walk.max_stride_m * pace_;
  const double forward_m = math::clamp(velocity_.forward_m_s * cycle_s(), -longest_m, longest_m);
  const double left_m = math::clamp(velocity_.left_m_s * cycle_s(), -longest_m, longest_m);
  const Vector2 stride = planning::from_heading(yaw_rad_, forward_m, left_m);
  const double length_m = stride.norm();
  return length_m > longest_m ? Vector2(stride * (longest_m / length_m)) : stride;
}

Vector3 StaticWalk::nominal_O_m() const {
  const planning::Hips hips = planning::stance_hips_O_m(model_, shape_.lateral_offset_m, yaw_rad_);
  return planning::nominal_place_O_m(feet_.places_O_m(), hips, leg(), stride_O_m());
}

// Where the centre of mass would come to rest over a foot put there now (linear inverted pendulum).
Vector2 StaticWalk::capture_point_O_m(const estimation::RobotState& state) const {
  const double rate_1_s = math::sqrt(kGravity_m_s2 / config_.body.height_m);
  return state.p_OB_m.head<2>() + centre_offset_O_m(state) + state.v_OB_m_s.head<2>() / rate_1_s;
}

// What made one foot slip may make the next: the trunk moves slowly for a while.
void StaticWalk::be_cautious() { cautious_ = config_.static_walk.cautious_steps; }

bool StaticWalk::may_lift(const estimation::RobotState& state) const {
  for (std::size_t i = 0; i < robot::kLegs; ++i) {
    if (i != leg() && !state.feet[i].in_contact) return false;
  }
  const planning::Triangle triangle = planning::standing_triangle(feet_.places_O_m(), turn_);
  constexpr double kOfRoom = 0.5;
  planning::SupportRegion region;
  const double margin_m =
      std::min(config_.static_walk.lift_margin_m, kOfRoom * triangle.inradius_m());
  return ok(region.add(triangle, margin_m)) && region.contains(capture_point_O_m(state));
}

// Of the feet that stand while the leg of that turn is in the air.
bool StaticWalk::is_beyond(std::size_t turn, const Vector2& capture_point_O_m) const {
  planning::SupportRegion region;
  return ok(region.add(planning::standing_triangle(feet_.places_O_m(), turn), -kTipping_m)) &&
         !region.contains(capture_point_O_m);
}

bool StaticWalk::is_tipping(const estimation::RobotState& state) const {
  return is_beyond(turn_, capture_point_O_m(state));
}

// Inside the triangle of any three feet it is inside that of all four.
bool StaticWalk::is_tipping_over_all(const estimation::RobotState& state) const {
  const Vector2 capture_point = capture_point_O_m(state);
  for (std::size_t turn = 0; turn < robot::kLegs; ++turn) {
    if (!is_beyond(turn, capture_point)) return false;
  }
  return true;
}

// The legs are asked in their order, one a tick; one without a place is passed over. Where none has
// one the search is repeated now and then: the map may have grown.
void StaticWalk::try_step(const estimation::RobotState& state, const Ground& ground,
                          double step_s) {
  since_try_s_ += step_s;
  const bool rests = blocked_s_ > 0 && asked_ == 0 && since_try_s_ < kRetry_s;
  if (!rests) {
    if (begin_step(state, ground)) return;
    turn_ = (turn_ + 1) % robot::kLegs;
    asked_ = (asked_ + 1) % robot::kLegs;
    since_try_s_ = 0;
  }
  blocked_s_ += step_s;
}

// false: the leg has no foothold.
bool StaticWalk::begin_step(const estimation::RobotState& state, const Ground& ground) {
  feet_.take(state);
  Foothold& foothold = legs_[leg()].foothold;
  foothold = choose_foothold(state, ground);
  if (foothold.reason == FootholdReason::kNone) return false;
  if (asked_ > 0) ++counters_.passed_over;
  asked_ = 0;
  blocked_s_ = 0;
  begin_shift(state, ground.terrain);
  return true;
}

Foothold StaticWalk::choose_foothold(const estimation::RobotState& state, const Ground& ground) {
  if (ground.terrain != nullptr) return plan_foothold(state, *ground.terrain);
  return footholds_.choose(nominal_O_m(), ground.window, ground.rule, map_offset_.offset_m());
}

Foothold StaticWalk::plan_foothold(const estimation::RobotState& state,
                                   const terrain::TerrainMap& terrain) {
  planning::FootstepProblem problem;
  problem.feet_O_m = feet_.places_O_m();
  problem.turn = turn_;
  problem.stride_O_m = stride_O_m();
  problem.yaw_rad = yaw_rad_;
  problem.map_offset_m = map_offset_.offset_m();
  problem.centre_offset_O_m = centre_offset_O_m(state);
  problem.avoided_O_m = avoided_O_m_;
  planning::FootstepPlan plan;
  if (!ok(footsteps_.plan(problem, terrain, plan))) {
    const Vector3 nominal = nominal_O_m();
    return {nominal, nominal, FootholdReason::kNone};
  }
  set_pace(plan);
  const planning::Footstep& first = plan.steps[0];
  return {first.nominal_O_m, first.position_O_m, FootholdReason::kPlanned};
}

// Rough ground is walked in shorter strides and with a slower trunk.
void StaticWalk::set_pace(const planning::FootstepPlan& plan) {
  const StaticWalkConfig& config = config_.static_walk;
  double cost = 0;
  for (const planning::Footstep& step : plan.steps) cost += step.terrain;
  cost /= static_cast<double>(plan.steps.size());
  const double span = std::max(config.rough_to - config.rough_from, 1e-6);
  const double rough = math::clamp((cost - config.rough_from) / span, 0.0, 1.0);
  constexpr double kPerStep = 0.5;  // of the difference
  pace_ += kPerStep * (1.0 - rough * (1.0 - config.rough_share) - pace_);
}

void StaticWalk::begin_shift(const estimation::RobotState& state,
                             const terrain::TerrainMap* terrain) {
  from_ = pose_now().pose;
  plan_pose(state, terrain);
  set_duration();
  cautious_ = std::max(0, cautious_ - 1);
  stalled_s_ = 0;
  waited_s_ = 0;
  stage_ = Stage::kShift;
}

// Of the way from one pose to the other, which begins now.
void StaticWalk::set_duration() {
  const StaticWalkConfig& config = config_.static_walk;
  // Turning moves the hips as far as the trunk is long.
  const Vector3 turn_rad = to_.roll_pitch_yaw_rad - from_.roll_pitch_yaw_rad;
  const double lever_m = robot::hip_joint_B_m(model_, robot::kFrontLeft).norm();
  const double way_m = math::sqrt((to_.centre_O_m - from_.centre_O_m).squaredNorm() +
                                  math::square(to_.height_O_m - from_.height_O_m) +
                                  math::square(lever_m) * turn_rad.head<2>().squaredNorm());
  const double speed_m_s = config.shift_speed_m_s * pace_ * (cautious_ > 0 ? config.caution : 1.0);
  duration_s_ = std::max({kShortestShift * config.shift_s, way_m / speed_m_s,
                          math::sqrt(kQuinticPeak * way_m / config.shift_acceleration_m_s2)});
  progress_ = 0;
}

// The trunk's pose for the step under way.
void StaticWalk::plan_pose(const estimation::RobotState& state,
                           const terrain::TerrainMap* terrain) {
  planning::Feet landed = feet_.places_O_m();
  landed[leg()] = legs_[leg()].foothold.position_O_m;
  const planning::Step way{feet_.places_O_m(), landed, turn_, yaw_rad_, centre_offset_O_m(state)};
  const planning::StepPose step =
      planning::step_pose(model_, shape_, planning::step_limits(config_.footsteps),
                          {terrain, map_offset_.offset_m()}, way);
  to_ = step.pose;
  if (step.narrow) ++counters_.narrow;
  if (step.lowered) ++counters_.lowered;
}

void StaticWalk::lift(const estimation::RobotState& state, const mapping::MapWindow* window) {
  LegStatus& status = legs_[leg()];
  status.mode = LegMode::kSwing;
  status.swing_progress = 0;
  status.searched_m = 0;
  status.path.lift_off_O_m = state.feet[leg()].p_O_m;
  status.path.landing_O_m = status.foothold.position_O_m;
  status.path.apex_O_m =
      apex_O_m(status.path, window, model_, config_.swing.clearance_m, map_offset_.offset_m());
  const StaticWalkConfig& config = config_.static_walk;
  const double way_m = (status.path.landing_O_m - status.path.lift_off_O_m).head<2>().norm() +
                       2.0 * status.path.apex_O_m - status.path.lift_off_O_m[2] -
                       status.path.landing_O_m[2];
  status.swing_s = std::max(config.swing_s, way_m / config.foot_speed_m_s);
  load_[leg()] = 0;
  homeward_ = false;
  stage_ = Stage::kSwing;
}

void StaticWalk::swing(const estimation::RobotState& state, const mapping::MapWindow* window,
                       double step_s) {
  LegStatus& status = legs_[leg()];
  const estimation::FootState& foot = state.feet[leg()];
  if (status.mode == LegMode::kSwing) {
    status.swing_progress += step_s / status.swing_s;
    if (foot.in_contact && status.swing_progress >= kFeelsGround) return put_down(state);
    if (feet_.have_slipped(state, leg())) {
      ++counters_.slipped;
      be_cautious();
      feet_.take(state);  // they are held where they are now: one slip is answered once
      begin_search(foot.p_O_m);
    } else if (is_tipping(state)) {
      ++counters_.tipped;
      be_cautious();
      begin_search(foot.p_O_m);
    } else if (status.swing_progress >= 1.0) {
      begin_search(status.path.landing_O_m);
    }
  } else {
    status.searched_m += config_.swing.search_speed_m_s * step_s;
    const bool hangs = foot.in_contact && map_offset_.hangs(foot.p_O_m, window);
    if (foot.in_contact && !hangs) return put_down(state);
    if (hangs) return go_back(state);
    const double lowest_m = std::min(status.path.lift_off_O_m[2], status.path.landing_O_m[2]);
    const double depth_m = config_.swing.search_depth_m + status.anchor_O_m[2] - lowest_m;
    if (status.searched_m >= depth_m) return go_back(state);
  }
  status.height_above_landing_m = foot.p_O_m[2] - status.path.landing_O_m[2];
}

void StaticWalk::begin_search(const Vector3& from_O_m) {
  LegStatus& status = legs_[leg()];
  status.mode = LegMode::kSearch;
  status.anchor_O_m = from_O_m;
  status.searched_m = 0;
}

// To where it has stood, which bears a foot; the place that does not is not tried again.
void StaticWalk::go_back(const estimation::RobotState& state) {
  ++counters_.missed;
  be_cautious();
  LegStatus& status = legs_[leg()];
  if (avoided_O_m_.full()) avoided_O_m_.clear();
  static_cast<void>(avoided_O_m_.push_back(status.path.landing_O_m.head<2>()));
  const Vector3 home = status.path.lift_off_O_m;
  // Nor is there ground where it stood: it hangs there until the trunk has moved.
  if (homeward_) return put_down(state);
  homeward_ = true;
  status.path.lift_off_O_m = state.feet[leg()].p_O_m;
  status.path.landing_O_m = home;
  status.foothold.position_O_m = home;
  status.mode = LegMode::kSwing;
  status.swing_progress = 0;
}

void StaticWalk::put_down(const estimation::RobotState& state) {
  LegStatus& status = legs_[leg()];
  status.mode = LegMode::kStance;
  status.swing_progress = 0;
  status.height_above_landing_m = 0;
  status.anchor_O_m = state.feet[leg()].p_O_m;
  feet_.put(leg(), status.anchor_O_m);
  load_[leg()] = 1;
  ++counters_.steps;
  // A foot that hangs keeps its turn: while it is asked, the others may carry.
  if (state.feet[leg()].in_contact) turn_ = (turn_ + 1) % robot::kLegs;
  stage_ = Stage::kStand;
}

// On the way from the last pose to the next.
StaticWalk::Motion StaticWalk::pose_now() const {
  const Quintic blend = quintic(progress_);
  const double rate = stalled_ ? 0.0 : blend.slope / duration_s_;
  const double curvature = stalled_ ? 0.0 : blend.curvature / math::square(duration_s_);
  const Vector2 way = to_.centre_O_m - from_.centre_O_m;
  const double rise_m = to_.height_O_m - from_.height_O_m;
  Vector3 turn = to_.roll_pitch_yaw_rad - from_.roll_pitch_yaw_rad;
  turn[2] = math::wrap_angle(turn[2]);
  Motion motion;
  motion.pose = {from_.centre_O_m + way * blend.value, from_.height_O_m + rise_m * blend.value,
                 from_.roll_pitch_yaw_rad + turn * blend.value};
  motion.v_O_m_s = {way[0] * rate, way[1] * rate, rise_m * rate};
  motion.a_O_m_s2 = {way[0] * curvature, way[1] * curvature, rise_m * curvature};
  motion.yaw_rate_rad_s = turn[2] * rate;
  return motion;
}

// Of the centre of mass from B's origin, seen from above.
Vector2 StaticWalk::centre_offset_O_m(const estimation::RobotState& state) const {
  return (state.R_OB * whole_body_.dynamics().centroid().p_B_m).head<2>();
}

void StaticWalk::command(const estimation::RobotState& state) {
  const Motion motion = pose_now();
  const Vector3& rpy = motion.pose.roll_pitch_yaw_rad;
  const Vector2 offset = centre_offset_O_m(state);
  const Vector2 origin = motion.pose.centre_O_m - offset;
  BodyTask body;
  body.p_OB_m = Vector3(origin[0], origin[1], motion.pose.height_O_m);
  body.v_OB_m_s = motion.v_O_m_s;
  body.a_OB_m_s2 = motion.a_O_m_s2;
  body.R_OB = geometry::from_roll_pitch_yaw(rpy[0], rpy[1], rpy[2]);
  body.angular_velocity_O_rad_s = Vector3(0.0, 0.0, motion.yaw_rate_rad_s);
  share_load(state, push_N(state, body));
  const LegTasks tasks = leg_tasks(legs_, config_.swing);
  const WholeBodyCommand& wanted = whole_body_.update(whole_body_state(state), body, tasks);
  joints_ = joint_commands(wanted, tasks, config_);
  hold_feet(body);
  for (std::size_t i = 0; i < robot::kLegs; ++i) legs_[i].force_O_N = wanted.force_O_N[i];
}

// Standing legs keep their feet where they are under the trunk's wanted pose: a foot that carries
// next to nothing would be dragged along otherwise.
void StaticWalk::hold_feet(const BodyTask& body) {
  for (std::size_t i = 0; i < robot::kLegs; ++i) {
    if (legs_[i].mode != LegMode::kStance) continue;
    const Vector3 foot_B = body.R_OB.transpose() * (feet_.places_O_m()[i] - body.p_OB_m);
    const robot::LegVector q_rad = robot::solve_leg(model_, i, foot_B).q_rad;
    for (std::size_t k = 0; k < robot::kJointsPerLeg; ++k) {
      joints_[robot::joint_index(i, k)].position_rad = q_rad[static_cast<Eigen::Index>(k)];
    }
  }
}

void StaticWalk::share_load(const estimation::RobotState& state, const Vector3& force_O_N) {
  LoadShares shares{};
  for (std::size_t i = 0; i < robot::kLegs; ++i) {
    if (legs_[i].mode == LegMode::kStance) shares[i] = load_[i];
  }
  const Vector3 centre = state.p_OB_m + state.R_OB * whole_body_.dynamics().centroid().p_B_m;
  const auto forces = control::share_load(feet_of(state), shares, centre, force_O_N);
  for (std::size_t i = 0; i < robot::kLegs; ++i) legs_[i].force_O_N = forces[i];
}

// The force that holds the robot up and on its path.
Vector3 StaticWalk::push_N(const estimation::RobotState& state, const BodyTask& body) const {
  const WholeBodyConfig& gains = config_.whole_body;
  Vector3 acceleration = body.a_OB_m_s2;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    acceleration[i] += gains.position_gain_1_s2[axis] * (body.p_OB_m[i] - state.p_OB_m[i]) +
                       gains.velocity_gain_1_s[axis] * (body.v_OB_m_s[i] - state.v_OB_m_s[i]);
  }
  return model_.total_mass_kg() * (acceleration + Vector3(0.0, 0.0, kGravity_m_s2));
}

}  // namespace surefoot::control
