#include "sim_hal/world/terrain.h"

#include <algorithm>
#include <cmath>

namespace surefoot::sim {

namespace {

constexpr std::uint64_t kWorldStream = 1;

// Index of the cell that holds x, and the fraction inside it.
std::size_t cell_of(double offset_m, double cell_m, std::size_t nodes, double& fraction) {
  const double scaled = offset_m / cell_m;
  const double limit = static_cast<double>(nodes - 2);
  const double index = std::clamp(std::floor(scaled), 0.0, limit);
  fraction = scaled - index;
  return static_cast<std::size_t>(index);
}

}  // namespace

double HeightGrid::height_m(double x, double y) const {
  double u = 0;
  double v = 0;
  const std::size_t i = cell_of(x - x0_m, cell_m, nx, u);
  const std::size_t j = cell_of(y - y0_m, cell_m, ny, v);
  const double z00 = at(i, j);
  const double z11 = at(i + 1, j + 1);
  if (u >= v) {
    const double z10 = at(i + 1, j);
    return z00 + (z10 - z00) * u + (z11 - z10) * v;
  }
  const double z01 = at(i, j + 1);
  return z00 + (z11 - z01) * u + (z01 - z00) * v;
}

double Terrain::height_m(double x, double y) const {
  double height = grid.contains(x, y) ? grid.height_m(x, y) : 0.0;
  for (const TerrainBox& box : boxes) {
    if (box.top_m > height && box.covers(x, y)) height = box.top_m;
  }
  return height;
}

Terrain make_terrain(const WorldSpec& spec, std::uint64_t seed, double robot_width_m) {
  const double goal_x_m = goal_of(spec, seed);
  Terrain terrain;
  terrain.friction = spec.friction;
  Random random(seed, kWorldStream);
  switch (spec.generator) {
    case Generator::kFlat: break;
    case Generator::kSteps: make_steps(spec.height_m, random, terrain); break;
    case Generator::kRamps: make_ramps(spec.slope_rad, random, terrain); break;
    case Generator::kClutter: make_clutter(spec.height_m, spec.cover, random, terrain); break;
    case Generator::kPlatform: make_platform(spec.height_m, kEdgeX_m, random, terrain); break;
    case Generator::kGap: make_gap(spec.length_m, random, terrain); break;
    case Generator::kGauntlet: make_gauntlet(spec.height_m, spec.cover, random, terrain); break;
    case Generator::kRocks: make_rocks(spec, seed, random, terrain); break;
    case Generator::kForest: make_forest(goal_x_m, robot_width_m, random, terrain); break;
    case Generator::kWalkers: make_walkers(goal_x_m, robot_width_m, random, terrain); break;
    case Generator::kWall: make_wall(spec.enclosed, random, terrain); break;
    case Generator::kCuldesac: make_culdesac(random, terrain); break;
    case Generator::kHeightMap: make_height_map(spec, terrain); break;
  }
  return terrain;
}

}  // namespace surefoot::sim
