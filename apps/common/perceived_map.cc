#include "apps/common/perceived_map.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
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

int floor_divided(int value, int by) { return value / by - (value % by < 0 ? 1 : 0); }

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

ClassGrid classify_map(const mapping::ControlMap& map, const mapping::MappingConfig& config,
                       const mapping::TraversabilityLimits& limits, const Alignment& O_in_W,
                       const HeightGrid& raster) {
  constexpr int kSide = mapping::kWindowSide;
  ClassGrid grid(raster);
  const auto classifier = std::make_unique<mapping::WindowClassifier>();
  classifier->reset(config, limits);
  std::map<std::pair<int, int>, std::unique_ptr<mapping::MapWindow>> windows;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const auto p = O_in_W.to_odometry({raster.x_of(column), raster.y_of(row), 0});
      const mapping::CellIndex cell = mapping::cell_index(p[0], p[1], config.cell_size_m);
      const int tile_x = floor_divided(cell.ix, kSide);
      const int tile_y = floor_divided(cell.iy, kSide);
      auto& window = windows[{tile_x, tile_y}];
      if (!window) {
        window = std::make_unique<mapping::MapWindow>();
        classifier->run(map, {tile_x * kSide + kSide / 2, tile_y * kSide + kSide / 2}, *window);
      }
      grid.classes[raster.index(column, row)] = window->at(cell).traversability;
    }
  }
  return grid;
}

namespace {

// Ring by ring around (x, y), until no sample can be nearer than what is known.
void look_around(const TrueGround& ground, const std::array<double, 3>& p, double step_m,
                 double& nearest_m) {
  const auto look = [&](int dx, int dy) {
    const double across_m = std::hypot(dx, dy) * step_m;
    if (across_m >= nearest_m) return;
    const double x = p[0] + dx * step_m;
    const double y = p[1] + dy * step_m;
    const auto [low, high] =
        std::minmax({ground(x, y), ground(x + step_m, y), ground(x, y + step_m)});
    const double off_m = p[2] < low ? low - p[2] : (p[2] > high ? p[2] - high : 0.0);
    nearest_m = std::min(nearest_m, std::hypot(across_m, off_m));
  };
  for (int ring = 1; ring * step_m < nearest_m; ++ring) {
    for (int i = -ring; i <= ring; ++i) {
      look(i, -ring);
      look(i, ring);
    }
    for (int i = 1 - ring; i < ring; ++i) {
      look(-ring, i);
      look(ring, i);
    }
  }
}

}  // namespace

double distance_to_surface_m(const TrueGround& ground, double x_m, double y_m, double z_m) {
  // Millimetres up to 5 cm, at most 4 % of what is farther: the foot of a tree would take a million
  // samples.
  const auto step_for = [](double distance_m) { return std::max(0.001, distance_m / 50); };
  double nearest_m = std::fabs(z_m - ground(x_m, y_m));
  double step_m = 0;
  do {
    step_m = step_for(nearest_m);
    look_around(ground, {x_m, y_m, z_m}, step_m, nearest_m);
  } while (step_for(nearest_m) < 0.5 * step_m);
  return nearest_m;
}

MapError map_error(const mapping::Mapper& mapper, const Alignment& O_in_W, const RunLog& log,
                   const TrueGround& ground, double half_width_m) {
  MapError error;
  if (!mapper.configured()) return error;
  const double size = mapper.cell_size_m();
  double sum = 0;
  double vertical_sum = 0;
  std::vector<double> sizes;
  for (const auto& [ix, iy] : corridor(log, O_in_W, size, half_width_m)) {
    ++error.cells;
    const mapping::MapCell* cell = mapper.map().find({ix, iy});
    if (cell == nullptr || cell->state != mapping::CellState::kMeasured) continue;
    const auto p = O_in_W.to_world({mapping::cell_centre(ix, size), mapping::cell_centre(iy, size),
                                    static_cast<double>(cell->height_m)});
    const double height_off = p[2] - ground(p[0], p[1]);
    vertical_sum += height_off * height_off;
    const double off = distance_to_surface_m(ground, p[0], p[1], p[2]);
    sum += off * off;
    sizes.push_back(off);
    ++error.measured;
  }
  if (!sizes.empty()) {
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    error.median_m = *middle;
  }
  if (error.measured > 0) {
    error.rmse_m = std::sqrt(sum / static_cast<double>(error.measured));
    error.vertical_rmse_m = std::sqrt(vertical_sum / static_cast<double>(error.measured));
  }
  if (error.cells > 0) {
    error.known_fraction = static_cast<double>(error.measured) / static_cast<double>(error.cells);
  }
  return error;
}

}  // namespace surefoot::apps
