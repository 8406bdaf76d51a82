// What can be tuned about the fusion of the legs' and the camera's odometry. Recommended values:
// README.md.
#pragma once

#include "core/base/parameters.h"

namespace surefoot::estimation {

// Defaults are none on purpose (core/base/parameters.h).
struct FusionConfig {
  // The legs' velocity: standard deviation of the slowly changing error
  double leg_error_m_s = 0;        // even in place
  double leg_error_share = 0;      // and by this share of the speed
  double leg_vertical_factor = 0;  // of both, for the vertical axis
  double leg_slip_m_s = 0;         // if all feet slip
  double no_leg_m_s = 0;           // if none carries
  double leg_memory_s = 0;         // how long an error lasts
  double leg_noise_m_sqrt_s = 0;   // white noise besides
  // The attitude
  double gyro_noise_rad_sqrt_s = 0;    // about up
  double gyro_drift_rad_s_sqrt_s = 0;  // random walk of its bias
  double gyro_bias_rad_s = 0;          // at the start
  double tilt_rad = 0;                 // of roll and pitch
  double tilt_memory_s = 0;
  double tilt_change_rad = 0;  // between the keyframe and now
  // The camera
  double common_share = 0;  // of a motion's variance, common to a keyframe's motions
  double gate_sigma = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("leg_error_m_s", self.leg_error_m_s, {0.0001, 1.0},
               "one sigma of the legs' velocity that lasts, in place");
    visit.real("leg_error_share", self.leg_error_share, {0.0, 1.0}, "more by this share of speed");
    visit.real("leg_vertical_factor", self.leg_vertical_factor, {0.1, 10.0},
               "of the same for the vertical axis");
    visit.real("leg_slip_m_s", self.leg_slip_m_s, {0.0, 5.0}, "more if all feet slip");
    visit.real("no_leg_m_s", self.no_leg_m_s, {0.01, 10.0},
               "one sigma of the velocity if no foot carries");
    visit.real("leg_memory_s", self.leg_memory_s, {0.01, 100.0}, "how long such an error lasts");
    visit.real("leg_noise_m_sqrt_s", self.leg_noise_m_sqrt_s, {0.0, 1.0},
               "random walk of the legs' place besides");
    visit.real("gyro_noise_rad_sqrt_s", self.gyro_noise_rad_sqrt_s, {0.0, 0.1},
               "random walk of yaw");
    visit.real("gyro_drift_rad_s_sqrt_s", self.gyro_drift_rad_s_sqrt_s, {0.0, 0.1},
               "random walk of the gyro's bias about up");
    visit.real("gyro_bias_rad_s", self.gyro_bias_rad_s, {0.0, 0.1},
               "one sigma of that bias at the start");
    visit.real("tilt_rad", self.tilt_rad, {0.0, 0.2}, "one sigma of roll and of pitch");
    visit.real("tilt_memory_s", self.tilt_memory_s, {0.1, 10000.0}, "how long such an error lasts");
    visit.real("tilt_change_rad", self.tilt_change_rad, {0.0, 0.1},
               "one sigma of their quick changes, at either picture of a motion");
    visit.real("common_share", self.common_share, {0.0, 0.99},
               "of a motion's variance that all motions from its keyframe share");
    visit.real("gate_sigma", self.gate_sigma, {1.0, 100.0},
               "a motion farther off, root of its chi square over six, is not used");
  }
};

}  // namespace surefoot::estimation
