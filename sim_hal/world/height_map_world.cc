// Lays a height map from a file under the mission's lane. README.md "Height maps" states the rules.
#include <algorithm>
#include <cmath>

#include "sim_hal/simulator.h"
#include "sim_hal/world/height_map_file.h"
#include "sim_hal/world/terrain.h"

namespace surefoot::sim {

namespace {

// Finer cells than this are averaged: the foot sphere cannot feel them and ODE pays for each.
constexpr double kMinCell_m = 0.01;
constexpr double kBegin_m = -0.8;  // ground of the map reaches from here ...
constexpr double kEnd_m = 3.8;     // ... to here, goal plus a body length
constexpr double kHalfWidth_m = 1.2;
// Level start: a disc of this radius at z = 0, blended into the map over the next stretch.
constexpr double kPadRadius_m = 0.35;
constexpr double kPadBlend_m = 0.25;

// Index into [0, size) after reflection at both ends: 0 1 2 | 2 1 0 | 0 1 2 ...
std::size_t reflected(std::int64_t index, std::size_t size) {
  const auto period = static_cast<std::int64_t>(2 * size);
  const auto in_period = static_cast<std::size_t>(((index % period) + period) % period);
  return in_period < size ? in_period : 2 * size - 1 - in_period;
}

// Mean over blocks of `block` x `block` file cells, indexed with y growing north.
RawHeightMap reduced(const RawHeightMap& map, std::size_t block) {
  RawHeightMap result;
  result.columns = std::max<std::size_t>(2, map.columns / block);
  result.rows = std::max<std::size_t>(2, map.rows / block);
  result.cell_m = map.cell_m * static_cast<double>(block);
  for (std::size_t row = 0; row < result.rows; ++row) {
    for (std::size_t column = 0; column < result.columns; ++column) {
      double sum = 0;
      for (std::size_t k = 0; k < block * block; ++k) {
        const std::size_t r = std::min(map.rows - 1, row * block + k / block);
        const std::size_t c = std::min(map.columns - 1, column * block + k % block);
        sum += map.z_m[map.index(map.rows - 1 - r, c)];
      }
      result.z_m.push_back(sum / static_cast<double>(block * block));
    }
  }
  return result;
}

std::uint32_t copies(double needed_m, double have_m) {
  return static_cast<std::uint32_t>(std::max(1.0, std::ceil(needed_m / have_m - 1e-9)));
}

// Mean height of the ground around the start.
double pad_height(const HeightGrid& grid) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t j = 0; j < grid.ny; ++j) {
    for (std::size_t i = 0; i < grid.nx; ++i) {
      const double x = grid.x0_m + grid.cell_m * static_cast<double>(i);
      const double y = grid.y0_m + grid.cell_m * static_cast<double>(j);
      if (std::hypot(x, y) > kPadRadius_m) continue;
      sum += grid.at(i, j);
      ++count;
    }
  }
  return count == 0 ? 0.0 : sum / static_cast<double>(count);
}

void blend_pad(HeightGrid& grid) {
  const double level = pad_height(grid);
  for (std::size_t j = 0; j < grid.ny; ++j) {
    for (std::size_t i = 0; i < grid.nx; ++i) {
      const double x = grid.x0_m + grid.cell_m * static_cast<double>(i);
      const double y = grid.y0_m + grid.cell_m * static_cast<double>(j);
      const double part = std::clamp((std::hypot(x, y) - kPadRadius_m) / kPadBlend_m, 0.0, 1.0);
      double& z = grid.z_m[j * grid.nx + i];
      z = (z - level) * part * part * (3.0 - 2.0 * part);
    }
  }
}

}  // namespace

void make_height_map(const WorldSpec& spec, Terrain& terrain) {
  if (spec.file.empty()) throw SimulatorError("world: heightmap needs a file");
  if (!(spec.scale > 0)) throw SimulatorError("world: heightmap needs scale above 0");
  RawHeightMap raw = read_height_map(spec.file);
  crop_to_known(raw);
  terrain.bridged_cells = bridge_unknown(raw);
  raw.cell_m *= spec.scale;
  for (double& z : raw.z_m) z *= spec.scale;
  const auto block =
      static_cast<std::size_t>(std::max(1.0, std::ceil(kMinCell_m / raw.cell_m - 1e-9)));
  const RawHeightMap map = reduced(raw, block);

  HeightGrid& grid = terrain.grid;
  grid.cell_m = map.cell_m;
  const double size_x_m = map.cell_m * static_cast<double>(map.columns);
  const double size_y_m = map.cell_m * static_cast<double>(map.rows);
  terrain.tiles = copies(kEnd_m - kBegin_m, size_x_m) * copies(2 * kHalfWidth_m, size_y_m);
  grid.x0_m = kBegin_m;
  grid.nx = static_cast<std::size_t>(std::ceil((kEnd_m - kBegin_m) / grid.cell_m)) + 1;
  grid.ny = 2 * static_cast<std::size_t>(std::ceil(kHalfWidth_m / grid.cell_m)) + 1;
  grid.y0_m = -grid.cell_m * static_cast<double>(grid.ny / 2);
  // The map's western edge lies at x = kBegin_m, its middle row at y = 0.
  const auto middle = static_cast<std::int64_t>(map.rows / 2);
  for (std::size_t j = 0; j < grid.ny; ++j) {
    const std::int64_t row = static_cast<std::int64_t>(j) - static_cast<std::int64_t>(grid.ny / 2);
    for (std::size_t i = 0; i < grid.nx; ++i) {
      const std::size_t column = reflected(static_cast<std::int64_t>(i), map.columns);
      grid.z_m.push_back(map.z_m[map.index(reflected(middle + row, map.rows), column)]);
    }
  }
  blend_pad(grid);
}

}  // namespace surefoot::sim
