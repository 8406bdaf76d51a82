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

HeightGrid difference(const HeightGrid& perceived, const HeightGrid& truth) {
  HeightGrid result = truth;
  for (std::size_t i = 0; i < result.height_m.size(); ++i) {
    result.known[i] = perceived.known[i] & truth.known[i];
    result.height_m[i] = result.known[i] != 0 ? perceived.height_m[i] - truth.height_m[i] : 0.0F;
  }
  return result;
}

}  // namespace surefoot::apps
