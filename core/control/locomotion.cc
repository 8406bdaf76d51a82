#include "core/control/locomotion.h"

#include "core/math/elementary.h"
#include "core/robot/kinematics.h"

namespace surefoot::control {
namespace {

// Below this the Jacobian is not inverted: joint speeds stay zero.
constexpr double kSmallestDeterminant_m3 = 1e-4;

double ramp(double value, double target, double max_change) {
  return value + math::clamp(target - value, -max_change, max_change);
}

double larger(double a, double b) { return a > b ? a : b; }

}  // namespace

void Locomotion::reset(const ControlConfig& config, const robot::RobotModel& model) {
  *this = Locomotion{};
  config_ = config;
  model_ = model;
  gait_.reset(config.gaits.of(GaitKind::kTrot));
  footholds_.reset(config.foothold, model);
  forces_.reset(config.force);
  tracker_.reset(config.body, model);
}

void Locomotion::start(const estimation::RobotState& state) {
  gait_running_ = false;
  command_ = VelocityCommand{};
  legs_.fill(LegStatus{});
  tracker_.start(state);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    legs_[leg].anchor_O_m = state.feet[leg].p_O_m;
    legs_[leg].foothold.nominal_O_m = state.feet[leg].p_O_m;
    legs_[leg].foothold.position_O_m = state.feet[leg].p_O_m;
  }
}

std::array<estimation::GaitPhase, robot::kLegs> Locomotion::gait_phases() const {
  std::array<estimation::GaitPhase, robot::kLegs> phases;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    phases[leg].stance_planned = legs_[leg].mode != LegMode::kSwing;
    phases[leg].swing_progress = legs_[leg].swing_progress;
    phases[leg].height_above_landing_m = legs_[leg].height_above_landing_m;
  }
  return phases;
}

bool Locomotion::all_in_stance() const {
  for (const LegStatus& leg : legs_) {
    if (leg.mode != LegMode::kStance) return false;
  }
  return true;
}

const actuation::JointCommands& Locomotion::update(const estimation::RobotState& state,
                                                   const mapping::MapWindow* window,
                                                   const VelocityCommand& command, GaitKind gait,
                                                   double step_s) {
  const bool stepping = gait != GaitKind::kStand;
  // Without footholds the body must not run ahead of its feet.
  constexpr double kBlockedSlowdown_s = 0.5;
  const double share =
      stepping ? math::clamp(1.0 - blocked_s_ / kBlockedSlowdown_s, 0.0, 1.0) : 0.0;
  const double change = config_.body.max_acceleration_m_s2 * step_s;
  command_.forward_m_s = ramp(command_.forward_m_s, command.forward_m_s * share, change);
  command_.left_m_s = ramp(command_.left_m_s, command.left_m_s * share, change);
  command_.yaw_rate_rad_s =
      ramp(command_.yaw_rate_rad_s, command.yaw_rate_rad_s * share, 4.0 * change);

  advance_gait(gait, step_s);
  tracker_.update(state, command_, step_s);
  reference_ = tracker_.reference();
  bool blocked = false;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    advance_leg(leg, state, window, stepping, step_s);
    blocked = blocked || legs_[leg].skipped_swing;
  }
  if (stepping) blocked_s_ = blocked ? blocked_s_ + step_s : larger(0.0, blocked_s_ - step_s);

  distribute_forces(state);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    LegStatus& status = legs_[leg];
    if (status.mode == LegMode::kStance) {
      command_stance(leg, state);
    } else if (status.mode == LegMode::kSwing) {
      command_foot(leg, state, evaluate(status.path, status.swing_progress, status.swing_s));
    } else {
      SwingPoint point;
      point.position_O_m = status.anchor_O_m - Vector3(0.0, 0.0, status.searched_m);
      point.velocity_O_m_s = Vector3(0.0, 0.0, -config_.swing.search_speed_m_s);
      command_foot(leg, state, point);
    }
  }
  return joints_;
}

// The clock stands still while all legs stand and no step is wanted, and starts from the beginning.
void Locomotion::advance_gait(GaitKind gait, double step_s) {
  const bool stepping = gait != GaitKind::kStand;
  if (stepping && !gait_running_) {
    gait_.reset(config_.gaits.of(gait));
    gait_running_ = true;
  }
  if (stepping) gait_.change_to(config_.gaits.of(gait));
  if (!stepping && all_in_stance()) gait_running_ = false;
  if (gait_running_) gait_.advance(step_s);
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
  const Vector3 nominal =
      footholds_.nominal_O_m(leg, state, command_, gait_.legs()[leg].remaining_s,
                             gait_.config().stance_s(), reference_.ground_z_m);
  status.foothold = footholds_.choose(nominal, window);
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
  const Vector3 nominal =
      footholds_.nominal_O_m(leg, state, command_, gait_.legs()[leg].remaining_s,
                             gait_.config().stance_s(), reference_.ground_z_m);
  const Foothold next = footholds_.choose(nominal, window);
  if (next.reason == FootholdReason::kNone) return;
  status.foothold = next;
  set_path(leg, window);
}

void Locomotion::set_path(std::size_t leg, const mapping::MapWindow* window) {
  LegStatus& status = legs_[leg];
  SwingPath& path = status.path;
  path.landing_O_m = status.foothold.position_O_m;
  double highest = larger(path.lift_off_O_m[2], path.landing_O_m[2]);
  if (window != nullptr) {
    const Result<double> obstacle =
        window->max_height_along(path.lift_off_O_m[0], path.lift_off_O_m[1], path.landing_O_m[0],
                                 path.landing_O_m[1], 2.0 * model_.foot_radius_m);
    if (obstacle.ok()) highest = larger(highest, obstacle.value() + model_.foot_radius_m);
  }
  path.apex_O_m = highest + config_.swing.clearance_m;
}

void Locomotion::distribute_forces(const estimation::RobotState& state) {
  ForceProblem problem;
  problem.wrench_O = tracker_.wrench_O(state);
  const Vector3 centre_to_contact(0.0, 0.0, -model_.foot_radius_m);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    problem.lever_O_m[leg] = state.R_OB * state.feet[leg].p_B_m + centre_to_contact;
    problem.in_contact[leg] = legs_[leg].mode == LegMode::kStance;
  }
  const ForceSolution& solution = forces_.solve(problem);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    legs_[leg].force_O_N = solution.force_O_N[leg];
  }
}

void Locomotion::command_stance(std::size_t leg, const estimation::RobotState& state) {
  const estimation::FootState& foot = state.feet[leg];
  const Vector3 force_B = state.R_OB.transpose() * legs_[leg].force_O_N;
  const Vector3 torque = -(foot.jacobian_B.transpose() * force_B);
  // Damping is about the motion the body should make, not about standing still.
  const Vector3 rate_B(0.0, 0.0, reference_.yaw_rate_rad_s);
  const Vector3 foot_velocity_B =
      -(state.R_OB.transpose() * reference_.v_OB_m_s) - rate_B.cross(foot.p_B_m);
  Vector3 qd = Vector3::Zero();
  const double determinant = foot.jacobian_B.determinant();
  if (determinant > kSmallestDeterminant_m3 || determinant < -kSmallestDeterminant_m3) {
    qd = foot.jacobian_B.inverse() * foot_velocity_B;
  }
  for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
    const std::size_t joint = robot::joint_index(leg, i);
    actuation::JointCommand& command = joints_[joint];
    command = actuation::JointCommand{};
    command.position_rad = state.joints[joint].position_rad;
    command.velocity_rad_s = qd[static_cast<Eigen::Index>(i)];
    command.kd_Nm_s_rad = config_.force.stance_kd_Nm_s_rad;
    command.torque_Nm = torque[static_cast<Eigen::Index>(i)];
  }
}

// Joint stiffness towards a foot position and velocity given in O.
void Locomotion::command_foot(std::size_t leg, const estimation::RobotState& state,
                              const SwingPoint& target) {
  const Vector3 p_B = state.R_OB.transpose() * (target.position_O_m - state.p_OB_m);
  const Vector3 v_B = state.R_OB.transpose() * (target.velocity_O_m_s - state.v_OB_m_s) -
                      state.angular_velocity_B_rad_s.cross(p_B);
  const robot::LegSolution solution = robot::solve_leg(model_, leg, p_B);
  const Matrix3 jacobian = robot::foot_jacobian_B(model_, leg, solution.q_rad);
  Vector3 qd = Vector3::Zero();
  const double determinant = jacobian.determinant();
  if (determinant > kSmallestDeterminant_m3 || determinant < -kSmallestDeterminant_m3) {
    qd = jacobian.inverse() * v_B;
  }
  for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const robot::Actuator& actuator = model_.actuators[i];
    actuation::JointCommand& command = joints_[robot::joint_index(leg, i)];
    command = actuation::JointCommand{};
    command.position_rad = solution.q_rad[row];
    command.velocity_rad_s =
        math::clamp(qd[row], -actuator.no_load_speed_rad_s, actuator.no_load_speed_rad_s);
    command.kp_Nm_rad = config_.swing.kp_Nm_rad[i];
    command.kd_Nm_s_rad = config_.swing.kd_Nm_s_rad[i];
  }
}

}  // namespace surefoot::control
