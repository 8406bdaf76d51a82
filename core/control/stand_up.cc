#include "core/control/stand_up.h"

#include "core/math/elementary.h"
#include "core/robot/kinematics.h"

namespace surefoot::control {
namespace {

double smooth(double s) { return s * s * (3.0 - 2.0 * s); }

}  // namespace

void StandUp::reset(const StandUpConfig& config, const robot::RobotModel& model, double height_m) {
  config_ = config;
  model_ = model;
  height_m_ = height_m;
  elapsed_s_ = 0;
  start_rad_.fill(Vector3::Zero());
}

void StandUp::start(const actuation::JointStates& joints) {
  elapsed_s_ = 0;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
      start_rad_[leg][static_cast<Eigen::Index>(i)] =
          joints[robot::joint_index(leg, i)].position_rad;
    }
  }
}

void StandUp::start_folded() {
  elapsed_s_ = config_.fold_s;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) start_rad_[leg] = folded_rad(leg);
}

Vector3 StandUp::folded_rad(std::size_t leg) const {
  const std::array<double, 3> pose = model_.pose_of(leg, config_.folded_rad);
  return {pose[0], pose[1], pose[2]};
}

Vector3 StandUp::standing_foot_B_m(std::size_t leg, double height_m) const {
  return robot::hip_joint_B_m(model_, leg) + Vector3(0.0, 0.0, model_.foot_radius_m - height_m);
}

actuation::JointCommands StandUp::update(double step_s) {
  elapsed_s_ += step_s;
  const double fold = smooth(math::clamp(elapsed_s_ / config_.fold_s, 0.0, 1.0));
  const double rise = smooth(math::clamp((elapsed_s_ - config_.fold_s) / config_.rise_s, 0.0, 1.0));
  actuation::JointCommands commands;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const Vector3 folded = folded_rad(leg);
    Vector3 q = start_rad_[leg] + (folded - start_rad_[leg]) * fold;
    if (rise > 0.0) {
      const Vector3 low = robot::foot_position_B_m(model_, leg, folded);
      const Vector3 target = low + (standing_foot_B_m(leg, height_m_) - low) * rise;
      q = robot::solve_leg(model_, leg, target).q_rad;
    }
    for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
      actuation::JointCommand& command = commands[robot::joint_index(leg, i)];
      command.position_rad = q[static_cast<Eigen::Index>(i)];
      command.kp_Nm_rad = config_.kp_Nm_rad;
      command.kd_Nm_s_rad = config_.kd_Nm_s_rad;
    }
  }
  return commands;
}

}  // namespace surefoot::control
