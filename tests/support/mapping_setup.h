// Mini-Cheetah's mapping without reading configuration files.
#pragma once

#include "core/mapping/traversability.h"

namespace surefoot::mapping::test {

inline MappingConfig recommended_config() {
  MappingConfig config;
  config.enabled = true;
  config.cell_size_m = 0.015;
  config.pixel_stride = 1;
  config.max_height_above_body_m = 0.30;
  config.self_inflation_m = 0.025;
  config.depth_noise_floor_m = 0.002;
  config.attitude_noise_rad = 0.003;
  config.edge_filter_sigma = 3;
  config.gate_sigma = 3;
  config.process_noise_m2_s = 1e-6;
  config.min_sigma_m = 0.002;
  config.max_sigma_m = 0.1;
  config.confirmations_up = 2;
  config.confirmations_down = 3;
  config.clear_sigma = 3;
  config.clear_margin_m = 0.015;
  config.clear_height_margin_m = 0.006;
  config.clear_frames = 3;
  config.ceiling_pixel_stride = 3;
  config.ray_step_cells = 1;
  config.bridge_holes = true;
  config.foothold_max_unknown = 3;
  config.foothold_max_raise_m = 0.02;
  config.foothold_max_drop_m = 0.02;
  config.foothold_max_slope = 0.5;
  config.max_jump_m = 0.27;
  return config;
}

inline TraversabilityLimits limits_of(const MappingConfig& config, double max_step_m = 0.12) {
  return {.max_slope = config.foothold_max_slope,
          .max_raise_m = config.foothold_max_raise_m,
          .max_drop_m = config.foothold_max_drop_m,
          .max_unknown = config.foothold_max_unknown,
          .max_step_m = max_step_m,
          .max_jump_m = config.max_jump_m};
}

}  // namespace surefoot::mapping::test
