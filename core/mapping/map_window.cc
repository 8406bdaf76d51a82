#include "core/mapping/map_window.h"

#include "core/base/fields.h"
#include "core/math/elementary.h"

namespace surefoot::mapping {
namespace {

constexpr std::int32_t kSide = kWindowSide;

// The part of the window that a circle or capsule can touch, as offsets from window.first.
struct Span {
  std::int32_t begin = 0;
  std::int32_t end = 0;
};

Span clip(double low, double high, std::int32_t first, double cell_size_m) {
  const std::int32_t begin = cell_coordinate(low, cell_size_m) - first;
  const std::int32_t end = cell_coordinate(high, cell_size_m) - first + 1;
  return {math::clamp(begin, 0, kSide), math::clamp(end, 0, kSide)};
}

double distance2_to_segment(double px, double py, double ax, double ay, double bx, double by) {
  const double dx = bx - ax;
  const double dy = by - ay;
  const double length2 = dx * dx + dy * dy;
  double along = 0;
  if (length2 > 0) along = math::clamp(((px - ax) * dx + (py - ay) * dy) / length2, 0.0, 1.0);
  return math::square(px - ax - along * dx) + math::square(py - ay - along * dy);
}

}  // namespace

bool MapWindow::contains(CellIndex i) const {
  const std::int64_t dx = std::int64_t{i.ix} - first.ix;
  const std::int64_t dy = std::int64_t{i.iy} - first.iy;
  return dx >= 0 && dx < kSide && dy >= 0 && dy < kSide;
}

const WindowCell* MapWindow::find(CellIndex i) const {
  return contains(i) ? &cells[place(i)] : nullptr;
}

const WindowCell& MapWindow::at(CellIndex i) const {
  const WindowCell* cell = find(i);
  SUREFOOT_ASSERT(cell != nullptr);
  return *cell;
}

Result<CellIndex> MapWindow::locate(double x_O_m, double y_O_m) const {
  if (!math::is_finite(x_O_m) || !math::is_finite(y_O_m)) return Status::kInvalid;
  if (!(cell_size_m > 0)) return Status::kUnavailable;
  if (!is_mappable(x_O_m) || !is_mappable(y_O_m)) return Status::kOutOfRange;
  const CellIndex index = cell_index(x_O_m, y_O_m, cell_size_m);
  if (!contains(index)) return Status::kOutOfRange;
  return index;
}

Result<double> MapWindow::height_at(double x_O_m, double y_O_m) const {
  const Result<CellIndex> index = locate(x_O_m, y_O_m);
  if (!index.ok()) return index.status();
  const WindowCell& cell = at(index.value());
  if (!cell.has_height()) return Status::kNotFound;
  return static_cast<double>(cell.height_m);
}

Result<double> MapWindow::max_height_along(double ax_O_m, double ay_O_m, double bx_O_m,
                                           double by_O_m, double radius_m) const {
  const bool valid = is_mappable(ax_O_m) && is_mappable(ay_O_m) && is_mappable(bx_O_m) &&
                     is_mappable(by_O_m) && radius_m >= 0 && radius_m <= 1e3;
  if (!valid) return Status::kInvalid;
  if (!(cell_size_m > 0)) return Status::kUnavailable;
  const double low_x = (ax_O_m < bx_O_m ? ax_O_m : bx_O_m) - radius_m;
  const double high_x = (ax_O_m < bx_O_m ? bx_O_m : ax_O_m) + radius_m;
  const double low_y = (ay_O_m < by_O_m ? ay_O_m : by_O_m) - radius_m;
  const double high_y = (ay_O_m < by_O_m ? by_O_m : ay_O_m) + radius_m;
  const Span columns = clip(low_x, high_x, first.ix, cell_size_m);
  const Span rows = clip(low_y, high_y, first.iy, cell_size_m);
  bool found = false;
  double highest = 0;
  for (std::int32_t y = rows.begin; y < rows.end; ++y) {
    for (std::int32_t x = columns.begin; x < columns.end; ++x) {
      const CellIndex index = first + CellIndex{x, y};
      const WindowCell& cell = at(index);
      if (!cell.has_height()) continue;
      const double height = static_cast<double>(cell.height_m);
      if (found && height <= highest) continue;
      const double distance2 =
          distance2_to_segment(cell_centre(index.ix, cell_size_m),
                               cell_centre(index.iy, cell_size_m), ax_O_m, ay_O_m, bx_O_m, by_O_m);
      if (distance2 > radius_m * radius_m) continue;
      highest = height;
      found = true;
    }
  }
  if (!found) return Status::kNotFound;
  return highest;
}

Result<PatchStatistics> MapWindow::patch(double x_O_m, double y_O_m, double radius_m) const {
  const bool valid = is_mappable(x_O_m) && is_mappable(y_O_m) && radius_m >= 0 &&
                     radius_m <= 0.5 * kSide * cell_size_m;
  if (!(cell_size_m > 0)) return Status::kUnavailable;
  if (!valid) return Status::kInvalid;
  const CellIndex low = cell_index(x_O_m - radius_m, y_O_m - radius_m, cell_size_m);
  const CellIndex high = cell_index(x_O_m + radius_m, y_O_m + radius_m, cell_size_m);
  PatchStatistics statistics;
  double sum = 0;
  for (std::int32_t iy = low.iy; iy <= high.iy; ++iy) {
    for (std::int32_t ix = low.ix; ix <= high.ix; ++ix) {
      const double distance2 = math::square(cell_centre(ix, cell_size_m) - x_O_m) +
                               math::square(cell_centre(iy, cell_size_m) - y_O_m);
      if (distance2 > radius_m * radius_m) continue;
      ++statistics.cells;
      const WindowCell* cell = find({ix, iy});
      if (cell == nullptr || !cell->has_height()) continue;
      const double height = static_cast<double>(cell->height_m);
      const bool is_first = statistics.known == 0;
      if (is_first || height < statistics.min_m) statistics.min_m = height;
      if (is_first || height > statistics.max_m) statistics.max_m = height;
      sum += height;
      ++statistics.known;
    }
  }
  if (statistics.known > 0) statistics.mean_m = sum / statistics.known;
  return statistics;
}

void MapWindow::clear() {
  stamp = TimeNs{};
  frames = 0;
  cell_size_m = 0;
  first = CellIndex{};
  cells.fill(WindowCell{});
}

std::uint64_t MapWindow::digest() const {
  Fnv64 hash;
  FieldHasher hasher(hash);
  hasher.members(*this);
  return hash.value();
}

}  // namespace surefoot::mapping
