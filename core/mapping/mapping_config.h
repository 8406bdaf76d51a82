// Everything that can be tuned about the map, and the noise of the sensor it is fed from.
#pragma once

#include <cstdint>

#include "core/base/parameters.h"
#include "core/base/status.h"
#include "core/robot/robot_model.h"

namespace surefoot::mapping {

// Defaults are none on purpose (core/base/parameters.h); recommended values: README.md.
struct MappingConfig {
  bool enabled = false;
  double cell_size_m = 0;
  // Input
  std::uint8_t pixel_stride = 1;
  double max_height_above_body_m = 0;
  double self_inflation_m = 0;
  double depth_noise_floor_m = 0;
  double attitude_noise_rad = 0;
  double edge_filter_sigma = 0;
  // Fusion
  double gate_sigma = 0;
  double process_noise_m2_s = 0;
  double min_sigma_m = 0;
  double max_sigma_m = 0;
  std::uint8_t confirmations_up = 1;
  std::uint8_t confirmations_down = 1;
  // Line of sight
  double clear_sigma = 0;
  double clear_margin_m = 0;
  double clear_height_margin_m = 0;
  std::uint8_t clear_frames = 1;
  std::uint8_t ceiling_pixel_stride = 1;
  double ray_step_cells = 1;
  // Footholds
  bool bridge_holes = false;
  std::uint8_t foothold_max_unknown = 0;
  double foothold_max_raise_m = 0;
  double foothold_max_drop_m = 0;
  double foothold_max_slope = 0;
  double max_jump_m = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.boolean("enabled", self.enabled, "use the map for footholds and swing heights");
    visit.real("cell_size_m", self.cell_size_m, {0.005, 0.2}, "side of a cell");
    visit.integer("pixel_stride", self.pixel_stride, {1, 8}, "use every n-th pixel and row");
    visit.real("max_height_above_body_m", self.max_height_above_body_m, {-0.5, 3.0},
               "points higher than this above the trunk's centre are not ground");
    visit.real("self_inflation_m", self.self_inflation_m, {0.0, 0.2}, "around legs and trunk");
    visit.real("depth_noise_floor_m", self.depth_noise_floor_m, {1e-4, 0.1},
               "one sigma of depth at zero range");
    visit.real("attitude_noise_rad", self.attitude_noise_rad, {0.0, 0.1}, "one sigma, roll, pitch");
    visit.real("edge_filter_sigma", self.edge_filter_sigma, {1.0, 20.0},
               "a pixel this far off all its neighbours' surfaces is a mixed pixel");
    visit.real("gate_sigma", self.gate_sigma, {1.0, 10.0}, "Mahalanobis gate of the fusion");
    visit.real("process_noise_m2_s", self.process_noise_m2_s, {0.0, 1e-2},
               "variance a cell gains per second");
    visit.real("min_sigma_m", self.min_sigma_m, {1e-4, 0.1}, "no cell is surer than this");
    visit.real("max_sigma_m", self.max_sigma_m, {1e-3, 1.0}, "no cell grows less sure than this");
    visit.integer("confirmations_up", self.confirmations_up, {1, 7},
                  "scans that must agree before a cell jumps up");
    visit.integer("confirmations_down", self.confirmations_down, {1, 7},
                  "scans that must agree before a cell jumps down");
    visit.real("clear_sigma", self.clear_sigma, {1.0, 10.0}, "margin of the line-of-sight test");
    visit.real("clear_margin_m", self.clear_margin_m, {0.0, 0.5}, "same, along the ray");
    visit.real("clear_height_margin_m", self.clear_height_margin_m, {0.0, 0.2}, "same, in height");
    visit.integer("clear_frames", self.clear_frames, {1, 7},
                  "frames that must see through a cell before it is cleared");
    visit.integer("ceiling_pixel_stride", self.ceiling_pixel_stride, {1, 16},
                  "every n-th ray of a frame bounds unseen cells; the phase turns with the frames");
    visit.real("ray_step_cells", self.ray_step_cells, {0.25, 4.0}, "step of those rays");
    visit.boolean("bridge_holes", self.bridge_holes, "fill single cells from their 8 neighbours");
    visit.integer("foothold_max_unknown", self.foothold_max_unknown, {0, 12},
                  "cells without height allowed in the patch of 17");
    visit.real("foothold_max_raise_m", self.foothold_max_raise_m, {0.001, 0.5},
               "highest cell of the patch above its centre");
    visit.real("foothold_max_drop_m", self.foothold_max_drop_m, {0.001, 0.5},
               "lowest cell of the patch below its centre");
    visit.real("foothold_max_slope", self.foothold_max_slope, {0.01, 3.0},
               "tangent of the steepest ground under a foot");
    visit.real("max_jump_m", self.max_jump_m, {0.0, 5.0},
               "highest rise or drop that a jump takes; higher is impassable");
  }
};

// Depth noise of a stereo camera: sigma_z = sqrt(floor^2 + (z^2 * inverse_depth_sigma)^2).
struct DepthSensorModel {
  double inverse_depth_sigma_per_m = 0;  // disparity noise / (focal length * baseline), [1/m]
  double min_range_m = 0;                // z in the optical frame
  double max_range_m = 0;
};

DepthSensorModel sensor_model(const robot::DepthCameraSpecification& camera);

// kInvalid: a value is not finite or outside describe()'s range.
Status validate(const MappingConfig& config);
Status validate(const DepthSensorModel& sensor);

}  // namespace surefoot::mapping
