// What control sees of the map: a copy of the 100 x 100 cells around the robot, with its own place
// and stamp. Plain data; never changes between two publications.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/status.h"
#include "core/base/time.h"
#include "core/mapping/height_map.h"
#include "core/mapping/traversability.h"

namespace surefoot::mapping {

inline constexpr std::int32_t kWindowSide = 100;

struct WindowCell {
  float height_m = 0;  // measured, assumed, bridged: height in O. bounded: the ceiling. unknown: 0
  CellState state = CellState::kUnknown;
  Traversability traversability = Traversability::kUnknown;
  bool bridged = false;  // a hole of one cell filled from its neighbours; state says what it was
  std::uint8_t margin_cells = 0;  // steppable: cells to the nearest that is not, at most
                                  // kMaxMargin_cells (Chebyshev distance)

  // A height to reckon with. Ground that was never seen has none, however tight its ceiling.
  constexpr bool has_height() const { return state >= CellState::kAssumed || bridged; }

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("height_m", self.height_m);
    visit("state", self.state);
    visit("traversability", self.traversability);
    visit("bridged", self.bridged);
    visit("margin_cells", self.margin_cells);
  }
};
static_assert(sizeof(WindowCell) == 8);

// Statistics of the cells with height whose centres lie within a radius.
struct PatchStatistics {
  std::uint32_t cells = 0;  // centres within the radius
  std::uint32_t known = 0;  // of these, with height
  double min_m = 0;         // heights in O; 0 where known == 0
  double max_m = 0;
  double mean_m = 0;
};

struct MapWindow {
  TimeNs stamp;              // of the youngest depth frame in it; 0: none yet
  std::uint64_t frames = 0;  // depth frames integrated so far
  double cell_size_m = 0;    // 0: never published; every query answers kUnavailable
  CellIndex first;           // cell with the smallest indices
  std::array<WindowCell, static_cast<std::size_t>(kWindowSide) * kWindowSide> cells{};

  // As before the first publication, and every page written. In place: a temporary of this size has
  // no business on the stack.
  void clear();

  bool contains(CellIndex i) const;
  // Of a cell inside, in `cells`.
  std::size_t place(CellIndex i) const {
    return static_cast<std::size_t>(i.iy - first.iy) * kWindowSide +
           static_cast<std::size_t>(i.ix - first.ix);
  }
  // nullptr: outside.
  const WindowCell* find(CellIndex i) const;
  // i must be inside.
  const WindowCell& at(CellIndex i) const;

  // The cell under a position in O. kInvalid: not finite. kOutOfRange: outside the window.
  // kUnavailable: nothing was published.
  Result<CellIndex> locate(double x_O_m, double y_O_m) const;
  // Errors as above; kNotFound: the cell has no height.
  Result<double> height_at(double x_O_m, double y_O_m) const;
  // Highest cell with height whose centre lies within radius_m of the segment from a to b (all x, y
  // in O). Cells outside the window and cells without height are passed over.
  // kNotFound: none has a height. kInvalid: not finite, negative radius or unmappable.
  Result<double> max_height_along(double ax_O_m, double ay_O_m, double bx_O_m, double by_O_m,
                                  double radius_m) const;
  // Cells within radius_m of the position; cells outside the window count as cells without height.
  // radius_m <= half the window's side, else kInvalid.
  Result<PatchStatistics> patch(double x_O_m, double y_O_m, double radius_m) const;

  // Hash of everything above.
  std::uint64_t digest() const;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("stamp_ns", self.stamp);
    visit("frames", self.frames);
    visit("cell_size_m", self.cell_size_m);
    visit("first_ix", self.first.ix);
    visit("first_iy", self.first.iy);
    visit("cells", self.cells);
  }
};

}  // namespace surefoot::mapping
