#include "core/mapping/classifier.h"

#include <algorithm>

#include "core/math/elementary.h"

namespace surefoot::mapping {
namespace {

constexpr std::size_t kNeighbours = 8;

// The whole multiple of `lattice` at or below i.
constexpr std::int32_t floor_to(std::int32_t i, std::int32_t lattice) {
  const std::int32_t remainder = i % lattice;
  return i - (remainder < 0 ? remainder + lattice : remainder);
}

}  // namespace

void WindowClassifier::reset(const MappingConfig& config, const TraversabilityLimits& limits) {
  bridge_holes_ = config.bridge_holes;
  placed_ = false;
  cells_.fill(Source{});
  filter_.reset(limits, config.cell_size_m);
}

void WindowClassifier::run(const ControlMap& map, CellIndex centre, MapWindow& out) {
  out.first = {centre.ix - kWindowSide / 2, centre.iy - kWindowSide / 2};
  const CellIndex origin{floor_to(out.first.ix - kRim, kLattice),
                         floor_to(out.first.iy - kRim, kLattice)};
  const bool moved = !placed_ || !(origin == origin_);
  origin_ = origin;
  placed_ = true;
  const CellRect differs = load(map);
  const CellRect changed = moved ? CellRect{0, kSide, 0, kSide} : differs;
  recomputed_cells_ = 0;
  if (!changed.empty()) fill_filter(changed);
  copy_to(out);
}

CellRect WindowClassifier::load(const ControlMap& map) {
  CellRect differs{kSide, 0, kSide, 0};
  const CellIndex first = map.first();
  const std::int32_t begin = math::clamp(first.ix - origin_.ix, 0, kSide);
  const std::int32_t end = math::clamp(first.ix + kMapSide - origin_.ix, begin, kSide);
  for (std::int32_t y = 0; y < kSide; ++y) {
    const std::int32_t iy = origin_.iy + y;
    const bool inside = iy >= first.iy && iy < first.iy + kMapSide;
    const auto take = [&](std::int32_t x, float height_m, CellState state) {
      Source& source = cells_[at(x, y)];
      if (source.height_m == height_m && source.state == state) return;
      source = {.height_m = height_m, .state = state};
      differs = {std::min(differs.x_begin, x), std::max(differs.x_end, x + 1),
                 std::min(differs.y_begin, y), y + 1};
    };
    const std::int32_t row_begin = inside ? begin : kSide;
    const std::int32_t row_end = inside ? end : kSide;
    for (std::int32_t x = 0; x < row_begin; ++x) take(x, 0, CellState::kUnknown);
    for (std::int32_t x = row_end; x < kSide; ++x) take(x, 0, CellState::kUnknown);
    map.for_row(iy, origin_.ix + row_begin, origin_.ix + row_end,
                [&](std::int32_t ix, const MapCell& cell) {
                  take(ix - origin_.ix, cell.height_m, cell.state);
                });
  }
  return differs;
}

// Sets or ends the bridge over one cell.
void WindowClassifier::bridge(std::int32_t x, std::int32_t y) {
  Source& cell = cells_[at(x, y)];
  cell.bridged = false;
  cell.bridge_m = 0;
  const bool inside = x > 0 && y > 0 && x + 1 < kSide && y + 1 < kSide;
  if (!bridge_holes_ || !inside || cell.state >= CellState::kAssumed) return;
  std::array<float, kNeighbours> heights{};
  std::size_t count = 0;
  for (std::int32_t i = 0; i < 9; ++i) {
    if (i == 4) continue;
    const Source& other = cells_[at(x + i % 3 - 1, y + i / 3 - 1)];
    if (other.state < CellState::kAssumed) return;
    std::size_t place = count++;  // sorted insertion
    for (; place > 0 && heights[place - 1] > other.height_m; --place) {
      heights[place] = heights[place - 1];
    }
    heights[place] = other.height_m;
  }
  const float median = 0.5F * (heights[3] + heights[4]);
  // A line of sight passed here: the ground cannot stand above it.
  cell.bridge_m = cell.state == CellState::kBounded ? std::min(median, cell.height_m) : median;
  cell.bridged = true;
}

void WindowClassifier::fill_filter(const CellRect& changed) {
  const CellRect rect = changed.grown(kBridge, kSide);
  for (std::int32_t y = rect.y_begin; y < rect.y_end; ++y) {
    for (std::int32_t x = rect.x_begin; x < rect.x_end; ++x) {
      bridge(x, y);
      const Source& cell = cells_[at(x, y)];
      if (cell.bridged) {
        filter_.set(x, y, cell.bridge_m);
      } else if (cell.state >= CellState::kAssumed) {
        filter_.set(x, y, cell.height_m);
      } else {
        filter_.clear(x, y);
      }
    }
  }
  filter_.update(rect);
  const CellRect all = rect.grown(kFilterReach_cells, kSide);
  recomputed_cells_ = (all.x_end - all.x_begin) * (all.y_end - all.y_begin);
}

void WindowClassifier::copy_to(MapWindow& out) const {
  const std::int32_t shift_x = out.first.ix - origin_.ix;
  const std::int32_t shift_y = out.first.iy - origin_.iy;
  for (std::int32_t y = 0; y < kWindowSide; ++y) {
    for (std::int32_t x = 0; x < kWindowSide; ++x) {
      const Source& source = cells_[at(x + shift_x, y + shift_y)];
      WindowCell& cell =
          out.cells[static_cast<std::size_t>(y) * kWindowSide + static_cast<std::size_t>(x)];
      cell.height_m = source.bridged ? source.bridge_m : source.height_m;
      cell.state = source.state;
      cell.traversability = filter_.traversability(x + shift_x, y + shift_y);
      cell.bridged = source.bridged;
      cell.margin_cells = filter_.margin_cells(x + shift_x, y + shift_y);
    }
  }
}

}  // namespace surefoot::mapping
