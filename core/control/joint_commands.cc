#include "core/control/joint_commands.h"

namespace surefoot::control {

actuation::JointCommands joint_commands(const WholeBodyCommand& wanted, const LegTasks& tasks,
                                        const ControlConfig& config) {
  actuation::JointCommands commands;
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    const auto row = static_cast<Eigen::Index>(joint);
    const std::size_t i = joint % robot::kJointsPerLeg;
    const bool stands = tasks[joint / robot::kJointsPerLeg].in_contact;
    const WholeBodyConfig& stance = config.whole_body;
    commands[joint] = {
        .position_rad = wanted.q_rad[row],
        .velocity_rad_s = wanted.qd_rad_s[row],
        .kp_Nm_rad = stands ? stance.joint_kp_Nm_rad[i] : config.swing.kp_Nm_rad[i],
        .kd_Nm_s_rad = stands ? stance.joint_kd_Nm_s_rad[i] : config.swing.kd_Nm_s_rad[i],
        .torque_Nm = wanted.torque_Nm[row]};
  }
  return commands;
}

}  // namespace surefoot::control
