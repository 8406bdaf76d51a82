// The ground of a run: the level plane z = 0, upright boxes standing on it, and at most one grid of
// heights that replaces the plane inside its rectangle. World frame W (world_spec.h), metres.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/random.h"
#include "core/math/linear.h"
#include "sim_hal/world/solid.h"
#include "sim_hal/world/terrain_box.h"
#include "sim_hal/world/walkers.h"
#include "sim_hal/world/world_spec.h"

namespace surefoot::sim {

// Heights at nodes (x0 + i cell, y0 + j cell), z[j * nx + i]. Between nodes two triangles per cell
// split along the diagonal from (i, j) to (i + 1, j + 1).
struct HeightGrid {
  std::size_t nx = 0;
  std::size_t ny = 0;
  double x0_m = 0;
  double y0_m = 0;
  double cell_m = 0;
  std::vector<double> z_m;

  bool empty() const { return z_m.empty(); }
  double end_x_m() const { return x0_m + cell_m * static_cast<double>(nx - 1); }
  double end_y_m() const { return y0_m + cell_m * static_cast<double>(ny - 1); }
  bool overlaps(double x0, double y0, double x1, double y1) const {
    return !empty() && x1 >= x0_m && x0 <= end_x_m() && y1 >= y0_m && y0 <= end_y_m();
  }
  bool contains(double x, double y) const {
    return !empty() && x >= x0_m && x <= end_x_m() && y >= y0_m && y <= end_y_m();
  }
  double at(std::size_t i, std::size_t j) const { return z_m[j * nx + i]; }
  // (x, y) inside the rectangle.
  double height_m(double x, double y) const;
};

// Of a world with solids, as made.
struct SpreadFigures {
  double area_m2 = 0;  // on which they are spread
  double steepest_rad = 0;
  double roughness_rms_m = 0;
  double passage_width_m = 0;
  std::uint32_t layouts = 0;
};

struct Terrain {
  std::vector<TerrainBox> boxes;
  std::optional<TerrainBox> obstacle;  // not to be touched (world/obstacle.h)
  HeightGrid grid;
  std::vector<Solid> solids;  // stand on the ground, are no part of it
  std::vector<Sapling> saplings;
  std::vector<Walker> walkers;
  SpreadFigures spread;
  double friction = 0.6;
  std::uint32_t bridged_cells = 0;
  std::uint32_t tiles = 1;

  // Of the ground: without solids.
  double height_m(double x, double y) const;
};

inline constexpr double kUsualWidth_m = 0.3;

// Throws SimulatorError for an unreadable file or a clutter field that cannot be filled.
// robot_width_m: forests leave room for it.
Terrain make_terrain(const WorldSpec& spec, std::uint64_t seed,
                     double robot_width_m = kUsualWidth_m);

// The generators, one file each.
void make_clutter(double height_m, double cover, Random& random, Terrain& terrain);
void make_steps(double height_m, Random& random, Terrain& terrain);
void make_ramps(double slope_rad, Random& random, Terrain& terrain);
// The middle of the near edge lies at (edge_x_m, 0).
void make_platform(double height_m, double edge_x_m, Random& random, Terrain& terrain);
void make_gauntlet(double height_m, double cover, Random& random, Terrain& terrain);
void make_gap(double length_m, Random& random, Terrain& terrain);
void make_rocks(const WorldSpec& spec, std::uint64_t seed, Random& random, Terrain& terrain);
void make_forest(double goal_x_m, double robot_width_m, Random& random, Terrain& terrain);
void make_walkers(double goal_x_m, double robot_width_m, Random& random, Terrain& terrain);
void make_wall(bool enclosed, Random& random, Terrain& terrain);
void make_culdesac(Random& random, Terrain& terrain);
void make_height_map(const WorldSpec& spec, Terrain& terrain);

// Part of the clutter field under boxes, on a 1 cm raster.
double clutter_cover(const Terrain& terrain);

}  // namespace surefoot::sim
