#include "apps/common/perceived_map.h"

#include <cmath>
#include <set>
#include <utility>

namespace surefoot::apps {
namespace {

// The cells of O within `radius_m` of the walked trace.
std::set<std::pair<int, int>> corridor(const RunLog& log, const Alignment& O_in_W, double cell_m,
                                       double radius_m) {
  constexpr double kTraceStep_m = 0.02;
  std::set<std::pair<int, int>> cells;
  const auto reach = static_cast<int>(std::ceil(radius_m / cell_m));
  std::array<double, 3> last{1e9, 1e9, 0};
  for (std::size_t i = log.walk_begin(); i < log.walk_end(); ++i) {
    const auto p = O_in_W.to_odometry(log.samples()[i].truth.p_WB_m);
    if (std::hypot(p[0] - last[0], p[1] - last[1]) < kTraceStep_m) continue;
    last = p;
    const mapping::CellIndex centre = mapping::cell_index(p[0], p[1], cell_m);
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        if (std::hypot(dx, dy) * cell_m <= radius_m) {
          cells.emplace(centre.ix + dx, centre.iy + dy);
        }
      }
    }
  }
  return cells;
}

}  // namespace

HeightGrid true_grid(const TrueGround& ground, const HeightGrid& raster) {
  HeightGrid grid = raster;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      grid.set(column, row, ground(grid.x_of(column), grid.y_of(row)));
    }
  }
  return grid;
}

HeightGrid perceived_grid(const mapping::Mapper& mapper, const Alignment& O_in_W,
                          const HeightGrid& raster) {
  HeightGrid grid(raster.x_m, raster.y_m, raster.columns * raster.cell_m,
                  raster.rows * raster.cell_m, raster.cell_m);
  if (!mapper.configured()) return grid;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const auto p = O_in_W.to_odometry({grid.x_of(column), grid.y_of(row), 0});
      const mapping::MapCell* cell =
          mapper.map().find(mapping::cell_index(p[0], p[1], mapper.cell_size_m()));
      if (cell == nullptr || !cell->has_height()) continue;
      grid.set(column, row, static_cast<double>(cell->height_m) + O_in_W.p_WO_m[2]);
    }
  }
  return grid;
}

MapError map_error(const mapping::Mapper& mapper, const Alignment& O_in_W, const RunLog& log,
                   const TrueGround& ground, double half_width_m) {
  MapError error;
  if (!mapper.configured()) return error;
  const double size = mapper.cell_size_m();
  double sum = 0;
  for (const auto& [ix, iy] : corridor(log, O_in_W, size, half_width_m)) {
    ++error.cells;
    const mapping::MapCell* cell = mapper.map().find({ix, iy});
    if (cell == nullptr || cell->state != mapping::CellState::kMeasured) continue;
    const auto p = O_in_W.to_world({mapping::cell_centre(ix, size), mapping::cell_centre(iy, size),
                                    static_cast<double>(cell->height_m)});
    const double off = p[2] - ground(p[0], p[1]);
    sum += off * off;
    ++error.measured;
  }
  if (error.measured > 0) error.rmse_m = std::sqrt(sum / static_cast<double>(error.measured));
  if (error.cells > 0) {
    error.known_fraction = static_cast<double>(error.measured) / static_cast<double>(error.cells);
  }
  return error;
}

}  // namespace surefoot::apps
