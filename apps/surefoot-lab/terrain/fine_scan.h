// The experiment's own range sensor: a perfect camera carried over terrain that is known to the
// millimetre. Frame: the terrain's corner at the origin, z up, the camera looks along x.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/terrain/terrain_grid.h"

namespace surefoot::apps {

// Height samples every millimetre, (i + 0.5, j + 0.5) mm from the corner; between them the nearest
// holds, so that the surface is made of columns 1 mm wide.
struct FineTerrain {
  static constexpr double kStep_m = 0.001;

  std::int32_t columns = 0;  // along x
  std::int32_t rows = 0;     // along y
  std::vector<float> z_m;
  std::vector<std::uint8_t> recorded;  // 0: an invention that bridges a gap. Empty: all are true

  bool is_true(std::size_t i) const { return recorded.empty() || recorded[i] != 0; }
  std::size_t index(std::int32_t i, std::int32_t j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(i);
  }
  bool contains(std::int32_t i, std::int32_t j) const {
    return i >= 0 && i < columns && j >= 0 && j < rows;
  }
};

struct ScanOptions {
  double view_x_rad = 1.0471975511965976;   // 60 degrees
  double view_y_rad = 0.78539816339744828;  // 45 degrees
  int columns = 320;
  int rows = 240;
  double tilt_rad = 0.69813170079773179;  // 40 degrees below the horizon
  double height_m = 0.28;                 // above the ground under and behind the camera
  double first_x_m = -0.40;               // pictures are taken from here
  double last_x_m = 0.90;
  double step_m = 0.05;
  double range_m = 1.2;
};

struct FineScan {
  std::vector<float> ceiling_m;    // lowest line of sight over a sample; kNoSight_m: none
  std::vector<std::uint8_t> seen;  // a ray ended on the sample or on one of the eight around it
};
inline constexpr float kNoSight_m = 1e9f;

// One pass along the middle of the terrain. 2 to 4 s for a square metre.
FineScan scan_terrain(const FineTerrain& terrain, const ScanOptions& options);

// Cells of cell_mm: the sample in the middle of a cell is the cell. noise_m: standard deviation
// added to heights and ceilings, drawn from seed. The terrain must fit core's TerrainGrid.
void to_grid(const FineTerrain& terrain, const FineScan& scan, int cell_mm, double noise_m,
             std::uint64_t seed, terrain::TerrainGrid& out);

// True heights of all cells; inventions as ceilings (prior_training.h).
void true_grid(const FineTerrain& terrain, int cell_mm, terrain::TerrainGrid& out);

}  // namespace surefoot::apps
