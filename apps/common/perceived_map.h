// The perceived map beside the ground truth.
#pragma once

#include <cstddef>
#include <functional>

#include "apps/common/height_grid.h"
#include "apps/common/run_log.h"
#include "core/mapping/mapper.h"

namespace surefoot::apps {

struct MapError {
  double rmse_m = 0;          // of the measured cells; 0 where there is none
  double known_fraction = 0;  // measured cells of all cells in the corridor
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

// The map's own cells whose centres lie within `half_width` of the body's trace, each against the
// ground at its centre: error of the measured ones, and their share.
MapError map_error(const mapping::Mapper& mapper, const Alignment& O_in_W, const RunLog& log,
                   const TrueGround& ground, double half_width_m);

}  // namespace surefoot::apps
