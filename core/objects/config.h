// Everything that can be tuned about objects. Recommended values: README.md.
#pragma once

#include <cstdint>

#include "core/base/parameters.h"

namespace surefoot::objects {

struct ObjectsConfig {
  // The scanner
  std::uint32_t scan_stride = 0;
  double min_range_m = 0;
  double max_range_m = 0;
  double veil_gap_m = 0;
  // Ground or wall
  double max_slope = 0;
  double roughness_m = 0;
  double feet_slope_error = 0;
  double wall_spread_m = 0;
  double evidence_s = 0;
  double row_length_m = 0;
  double compact_range_m = 0;
  // Terrain
  double terrain_rise_m = 0;
  double terrain_reach_m = 0;
  // Segmentation
  double merge_m = 0;
  double piece_m = 0;
  double thin_m = 0;
  std::uint32_t min_points = 0;
  // Tracking
  double gate_m = 0;
  double position_noise_m = 0;
  double acceleration_m2_s3 = 0;
  double moving_on_m_s = 0;
  double moving_off_m_s = 0;
  // Memory
  double far_age_s = 0;
  double far_m = 0;
  double old_age_s = 0;
  double old_m = 0;
  double recent_s = 0;
  double near_m = 0;
  // Line of sight
  std::uint32_t clear_scans = 0;
  double clear_margin_m = 0;
  double no_return_clear_m = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.integer("scan_stride", self.scan_stride, {1, 100}, "every how many scans one is used");
    visit.real("min_range_m", self.min_range_m, {0.0, 5.0}, "nearer returns are the robot's own");
    visit.real("max_range_m", self.max_range_m, {1.0, 200.0}, "farther returns are not used");
    visit.real("veil_gap_m", self.veil_gap_m, {0.05, 10.0},
               "to both neighbours: a return between near and far is a mixed pixel");
    visit.real("max_slope", self.max_slope, {0.0, 1.0}, "rise over run of the steepest ground");
    visit.real("roughness_m", self.roughness_m, {0.0, 1.0}, "of the ground, above its plane");
    visit.real("feet_slope_error", self.feet_slope_error, {0.0, 1.0},
               "rise over run by which the plane under the feet may be wrong ahead");
    visit.real("wall_spread_m", self.wall_spread_m, {0.02, 2.0},
               "heights of one place's returns that ground cannot have");
    visit.real("evidence_s", self.evidence_s, {0.1, 60.0}, "half of how long heights are kept");
    visit.real("row_length_m", self.row_length_m, {0.1, 10.0}, "shorter rows are not ground");
    visit.real("compact_range_m", self.compact_range_m, {0.1, 100.0}, "if as near as that");
    visit.real("terrain_rise_m", self.terrain_rise_m, {0.02, 2.0},
               "of the height map over its surroundings");
    visit.real("terrain_reach_m", self.terrain_reach_m, {0.02, 1.0}, "how far surroundings go");
    visit.real("merge_m", self.merge_m, {0.05, 5.0}, "points closer than this are one object");
    visit.real("piece_m", self.piece_m, {0.5, 6.0}, "longer objects are cut by a grid this wide");
    visit.real("thin_m", self.thin_m, {0.01, 1.0}, "between an object's points");
    visit.integer("min_points", self.min_points, {1, 100}, "fewer are not an object");
    visit.real("gate_m", self.gate_m, {0.05, 5.0}, "to an object of the last scan");
    visit.real("position_noise_m", self.position_noise_m, {0.001, 1.0}, "of an object in a scan");
    visit.real("acceleration_m2_s3", self.acceleration_m2_s3, {1e-4, 100.0},
               "spectral density of an object's acceleration");
    visit.real("moving_on_m_s", self.moving_on_m_s, {0.01, 10.0}, "faster: moving");
    visit.real("moving_off_m_s", self.moving_off_m_s, {0.0, 10.0}, "slower for 0.5 s: standing");
    visit.real("far_age_s", self.far_age_s, {0.0, 1e5}, "unseen for this long and");
    visit.real("far_m", self.far_m, {0.0, 1e3}, "this far away: forgotten");
    visit.real("old_age_s", self.old_age_s, {0.0, 1e5}, "unseen for this long and");
    visit.real("old_m", self.old_m, {0.0, 1e3}, "this far away: forgotten");
    visit.real("recent_s", self.recent_s, {0.0, 1e3}, "seen since: kept");
    visit.real("near_m", self.near_m, {0.0, 1e3}, "kept while the memory is full");
    visit.integer("clear_scans", self.clear_scans, {1, 200}, "seen through in a row: gone");
    visit.real("clear_margin_m", self.clear_margin_m, {0.01, 5.0},
               "behind a point, where sight ends if it is gone");
    visit.real("no_return_clear_m", self.no_return_clear_m, {0.0, 100.0},
               "how far a beam without return is taken to see");
  }
};

}  // namespace surefoot::objects
