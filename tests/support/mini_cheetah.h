// A Mini-Cheetah with all masses (MIT Cheetah-Software; research/locomotion.md 1.1) and random
// attitudes, for tests of dynamics.
#pragma once

#include "core/base/random.h"
#include "core/geometry/rotations.h"
#include "core/robot/robot_model.h"

namespace surefoot::robot {

inline RobotModel full_mini_cheetah() {
  RobotModel m;
  m.trunk = {3.3, {0, 0, 0}, {0.011253, 0.036203, 0.042673, 0, 0, 0}};
  m.abad_x_m = 0.19;
  m.abad_y_m = 0.049;
  m.hip_offset_m = 0.062;
  m.thigh_length_m = 0.209;
  m.knee_offset_m = 0.004;
  m.shank_length_m = 0.195;
  m.foot_radius_m = 0.0175;
  m.abad = {0.54, {0, 0.036, 0}, {381e-6, 560e-6, 444e-6, 58e-6, 0.45e-6, 0.95e-6}};
  m.thigh = {0.634, {0, 0.016, -0.02}, {1983e-6, 2103e-6, 408e-6, 245e-6, 13e-6, 1.5e-6}};
  m.shank = {0.064, {0, 0, -0.061}, {245e-6, 248e-6, 6e-6, 0, 0, 0}};
  constexpr double kGear[3] = {6.0, 6.0, 9.33};
  constexpr double kTorque_Nm[3] = {17, 17, 26};
  constexpr double kSpeed_rad_s[3] = {40, 40, 25.7};
  constexpr double kMin_rad[3] = {-1.5, -3.5, 0.2};
  constexpr double kMax_rad[3] = {1.5, 3.5, 2.85};
  for (std::size_t i = 0; i < 3; ++i) {
    Actuator& actuator = m.actuators[i];
    actuator.gear_ratio = kGear[i];
    actuator.rotor_inertia_kg_m2 = 63e-6;
    actuator.rotor_mass_kg = 0.055;
    actuator.torque_limit_Nm = kTorque_Nm[i];
    actuator.no_load_speed_rad_s = kSpeed_rad_s[i];
    actuator.min_rad = kMin_rad[i];
    actuator.max_rad = kMax_rad[i];
  }
  return m;
}

inline Matrix3 random_attitude(Random& random) {
  geometry::Quaternion q{random.normal(), random.normal(), random.normal(), random.normal()};
  return geometry::to_matrix(geometry::normalised(q));
}

}  // namespace surefoot::robot
