#include "core/control/leg_status.h"

namespace surefoot::control {

SwingPoint foot_target(const LegStatus& leg, const SwingConfig& config) {
  if (leg.mode == LegMode::kSwing) return evaluate(leg.path, leg.swing_progress, leg.swing_s);
  SwingPoint point;
  point.position_O_m = leg.anchor_O_m - Vector3(0.0, 0.0, leg.searched_m);
  point.velocity_O_m_s = Vector3(0.0, 0.0, -config.search_speed_m_s);
  return point;
}

LegTasks leg_tasks(const LegStatuses& legs, const SwingConfig& config) {
  LegTasks tasks;
  for (std::size_t i = 0; i < robot::kLegs; ++i) {
    LegTask& task = tasks[i];
    task.in_contact = legs[i].mode == LegMode::kStance;
    task.force_O_N = legs[i].force_O_N;
    if (task.in_contact) continue;
    const SwingPoint target = foot_target(legs[i], config);
    task.position_O_m = target.position_O_m;
    task.velocity_O_m_s = target.velocity_O_m_s;
    task.acceleration_O_m_s2 = target.acceleration_O_m_s2;
  }
  return tasks;
}

std::array<estimation::GaitPhase, robot::kLegs> gait_phases(const LegStatuses& legs) {
  std::array<estimation::GaitPhase, robot::kLegs> phases;
  for (std::size_t i = 0; i < robot::kLegs; ++i) {
    phases[i].stance_planned = legs[i].mode != LegMode::kSwing;
    phases[i].swing_progress = legs[i].swing_progress;
    phases[i].height_above_landing_m = legs[i].height_above_landing_m;
  }
  return phases;
}

}  // namespace surefoot::control
