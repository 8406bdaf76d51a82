// The recommended values, core/objects/README.md.
#pragma once

#include "core/objects/config.h"

namespace surefoot::objects::test {

inline ObjectsConfig config() {
  ObjectsConfig config;
  config.scan_stride = 1;
  config.min_range_m = 0.3;
  config.max_range_m = 30.0;
  config.veil_gap_m = 0.3;
  config.max_slope = 0.2;
  config.roughness_m = 0.15;
  config.feet_slope_error = 0.05;
  config.wall_spread_m = 0.2;
  config.evidence_s = 1.0;
  config.row_length_m = 1.5;
  config.compact_range_m = 30.0;
  config.terrain_rise_m = 0.25;
  config.terrain_reach_m = 0.2;
  config.merge_m = 0.5;
  config.piece_m = 3.0;
  config.thin_m = 0.1;
  config.min_points = 2;
  config.gate_m = 0.7;
  config.position_noise_m = 0.08;
  config.acceleration_m2_s3 = 0.03;
  config.moving_on_m_s = 0.3;
  config.moving_off_m_s = 0.2;
  config.far_age_s = 30.0;
  config.far_m = 15.0;
  config.old_age_s = 1800.0;
  config.old_m = 10.0;
  config.recent_s = 10.0;
  config.near_m = 2.0;
  config.clear_scans = 8;
  config.clear_margin_m = 0.3;
  config.no_return_clear_m = 8.0;
  return config;
}

}  // namespace surefoot::objects::test
