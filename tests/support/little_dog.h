// A LittleDog with all masses (config/robots/littledog.yaml), for tests of dynamics and control.
#pragma once

#include "core/robot/robot_model.h"

namespace surefoot::robot {

inline RobotModel little_dog() {
  RobotModel m;
  m.trunk = {1.8, {0, 0, 0}, {0.001625, 0.009178, 0.008794, 0, 0, 0}};
  m.trunk_size_m = {0.202, 0.0725, 0.06};
  m.abad_x_m = 0.101;
  m.abad_y_m = 0.03625;
  m.hip_offset_m = 0.0236;
  m.thigh_length_m = 0.0751;
  m.shank_length_m = 0.1020;
  m.foot_radius_m = 0.0103;
  m.hind_knees_forward = true;
  m.thigh_radius_m = 0.012;
  m.shank_radius_m = 0.006;
  m.abad = {0.0623, {0, 0.0029, 0}, {4e-6, 15e-6, 15e-6, 0, 0, 0}};
  m.thigh = {0.1279, {0, 0, -0.0166}, {82e-6, 89e-6, 15e-6, 0, 0, 0}};
  m.shank = {0.0464, {0.0053, 0, -0.0195}, {38e-6, 35e-6, 6e-6, 0, 0, 0}};
  constexpr double kMin_rad[3] = {-0.6, -2.4, 0.15};
  constexpr double kMax_rad[3] = {0.6, 3.5, 2.83};
  for (std::size_t i = 0; i < 3; ++i) {
    Actuator& actuator = m.actuators[i];
    actuator.gear_ratio = 70;
    actuator.rotor_inertia_kg_m2 = 9e-8;
    actuator.torque_limit_Nm = 3;
    actuator.no_load_speed_rad_s = 15;
    actuator.stall_torque_Nm = 9;
    actuator.min_rad = kMin_rad[i];
    actuator.max_rad = kMax_rad[i];
  }
  return m;
}

}  // namespace surefoot::robot
