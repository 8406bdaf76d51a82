// The recommended settings of the fusion of the legs' and the camera's odometry, as in
// core/estimation/README.md.
#pragma once

#include "core/estimation/odometry_fusion_config.h"

namespace surefoot::tests {

inline estimation::FusionConfig recommended_fusion() {
  estimation::FusionConfig config;
  config.leg_error_m_s = 0.015;
  config.leg_error_share = 0.04;
  config.leg_vertical_factor = 1.5;
  config.leg_slip_m_s = 0.4;
  config.no_leg_m_s = 1.0;
  config.leg_memory_s = 1.0;
  config.leg_noise_m_sqrt_s = 0.002;
  config.gyro_noise_rad_sqrt_s = 1e-4;
  config.gyro_drift_rad_s_sqrt_s = 2e-6;
  config.gyro_bias_rad_s = 3e-4;
  config.tilt_rad = 0.002;
  config.tilt_memory_s = 60;
  config.tilt_change_rad = 3e-4;
  config.common_share = 0.8;
  config.gate_sigma = 5;
  return config;
}

}  // namespace surefoot::tests
