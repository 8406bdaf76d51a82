// The perceived map beside the ground truth.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "apps/common/height_grid.h"
#include "apps/common/run_log.h"
#include "core/mapping/mapper.h"

namespace surefoot::apps {

// Classes on the raster of a HeightGrid; all unknown at first.
struct ClassGrid {
  int columns = 0;
  int rows = 0;
  std::vector<mapping::Traversability> classes;

  ClassGrid() = default;
  explicit ClassGrid(const HeightGrid& raster)
      : columns(raster.columns),
        rows(raster.rows),
        classes(raster.height_m.size(), mapping::Traversability::kUnknown) {}

  mapping::Traversability at(int column, int row) const {
    return classes[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                   static_cast<std::size_t>(column)];
  }
};

// How far the middle of a measured cell, at its height, is from the true surface. At a wall the
// difference in height says little: a cell's breadth beside it the ground is as far off as the wall
// is high. So the nearest point of the surface counts; the difference in height is given as well.
struct MapError {
  double rmse_m = 0;           // distances to the surface; 0 where there is no measured cell
  double median_m = 0;         // likewise
  double vertical_rmse_m = 0;  // differences in height
  double known_fraction = 0;   // measured cells of all cells in the corridor
  std::size_t measured = 0;
  std::size_t cells = 0;
};

// True height of the ground at (x, y) in W.
using TrueGround = std::function<double(double x_m, double y_m)>;

HeightGrid true_grid(const TrueGround& ground, const HeightGrid& raster);
// The map's heights on the raster of `raster` (nearest cell). In O when there is no truth to align
// with.
HeightGrid perceived_grid(const mapping::Mapper& mapper, const Alignment& O_in_W,
                          const HeightGrid& raster);

// What a robot that stands anywhere on the map would be told of its ground, nearest cell: the
// classifier of the published window, run window beside window over the whole raster.
ClassGrid classify_map(const mapping::ControlMap& map, const mapping::MappingConfig& config,
                       const mapping::TraversabilityLimits& limits, const Alignment& O_in_W,
                       const HeightGrid& raster);

// From a place to the surface over the plane, walls between samples 1 mm apart included: at most
// the difference in height. Cost: three samples a square millimetre of a square that reaches as far
// as the answer.
double distance_to_surface_m(const TrueGround& ground, double x_m, double y_m, double z_m);

// The map's own cells whose centres lie within `half_width` of the body's trace: error of the
// measured ones, and their share.
MapError map_error(const mapping::Mapper& mapper, const Alignment& O_in_W, const RunLog& log,
                   const TrueGround& ground, double half_width_m);

}  // namespace surefoot::apps
