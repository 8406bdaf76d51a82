#include "apps/common/height_grid.h"

#include <cmath>

namespace surefoot::apps {

HeightGrid::HeightGrid(double x, double y, double width, double length_y, double cell)
    : x_m(x),
      y_m(y),
      cell_m(cell),
      columns(static_cast<int>(std::lround(width / cell))),
      rows(static_cast<int>(std::lround(length_y / cell))) {
  const std::size_t count = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  height_m.assign(count, 0.0F);
  known.assign(count, 0);
}

MapError compare(const HeightGrid& perceived, const HeightGrid& truth, double x_begin, double x_end,
                 double half_width) {
  MapError error;
  double sum = 0;
  std::size_t cells = 0;
  for (int row = 0; row < truth.rows; ++row) {
    if (std::fabs(truth.y_of(row)) > half_width) continue;
    for (int column = 0; column < truth.columns; ++column) {
      const double x = truth.x_of(column);
      const std::size_t i = truth.index(column, row);
      if (x < x_begin || x > x_end || truth.known[i] == 0) continue;
      ++cells;
      if (perceived.known[i] == 0) continue;
      const double off = static_cast<double>(perceived.height_m[i]) - truth.height_m[i];
      sum += off * off;
      ++error.compared;
    }
  }
  if (error.compared > 0) error.rmse_m = std::sqrt(sum / static_cast<double>(error.compared));
  if (cells > 0) {
    error.known_fraction = static_cast<double>(error.compared) / static_cast<double>(cells);
  }
  return error;
}

HeightGrid difference(const HeightGrid& perceived, const HeightGrid& truth) {
  HeightGrid result = truth;
  for (std::size_t i = 0; i < result.height_m.size(); ++i) {
    result.known[i] = perceived.known[i] & truth.known[i];
    result.height_m[i] = result.known[i] != 0 ? perceived.height_m[i] - truth.height_m[i] : 0.0F;
  }
  return result;
}

}  // namespace surefoot::apps
