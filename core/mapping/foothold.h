// Where to put a foot: the nearest cell that can bear one.
#pragma once

#include <cstdint>

#include "core/base/status.h"
#include "core/mapping/map_window.h"

namespace surefoot::mapping {

// Bounds the search: at 1.5 cm cells, 30 cm.
inline constexpr std::int32_t kMaxSearchRadius_cells = 20;

struct FootholdQuery {
  double x_O_m = 0;  // nominal foothold
  double y_O_m = 0;
  double max_radius_m = 0;  // from the nominal point to a cell's centre
  // Reach: footholds farther than reach_m from this point (the hip, seen from above) are no use.
  double reach_x_O_m = 0;
  double reach_y_O_m = 0;
  double reach_m = 0;       // 0: no such limit
  double min_z_O_m = -1e3;  // heights the leg can reach
  double max_z_O_m = 1e3;
  // Metres of detour one more cell of distance from the nearest bad cell is worth (0: the nearest
  // cell wins).
  double margin_weight_m = 0;
};

struct Foothold {
  double x_O_m = 0;
  double y_O_m = 0;
  double z_O_m = 0;  // the ground: mean of the known cells of the 3 x 3 around it
  CellIndex cell;
  bool moved = false;  // false: the nominal point itself
  double distance_m = 0;
};

// The nominal point itself where its cell is steppable, in reach and margin_weight_m is 0; else the
// centre of the steppable cell of smallest cost
//   distance(nominal, centre) + margin_weight_m * (kMaxMargin_cells - margin_cells),
// ties by (rings of distance, iy, ix). With a margin weight the nominal point competes with
// distance zero. Cost: at most all cells within kMaxSearchRadius_cells (1257), fewer when one is
// found early. kNotFound: none within reach. kInvalid: not finite or a negative length.
// kOutOfRange: max_radius_m above kMaxSearchRadius_cells cells or the nominal point is unmappable.
// kUnavailable: window empty. Never returns a cell that is not steppable or lies outside the
// window.
Result<Foothold> find_foothold(const MapWindow& window, const FootholdQuery& query);

// What is under a foot: calls visit(index, cell) for the cells with height of the 3 x 3 around one.
// The ground's height there is their mean: less noise than one cell, and over a steppable cell no
// step.
template <class Visit>
void for_cells_under_foot(const MapWindow& window, CellIndex centre, Visit&& visit) {
  for (std::int32_t i = 0; i < 9; ++i) {
    const CellIndex index = centre + CellIndex{i % 3 - 1, i / 3 - 1};
    const WindowCell* cell = window.find(index);
    if (cell != nullptr && cell->has_height()) visit(index, *cell);
  }
}

// The highest of them. kNotFound: none has a height.
Result<float> highest_ground_m(const MapWindow& window, CellIndex centre);

// Height of the ground under a foot at a place around which the ground bears feet everywhere: the
// mean as in Foothold::z_O_m. Errors as MapWindow::locate; kNotFound: not steppable, or something
// that is not is next to it.
Result<double> level_ground_m(const MapWindow& window, double x_O_m, double y_O_m);

}  // namespace surefoot::mapping
