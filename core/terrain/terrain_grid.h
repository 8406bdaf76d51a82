// What is known about the ground in a window: heights where it was measured, ceilings where lines
// of sight passed over it. The input of the fill.
//
// A cell is a point: its height is that of the ground at the cell's centre, and so is its ceiling.
// Truth, measurement and bound must agree on this; with means of cells a tenth of the true heights
// would stand above their ceilings (README.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/status.h"
#include "core/mapping/height_map.h"
#include "core/mapping/map_window.h"
#include "core/terrain/table_index.h"

namespace surefoot::terrain {

inline constexpr std::int32_t kMaxSide = 200;  // cells along x and along y
inline constexpr std::int32_t kMaxCells = kMaxSide * kMaxSide;

enum class Knowledge : std::uint8_t {
  kUnknown = 0,  // no line of sight ever bounded it; stays unknown
  kBounded,      // unseen: the ground is not above the ceiling
  kMeasured,
};

// Cell (column, row) is the map's cell first + (column, row): x grows with the column.
struct TerrainGrid {
  std::int32_t columns = 0;
  std::int32_t rows = 0;
  double cell_m = 0;
  mapping::CellIndex first;
  std::array<float, kMaxCells> value_m{};  // measured: height. bounded: ceiling. unknown: 0
  std::array<Knowledge, kMaxCells> knowledge{};

  // All cells unknown. kInvalid: a side outside 1..kMaxSide, cell_m outside 1 mm..1 m, or a first
  // cell beyond the map's coordinates; nothing changed.
  Status reset(std::int32_t new_columns, std::int32_t new_rows, double new_cell_m,
               mapping::CellIndex new_first = {});

  std::size_t index(std::int32_t column, std::int32_t row) const {
    SUREFOOT_ASSERT(contains(column, row));
    return table_index(column, row, columns);
  }
  bool contains(std::int32_t column, std::int32_t row) const {
    return column >= 0 && column < columns && row >= 0 && row < rows;
  }
  std::int32_t size() const { return columns * rows; }

  // A measurement replaces whatever was there. Finite heights only.
  void measure(std::size_t i, float height_m);
  // Another line of sight: ceilings tighten, never loosen; measured cells stay as they are.
  void bound(std::size_t i, float ceiling_m);
};

// The published window as a grid. Assumed and bridged cells count as measured: they have a height
// to reckon with. kUnavailable: the window was never published; out is unchanged.
Status load(const mapping::MapWindow& window, TerrainGrid& out);

}  // namespace surefoot::terrain
