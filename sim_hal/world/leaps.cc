// Worlds that ask for a jump: a platform, a gap. contract.md "The worlds".
#include <cmath>

#include "sim_hal/simulator_error.h"
#include "sim_hal/world/terrain.h"

namespace surefoot::sim {

// The middle of the near edge stays in place, whichever way the platform is turned.
void make_platform(double height_m, double edge_x_m, Random& random, Terrain& terrain) {
  constexpr double kMinLength_m = 1.6;  // landing, and a few steps
  constexpr double kMaxLength_m = 2.2;
  constexpr double kMinWidth_m = 1.2;
  constexpr double kMaxWidth_m = 2.0;
  constexpr double kMaxYaw_rad = 0.052;
  if (!(height_m > 0)) throw SimulatorError("world: platform needs height_m above 0");
  TerrainBox box;
  box.half_length_m = 0.5 * random.uniform(kMinLength_m, kMaxLength_m);
  box.half_width_m = 0.5 * random.uniform(kMinWidth_m, kMaxWidth_m);
  const double yaw = random.uniform(-kMaxYaw_rad, kMaxYaw_rad);
  box.cos_yaw = std::cos(yaw);
  box.sin_yaw = std::sin(yaw);
  box.x_m = edge_x_m + box.cos_yaw * box.half_length_m;
  box.y_m = box.sin_yaw * box.half_length_m;
  box.top_m = height_m;
  terrain.boxes.push_back(box);
}

// The grid's outermost lines stay level, so that the walls are one cell thick.
void make_gap(double length_m, Random& random, Terrain& terrain) {
  constexpr double kCell_m = 0.01;
  constexpr double kMinDepth_m = 0.3;
  constexpr double kMaxDepth_m = 0.5;
  constexpr double kHalfWidth_m = 1.5;  // wider than the map that the robot sees
  if (!(length_m > 0)) throw SimulatorError("world: gap needs length_m above 0");
  const double depth = random.uniform(kMinDepth_m, kMaxDepth_m);
  const auto steps = static_cast<std::size_t>(std::lround(length_m / kCell_m));
  HeightGrid& grid = terrain.grid;
  grid.cell_m = kCell_m;
  grid.x0_m = kEdgeX_m - kCell_m;
  grid.y0_m = -kHalfWidth_m;
  grid.nx = steps + 3;
  grid.ny = static_cast<std::size_t>(std::lround(2 * kHalfWidth_m / kCell_m)) + 1;
  grid.z_m.assign(grid.nx * grid.ny, 0.0);
  for (std::size_t j = 1; j + 1 < grid.ny; ++j) {
    for (std::size_t i = 2; i + 2 < grid.nx; ++i) grid.z_m[j * grid.nx + i] = -depth;
  }
}

}  // namespace surefoot::sim
