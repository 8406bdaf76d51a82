// Parameters of whole-body control.
#pragma once

#include <array>

#include "core/base/parameters.h"

namespace surefoot::control {

struct WholeBodyConfig {
  double friction = 0;                         // the pyramid that forces stay inside
  double max_normal_N = 0;                     // of a foot in contact
  std::array<double, 3> position_gain_1_s2{};  // trunk, O axes
  std::array<double, 3> velocity_gain_1_s{};
  std::array<double, 3> attitude_gain_1_s2{};  // trunk, about x, y, z of B
  std::array<double, 3> rate_gain_1_s{};
  std::array<double, 3> foot_position_gain_1_s2{};  // swing feet, O axes
  std::array<double, 3> foot_velocity_gain_1_s{};
  double force_weight = 0;                  // of a change of the reference forces [1/N^2]
  double linear_relaxation_weight = 0;      // of the trunk's acceleration [s^4/m^2]
  double angular_relaxation_weight = 0;     // [s^4/rad^2]
  double max_residual_N = 0;                // of the QP, beyond it the reference forces hold
  double max_joint_step_rad = 0;            // commanded angle from the present one, at most
  std::array<double, 3> joint_kp_Nm_rad{};  // abad, hip, knee
  std::array<double, 3> joint_kd_Nm_s_rad{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("friction", self.friction, {0.05, 2.0}, "pyramid half-width over normal force");
    visit.real("max_normal_N", self.max_normal_N, {1.0, 5000.0}, "of a foot in contact");
    visit.reals("position_gain_1_s2", self.position_gain_1_s2, {0.0, 2000.0}, "x, y, z of O");
    visit.reals("velocity_gain_1_s", self.velocity_gain_1_s, {0.0, 200.0}, "x, y, z of O");
    visit.reals("attitude_gain_1_s2", self.attitude_gain_1_s2, {0.0, 2000.0}, "x, y, z of B");
    visit.reals("rate_gain_1_s", self.rate_gain_1_s, {0.0, 200.0}, "x, y, z of B");
    visit.reals("foot_position_gain_1_s2", self.foot_position_gain_1_s2, {0.0, 5000.0}, "of O");
    visit.reals("foot_velocity_gain_1_s", self.foot_velocity_gain_1_s, {0.0, 500.0}, "of O");
    visit.real("force_weight", self.force_weight, {1e-4, 1e4}, "change of reference forces");
    visit.real("linear_relaxation_weight", self.linear_relaxation_weight, {0.0, 1e4},
               "of the trunk's acceleration");
    visit.real("angular_relaxation_weight", self.angular_relaxation_weight, {0.0, 1e4},
               "of the trunk's angular acceleration");
    visit.real("max_residual_N", self.max_residual_N, {1e-6, 100.0}, "else reference forces");
    visit.real("max_joint_step_rad", self.max_joint_step_rad, {0.01, 3.0},
               "from the present angle");
    visit.reals("joint_kp_Nm_rad", self.joint_kp_Nm_rad, {0.0, 5000.0}, "abad, hip, knee");
    visit.reals("joint_kd_Nm_s_rad", self.joint_kd_Nm_s_rad, {0.0, 500.0}, "abad, hip, knee");
  }
};

}  // namespace surefoot::control
