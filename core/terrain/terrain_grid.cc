#include "core/terrain/terrain_grid.h"

#include "core/math/elementary.h"

namespace surefoot::terrain {

namespace {

constexpr double kSmallestCell_m = 0.001;
constexpr double kLargestCell_m = 1.0;
// Any window the map can publish, and no overflow in first + column.
constexpr std::int32_t kFarthestCell = 1'000'000'000;

bool is_place(std::int32_t i) { return i >= -kFarthestCell && i <= kFarthestCell; }

}  // namespace

Status TerrainGrid::reset(std::int32_t new_columns, std::int32_t new_rows, double new_cell_m,
                          mapping::CellIndex new_first) {
  const bool sides =
      new_columns >= 1 && new_columns <= kMaxSide && new_rows >= 1 && new_rows <= kMaxSide;
  const bool cell = new_cell_m >= kSmallestCell_m && new_cell_m <= kLargestCell_m;
  if (!sides || !cell || !is_place(new_first.ix) || !is_place(new_first.iy)) {
    return Status::kInvalid;
  }
  columns = new_columns;
  rows = new_rows;
  cell_m = new_cell_m;
  first = new_first;
  value_m.fill(0);
  knowledge.fill(Knowledge::kUnknown);
  return Status::kOk;
}

void TerrainGrid::measure(std::size_t i, float height_m) {
  SUREFOOT_ASSERT(math::is_finite(static_cast<double>(height_m)));
  value_m[i] = height_m;
  knowledge[i] = Knowledge::kMeasured;
}

void TerrainGrid::bound(std::size_t i, float ceiling_m) {
  SUREFOOT_ASSERT(math::is_finite(static_cast<double>(ceiling_m)));
  if (knowledge[i] == Knowledge::kMeasured) return;
  if (knowledge[i] == Knowledge::kBounded && value_m[i] <= ceiling_m) return;
  value_m[i] = ceiling_m;
  knowledge[i] = Knowledge::kBounded;
}

Status load(const mapping::MapWindow& window, TerrainGrid& out) {
  if (!(window.cell_size_m > 0)) return Status::kUnavailable;
  const Status status =
      out.reset(mapping::kWindowSide, mapping::kWindowSide, window.cell_size_m, window.first);
  if (!ok(status)) return status;
  for (std::size_t i = 0; i < window.cells.size(); ++i) {
    const mapping::WindowCell& cell = window.cells[i];
    if (cell.has_height()) {
      out.measure(i, cell.height_m);
    } else if (cell.state == mapping::CellState::kBounded) {
      out.bound(i, cell.height_m);
    }
  }
  return Status::kOk;
}

}  // namespace surefoot::terrain
