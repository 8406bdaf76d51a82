#include "core/control/locomotion.h"

#include "core/control/joint_commands.h"
#include "core/geometry/rotations.h"
#include "core/math/elementary.h"
#include "core/math/gravity.h"

namespace surefoot::control {
namespace {

double ramp(double value, double target, double max_change) {
  return value + math::clamp(target - value, -max_change, max_change);
}

// The ramp ends in exact zeros.
bool is_zero(const VelocityCommand& c) {
  return c.forward_m_s == 0.0 && c.left_m_s == 0.0 && c.yaw_rate_rad_s == 0.0;
}

double larger(double a, double b) { return a > b ? a : b; }

}  // namespace

void Locomotion::reset(const ControlConfig& config, const robot::RobotModel& model) {
  config_ = config;
  model_ = model;
  gait_.reset(config.gaits.of(GaitKind::kTrot));
  footholds_.reset(config.foothold, model);
  map_offset_.reset(config.foothold.max_map_offset_m, model.foot_radius_m);
  whole_body_.reset(config.whole_body, model);
  tracker_.reset(config.body, model);
  reference_ = BodyReference{};
  command_ = VelocityCommand{};
  ground_ = GroundRule::kGood;
  gait_running_ = false;
  halted_s_ = 0;
  blocked_s_ = 0;
  legs_.fill(LegStatus{});
  joints_ = actuation::JointCommands{};
}

void Locomotion::start(const estimation::RobotState& state) {
  gait_running_ = false;
  command_ = VelocityCommand{};
  legs_.fill(LegStatus{});
  tracker_.start(state);
  map_offset_.clear();
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    legs_[leg].anchor_O_m = state.feet[leg].p_O_m;
    legs_[leg].foothold.nominal_O_m = state.feet[leg].p_O_m;
    legs_[leg].foothold.position_O_m = state.feet[leg].p_O_m;
  }
}

bool Locomotion::all_in_stance() const {
  for (const LegStatus& leg : legs_) {
    if (leg.mode != LegMode::kStance) return false;
  }
  return true;
}

const actuation::JointCommands& Locomotion::update(const estimation::RobotState& state,
                                                   const mapping::MapWindow* window,
                                                   const WalkCommand& command,
                                                   const ForcePlan& plan, double step_s) {
  const bool walking = command.gait != GaitKind::kStand;
  // Without footholds the body must not run ahead of its feet.
  constexpr double kBlockedSlowdown_s = 0.5;
  const double share = walking ? math::clamp(1.0 - blocked_s_ / kBlockedSlowdown_s, 0.0, 1.0) : 0.0;
  const double change = config_.body.max_acceleration_m_s2 * step_s;
  const VelocityCommand& wanted = command.velocity;
  command_.forward_m_s = ramp(command_.forward_m_s, wanted.forward_m_s * share, change);
  command_.left_m_s = ramp(command_.left_m_s, wanted.left_m_s * share, change);
  command_.yaw_rate_rad_s =
      ramp(command_.yaw_rate_rad_s, wanted.yaw_rate_rad_s * share, 4.0 * change);

  const bool stepping = advance_gait(command.gait, step_s);
  tracker_.update(state, command_, step_s);
  reference_ = tracker_.reference();
  ground_ = ground_rule(state, command.ground);
  map_offset_.update(state, legs_, window);
  bool blocked = false;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    advance_leg(leg, state, window, stepping, step_s);
    blocked = blocked || legs_[leg].skipped_swing;
  }
  if (walking) blocked_s_ = blocked ? blocked_s_ + step_s : larger(0.0, blocked_s_ - step_s);

  plan_forces(state, plan);
  control_body(state);
  return joints_;
}

// Standing legs that miss a step are left behind by what the body is to do in a period. What a
// shove does to it is over soon: then a leg is better off on good ground.
GroundRule Locomotion::ground_rule(const estimation::RobotState& state, GroundRule wanted) const {
  const FootholdConfig& config = config_.foothold;
  const Vector2 wanted_m_s = reference_.v_OB_m_s.head<2>();
  const double period_s = gait_.config().period_s;
  if (wanted_m_s.squaredNorm() * math::square(period_s) > math::square(config.max_drag_m)) {
    return GroundRule::kAny;
  }
  const Vector2 off = state.v_OB_m_s.head<2>() - wanted_m_s;
  const bool off_balance = off.squaredNorm() > math::square(config.balance_error_m_s);
  return off_balance ? GroundRule::kGoodOrUnseen : wanted;
}

// The clock stands still while all legs stand and no step is due, and starts from the beginning.
bool Locomotion::advance_gait(GaitKind gait, double step_s) {
  const bool walking = gait != GaitKind::kStand;
  if (walking && !gait_running_) {
    gait_.reset(config_.gaits.of(gait));
    gait_running_ = true;
  }
  if (walking) gait_.change_to(config_.gaits.of(gait));
  halted_s_ = walking || !is_zero(command_) ? 0.0 : halted_s_ + step_s;
  const bool stepping = gait_running_ && halted_s_ < gait_.config().period_s;
  if (!stepping && all_in_stance()) gait_running_ = false;
  if (gait_running_) gait_.advance(step_s);
  return stepping;
}

void Locomotion::advance_leg(std::size_t leg, const estimation::RobotState& state,
                             const mapping::MapWindow* window, bool stepping, double step_s) {
  LegStatus& status = legs_[leg];
  const LegPhase& phase = gait_.legs()[leg];
  const estimation::FootState& foot = state.feet[leg];
  const bool should_stand = phase.stance || !gait_running_;
  if (should_stand) status.skipped_swing = false;

  switch (status.mode) {
    case LegMode::kStance:
      if (!should_stand && stepping && !status.skipped_swing) {
        try_swing(leg, state, window);
      } else if (!foot.in_contact) {
        status.mode = LegMode::kSearch;
        status.anchor_O_m = foot.p_O_m;
        status.searched_m = 0;
      }
      break;
    case LegMode::kSwing:
      if (should_stand || foot.in_contact) {
        status.mode = foot.in_contact ? LegMode::kStance : LegMode::kSearch;
        status.anchor_O_m = status.path.landing_O_m;
        status.searched_m = 0;
        // An early touchdown ends this swing; the leg stands until the next one.
        status.skipped_swing = false;
        status.swing_progress = 0;
        status.landed_early = !should_stand;
      } else {
        follow_foothold(leg, state, window);
        status.swing_progress = 1.0 - phase.remaining_s / status.swing_s;
      }
      break;
    case LegMode::kSearch:
      status.searched_m = math::clamp(status.searched_m + config_.swing.search_speed_m_s * step_s,
                                      0.0, config_.swing.search_depth_m);
      if (foot.in_contact) {
        status.mode = LegMode::kStance;
      } else if (!should_stand && stepping && !status.skipped_swing) {
        try_swing(leg, state, window);
      }
      break;
  }
  if (should_stand) status.landed_early = false;
  status.height_above_landing_m =
      status.mode == LegMode::kSwing ? foot.p_O_m[2] - status.path.landing_O_m[2] : 0.0;
}

void Locomotion::try_swing(std::size_t leg, const estimation::RobotState& state,
                           const mapping::MapWindow* window) {
  LegStatus& status = legs_[leg];
  if (status.landed_early) return;
  status.foothold = find_foothold(leg, state, window);
  if (status.foothold.reason == FootholdReason::kNone) {
    status.skipped_swing = true;
    return;
  }
  status.mode = LegMode::kSwing;
  status.swing_progress = 0;
  status.swing_s = gait_.legs()[leg].remaining_s;
  status.path.lift_off_O_m = state.feet[leg].p_O_m;
  set_path(leg, window);
}

// Keeps the target up to date with velocity and map until it is locked. A target that can no longer
// be replaced by a good one stays.
void Locomotion::follow_foothold(std::size_t leg, const estimation::RobotState& state,
                                 const mapping::MapWindow* window) {
  LegStatus& status = legs_[leg];
  if (status.swing_progress > config_.foothold.lock_progress) return;
  const Foothold next = find_foothold(leg, state, window);
  if (next.reason == FootholdReason::kNone) return;
  status.foothold = next;
  set_path(leg, window);
}

Foothold Locomotion::find_foothold(std::size_t leg, const estimation::RobotState& state,
                                   const mapping::MapWindow* window) const {
  const Vector3 nominal =
      footholds_.nominal_O_m(leg, state, command_, gait_.legs()[leg].remaining_s,
                             gait_.config().stance_s(), reference_.ground_z_m);
  return footholds_.choose(nominal, window, ground_, map_offset_.offset_m());
}

void Locomotion::set_path(std::size_t leg, const mapping::MapWindow* window) {
  LegStatus& status = legs_[leg];
  SwingPath& path = status.path;
  path.landing_O_m = status.foothold.position_O_m;
  path.apex_O_m = apex_O_m(path, window, model_, config_.swing.clearance_m, map_offset_.offset_m());
}

void Locomotion::plan(const estimation::RobotState& state, MpcProblem& problem) const {
  plan_horizon({model_, config_, state, reference_, command_, gait_, gait_running_, legs_},
               problem);
}

// The forces that the predictive controller wants now, of the feet that stand. Before its first
// plan, and where the last one ended before now (the robot fell since), the feet share the weight.
void Locomotion::plan_forces(const estimation::RobotState& state, const ForcePlan& plan) {
  double standing = 0;
  for (const LegStatus& leg : legs_) standing += leg.mode == LegMode::kStance ? 1.0 : 0.0;
  const double age_s = (state.stamp - plan.stamp).seconds();
  const double steps = age_s / config_.mpc.step_s;
  const bool covered = plan.valid && steps >= 0.0 && steps < static_cast<double>(kMpcHorizon);
  const std::size_t k = covered ? static_cast<std::size_t>(steps) : 0;
  const double share_N = model_.total_mass_kg() * kGravity_m_s2 / larger(standing, 1.0);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    Vector3& force = legs_[leg].force_O_N;
    force.setZero();
    if (legs_[leg].mode != LegMode::kStance) continue;
    force = covered ? plan.solution.force_O_N[k][leg] : Vector3(0.0, 0.0, share_N);
  }
}

void Locomotion::control_body(const estimation::RobotState& state) {
  BodyTask body;
  body.p_OB_m = reference_.p_OB_m;
  body.v_OB_m_s = reference_.v_OB_m_s;
  body.R_OB =
      geometry::from_roll_pitch_yaw(reference_.roll_rad, reference_.pitch_rad, reference_.yaw_rad);
  body.angular_velocity_O_rad_s = Vector3(0.0, 0.0, reference_.yaw_rate_rad_s);
  const LegTasks tasks = leg_tasks(legs_, config_.swing);
  const WholeBodyCommand& wanted = whole_body_.update(whole_body_state(state), body, tasks);
  joints_ = joint_commands(wanted, tasks, config_);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    legs_[leg].force_O_N = wanted.force_O_N[leg];
  }
}

}  // namespace surefoot::control
