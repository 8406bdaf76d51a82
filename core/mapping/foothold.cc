#include "core/mapping/foothold.h"

#include <array>
#include <cstddef>

#include "core/math/elementary.h"

namespace surefoot::mapping {
namespace {

struct Offset {
  std::int8_t dx = 0;
  std::int8_t dy = 0;
};

constexpr std::int32_t kRadius = kMaxSearchRadius_cells;
constexpr std::int32_t kRadius2 = kRadius * kRadius;

constexpr std::size_t count_offsets() {
  std::size_t count = 0;
  for (std::int32_t dy = -kRadius; dy <= kRadius; ++dy) {
    for (std::int32_t dx = -kRadius; dx <= kRadius; ++dx) {
      if (dx * dx + dy * dy <= kRadius2) ++count;
    }
  }
  return count;
}
constexpr std::size_t kOffsets = count_offsets();

// All cells of the disc by (distance, dy, dx): a counting sort, in the compiler.
constexpr std::array<Offset, kOffsets> make_spiral() {
  std::array<std::uint16_t, kRadius2 + 2> begin{};
  for (std::int32_t dy = -kRadius; dy <= kRadius; ++dy) {
    for (std::int32_t dx = -kRadius; dx <= kRadius; ++dx) {
      const std::int32_t distance2 = dx * dx + dy * dy;
      if (distance2 <= kRadius2) ++begin[static_cast<std::size_t>(distance2) + 1];
    }
  }
  for (std::size_t i = 1; i < begin.size(); ++i) {
    begin[i] = static_cast<std::uint16_t>(begin[i] + begin[i - 1]);
  }
  std::array<Offset, kOffsets> spiral{};
  for (std::int32_t dy = -kRadius; dy <= kRadius; ++dy) {
    for (std::int32_t dx = -kRadius; dx <= kRadius; ++dx) {
      const std::int32_t distance2 = dx * dx + dy * dy;
      if (distance2 > kRadius2) continue;
      spiral[begin[static_cast<std::size_t>(distance2)]++] = {static_cast<std::int8_t>(dx),
                                                              static_cast<std::int8_t>(dy)};
    }
  }
  return spiral;
}
constexpr std::array<Offset, kOffsets> kSpiral = make_spiral();

Status check(const MapWindow& window, const FootholdQuery& query) {
  const bool finite = math::is_finite(query.x_O_m) && math::is_finite(query.y_O_m) &&
                      math::is_finite(query.reach_x_O_m) && math::is_finite(query.reach_y_O_m) &&
                      query.max_radius_m >= 0 && query.reach_m >= 0 && query.min_z_O_m <= 1e9 &&
                      query.max_z_O_m >= -1e9 && query.margin_weight_m >= 0;
  if (!finite) return Status::kInvalid;
  if (!(window.cell_size_m > 0)) return Status::kUnavailable;
  const bool in_range = is_mappable(query.x_O_m) && is_mappable(query.y_O_m) &&
                        query.max_radius_m <= kRadius * window.cell_size_m;
  return in_range ? Status::kOk : Status::kOutOfRange;
}

// There must be a height.
double ground_under_foot_m(const MapWindow& window, CellIndex centre) {
  double sum = 0;
  int count = 0;
  for_cells_under_foot(window, centre, [&](CellIndex, const WindowCell& cell) {
    sum += static_cast<double>(cell.height_m);
    ++count;
  });
  return sum / count;
}

bool reachable(const FootholdQuery& query, double x, double y, double z) {
  if (!(z >= query.min_z_O_m && z <= query.max_z_O_m)) return false;
  if (!(query.reach_m > 0)) return true;
  return math::square(x - query.reach_x_O_m) + math::square(y - query.reach_y_O_m) <=
         query.reach_m * query.reach_m;
}

}  // namespace

Result<Foothold> find_foothold(const MapWindow& window, const FootholdQuery& query) {
  const Status status = check(window, query);
  if (!ok(status)) return status;
  const double size = window.cell_size_m;
  const CellIndex nominal = cell_index(query.x_O_m, query.y_O_m, size);
  bool found = false;
  double best_cost = 0;
  Foothold best;
  for (std::size_t i = 0; i < kOffsets; ++i) {
    const Offset offset = kSpiral[i];
    // No cell from here on is nearer than its offset less half a cell's diagonal.
    const double ring =
        math::sqrt(static_cast<double>(offset.dx * offset.dx + offset.dy * offset.dy));
    const double least = (ring - 0.7072) * size;
    if (least > query.max_radius_m || (found && least > best_cost)) break;
    const CellIndex index = nominal + CellIndex{offset.dx, offset.dy};
    const WindowCell* cell = window.find(index);
    if (cell == nullptr || cell->traversability != Traversability::kSteppable) continue;
    const double x = i == 0 ? query.x_O_m : cell_centre(index.ix, size);
    const double y = i == 0 ? query.y_O_m : cell_centre(index.iy, size);
    const double distance =
        math::sqrt(math::square(x - query.x_O_m) + math::square(y - query.y_O_m));
    const double cost = distance + query.margin_weight_m * (kMaxMargin_cells - cell->margin_cells);
    if (distance > query.max_radius_m || (found && cost >= best_cost)) continue;
    const double z = ground_under_foot_m(window, index);
    if (!reachable(query, x, y, z)) continue;
    best = {x, y, z, index, i != 0, distance};
    best_cost = cost;
    found = true;
  }
  if (!found) return Status::kNotFound;
  return best;
}

Result<float> highest_ground_m(const MapWindow& window, CellIndex centre) {
  float highest_m = 0;
  bool found = false;
  for_cells_under_foot(window, centre, [&](CellIndex, const WindowCell& cell) {
    if (!found || cell.height_m > highest_m) highest_m = cell.height_m;
    found = true;
  });
  if (!found) return Status::kNotFound;
  return highest_m;
}

Result<double> level_ground_m(const MapWindow& window, double x_O_m, double y_O_m) {
  const Result<CellIndex> index = window.locate(x_O_m, y_O_m);
  if (!index.ok()) return index.status();
  const WindowCell& cell = window.at(index.value());
  const bool level = cell.traversability == Traversability::kSteppable && cell.margin_cells > 1;
  if (!level) return Status::kNotFound;
  return ground_under_foot_m(window, index.value());
}

}  // namespace surefoot::mapping
