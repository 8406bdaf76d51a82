// What a jump should be: the task, its schedule and the limits it keeps.
#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace surefoot::apps::jump {

struct JumpSettings {
  double rise_m = 0;  // of the landing above the start; 0: level
  double wall_m = 0;  // height of the step at edge_m that nothing may touch; rise_m in the end
  double gap_m = 0;   // level jump: width of the gap
  // Distances along the jump, from the trunk's origin at the start.
  double edge_m = 0;    // platform: its face; gap: its near side
  double travel_m = 0;  // to the trunk's origin at touchdown

  double step_s = 0.01;
  std::array<int, 3> steps{24, 12, 28};  // on four feet, on two feet, in flight
  double stretch = 1.5;  // steps of a phase may be longer or shorter by up to this factor

  double start_height_m = 0.18;   // trunk origin above the ground
  double landing_height_m = 0.2;  // above the ground landed on
  double start_foot_m = 0.0;      // feet ahead of their hips
  double landing_front_m = 0.06;
  double landing_hind_m = 0.06;

  double torque_share = 0.85;  // of the actuator's limit and of its torque-speed line
  double friction = 0.4;       // of the ground 0.6
  double min_normal_N = 30;    // of a pair of feet in contact
  double clearance_m = 0.025;  // of feet over edge and ground in flight
  double body_clearance_m = 0.02;
  double edge_margin_m = 0.04;  // the platform as seen by feet begins so much before its face
  double max_pitch_rad = 0.65;
  double max_landing_speed_m_s = 1.5;  // down
  double max_landing_forward_m_s = 1.35;
  double max_landing_pitch_rate_rad_s = 1.0;
  double joint_margin_rad = 0.08;

  double posture_weight = 1.0;        // (joint - final joint)^2, per node
  double torque_weight = 0.02;        // (pair torque / 10 N m)^2, per node
  double smooth_weight = 0.2;         // (change of pair torque / 10 N m)^2
  double acceleration_weight = 1e-2;  // (joint acceleration / 50 rad/s^2)^2
  double velocity_weight = 1e-3;      // (joint speed / 5 rad/s)^2
};

}  // namespace surefoot::apps::jump
