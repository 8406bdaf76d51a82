// The edge ahead in the published map: of a platform to jump on, or of a gap to jump over.
//
// Lines run along the heading, side by side over the width that a jump needs. Each one ends where
// the ground rises by at least min_rise_m within four cells, or falls by min_drop_m: what was never
// seen is no hole, but where a line of sight passed below the ground there is one. A slope is
// neither. A straight line is fitted through the ends; too few of them, or ends that lie on no
// straight line, are no ledge.
//
// A line steps from cell to cell, and begins a quarter of a cell after its neighbour: so the places
// of the ends have errors of their own and their mean is good to a fraction of a cell.
//
// Frame O. Cost: kLedgeLines lines of at most the window's half side. No allocation.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/status.h"
#include "core/mapping/map_window.h"
#include "core/math/linear.h"

namespace surefoot::autonomy {

inline constexpr std::size_t kLedgeLines = 25;

struct LedgeQuery {
  double x_O_m = 0;  // the trunk's origin
  double y_O_m = 0;
  double yaw_rad = 0;
  double ground_z_m = 0;  // under the feet: stands for what is not known where the lines begin
  double from_m = 0;      // the lines begin so far ahead
  double half_width_m = 0;
  double min_rise_m = 0;
  double min_drop_m = 0;
};

struct Ledge {
  enum class Kind : std::uint8_t { kPlatform = 0, kGap };
  Kind kind = Kind::kPlatform;
  Vector3 edge_O_m = Vector3::Zero();  // a point of it, at the height of the ground before it
  double yaw_rad = 0;                  // heading that faces it squarely
  double rise_m = 0;                   // of the ground behind it
  double gap_m = 0;                    // kGap: from edge to edge, along the normal
  double spread_m = 0;                 // rms of the ends about the line

  // From a place to the edge, along its normal.
  double distance_m(double x_O_m, double y_O_m) const;
};

// kUnavailable: no map. kNotFound: no ledge ahead within the window.
Result<Ledge> find_ledge(const mapping::MapWindow& window, const LedgeQuery& query);

// The rectangle to land on, beyond the edge: begins from_m behind it, measured along the normal.
struct LandingArea {
  double from_m = 0;
  double length_m = 0;
  double half_width_m = 0;
  double max_error_m = 0;  // of the heights, to the ledge's rise
  double min_known = 0;    // share of its cells
};
// Whether it is seen, level and free. along_edge_m: of its middle from edge_O_m, to the left.
bool landing_is_free(const mapping::MapWindow& window, const Ledge& ledge, double along_edge_m,
                     const LandingArea& area);

}  // namespace surefoot::autonomy
