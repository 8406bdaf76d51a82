// A square height map that follows the robot: a ring buffer in both directions, so that a move
// costs only the strips that scroll in. Cells are addressed by their index in the odometry frame O
// and by nothing else; where a cell lies in memory is invisible.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/assert.h"
#include "core/base/hash.h"
#include "core/base/status.h"

namespace surefoot::mapping {

// Positions beyond this are refused (Status::kOutOfRange): a cell index then always fits 32 bits.
inline constexpr double kMaxCoordinate_m = 1e5;

// Cell (ix, iy) covers ix * size <= x < (ix + 1) * size, products rounded to double, and y
// likewise.
struct CellIndex {
  std::int32_t ix = 0;
  std::int32_t iy = 0;

  constexpr bool operator==(const CellIndex&) const = default;
  constexpr CellIndex operator+(const CellIndex& other) const {
    return {ix + other.ix, iy + other.iy};
  }
};

// |x| <= kMaxCoordinate_m, size >= 1 mm. Exact at the borders: see CellIndex.
constexpr std::int32_t cell_coordinate(double x, double cell_size_m) {
  auto i = static_cast<std::int32_t>(x / cell_size_m);
  if (static_cast<double>(i) * cell_size_m > x) --i;
  if (static_cast<double>(i + 1) * cell_size_m <= x) ++i;
  return i;
}
constexpr CellIndex cell_index(double x_O_m, double y_O_m, double cell_size_m) {
  return {cell_coordinate(x_O_m, cell_size_m), cell_coordinate(y_O_m, cell_size_m)};
}
constexpr double cell_centre(std::int32_t i, double cell_size_m) {
  return (static_cast<double>(i) + 0.5) * cell_size_m;
}
// False for NaN and infinity too.
constexpr bool is_mappable(double x) { return x >= -kMaxCoordinate_m && x <= kMaxCoordinate_m; }

enum class CellState : std::uint8_t {
  kUnknown = 0,  // nothing is known
  kBounded,      // never measured; a line of sight passed over it: the ground is below the ceiling
  kAssumed,      // not seen, but believed (the ground under the feet at the start)
  kMeasured,
};

// 16 bytes. Fields without a meaning in the current state are zero, so that equal cells have equal
// bits.
struct MapCell {
  float height_m = 0;             // measured, assumed: height in O. bounded: the ceiling
  float variance_m2 = 0;          // measured, assumed
  std::uint32_t stamp_ms = 0;     // of the last change by evidence; 0: never
  std::int16_t candidate_mm = 0;  // measured: where outliers agree the surface is, from height_m
  CellState state = CellState::kUnknown;
  std::uint8_t confirmations : 4 = 0;  // scans that agreed on the candidate
  std::uint8_t misses : 4 = 0;         // frames in a row that saw through the cell

  constexpr bool has_height() const { return state >= CellState::kAssumed; }
  void add_to(Fnv64& hash) const;
};
static_assert(sizeof(MapCell) == 16);

template <std::int32_t kSide>
class HeightMap {
  static_assert(kSide > 0);

 public:
  static constexpr std::int32_t side() { return kSide; }

  constexpr CellIndex first() const { return first_; }  // the cell with the smallest indices
  constexpr bool contains(CellIndex i) const {
    return offset(i.ix, first_.ix) < kSide && offset(i.iy, first_.iy) < kSide;
  }
  // nullptr: outside the map.
  constexpr const MapCell* find(CellIndex i) const {
    return contains(i) ? &cells_[slot(i)] : nullptr;
  }
  constexpr MapCell* find(CellIndex i) { return contains(i) ? &cells_[slot(i)] : nullptr; }
  // i must be inside.
  constexpr const MapCell& at(CellIndex i) const {
    SUREFOOT_ASSERT(contains(i));
    return cells_[slot(i)];
  }

  // The cells of row iy between ix_begin and ix_end (both inside the map) lie in at most two runs
  // of memory; calls visit(ix, cell&) in ascending ix.
  template <class Visit>
  void for_row(std::int32_t iy, std::int32_t ix_begin, std::int32_t ix_end, Visit&& visit) {
    visit_row(*this, iy, ix_begin, ix_end, visit);
  }
  template <class Visit>
  void for_row(std::int32_t iy, std::int32_t ix_begin, std::int32_t ix_end, Visit&& visit) const {
    visit_row(*this, iy, ix_begin, ix_end, visit);
  }

  // The same, run by run: calls visit(ix, first cell, number of cells) in ascending ix.
  template <class Visit>
  void for_runs(std::int32_t iy, std::int32_t ix_begin, std::int32_t ix_end, Visit&& visit) {
    if (ix_begin >= ix_end) return;
    SUREFOOT_ASSERT(contains({ix_begin, iy}) && contains({ix_end - 1, iy}));
    MapCell* row = &cells_[wrap(iy) * kSide];
    const auto column = static_cast<std::int32_t>(wrap(ix_begin));
    const std::int32_t count = std::min(ix_end - ix_begin, kSide - column);
    visit(ix_begin, row + column, count);
    if (ix_begin + count < ix_end) visit(ix_begin + count, row, ix_end - ix_begin - count);
  }

  // Quick access for loops around one cell of the map: |dx|, |dy| <= kSide / 2.
  class Around {
   public:
    constexpr Around(HeightMap& map, CellIndex anchor)
        : map_(map),
          anchor_(anchor),
          column_(static_cast<std::int32_t>(wrap(anchor.ix))),
          row_(static_cast<std::int32_t>(wrap(anchor.iy))) {}
    constexpr bool contains(std::int32_t dx, std::int32_t dy) const {
      return map_.contains({anchor_.ix + dx, anchor_.iy + dy});
    }
    constexpr MapCell* find(std::int32_t dx, std::int32_t dy) const {
      return contains(dx, dy) ? &at(dx, dy) : nullptr;
    }
    // The cell must be inside.
    constexpr MapCell& at(std::int32_t dx, std::int32_t dy) const {
      return map_.cells_[fold(row_ + dy) * kSide + fold(column_ + dx)];
    }

   private:
    static constexpr std::size_t fold(std::int32_t i) {
      return static_cast<std::size_t>(i < 0 ? i + kSide : (i >= kSide ? i - kSide : i));
    }
    HeightMap& map_;
    CellIndex anchor_;
    std::int32_t column_;
    std::int32_t row_;
  };

  // Quick access by place: columns and rows of kSide cells, counted from first().
  class Places {
   public:
    constexpr explicit Places(HeightMap& map)
        : map_(map),
          column_(static_cast<std::uint32_t>(wrap(map.first_.ix))),
          row_(static_cast<std::uint32_t>(wrap(map.first_.iy))) {}
    constexpr MapCell& at(std::uint32_t place) const {
      const std::uint32_t row = place / kSide;
      return map_.cells_[fold(row_ + row) * kSide + fold(column_ + place - row * kSide)];
    }

   private:
    static constexpr std::size_t fold(std::uint32_t i) { return i >= kSide ? i - kSide : i; }
    HeightMap& map_;
    std::uint32_t column_;
    std::uint32_t row_;
  };

  // What first() is once the map is centred at `centre`.
  static constexpr CellIndex corner(CellIndex centre) {
    return {centre.ix - kSide / 2, centre.iy - kSide / 2};
  }

  // Forgets everything; the map then covers kSide x kSide cells around `centre`.
  void reset(CellIndex centre) {
    for (MapCell& cell : cells_) cell = MapCell{};
    first_ = corner(centre);
  }

  // Moves the map so that it is centred at `centre`. Cells that stay inside keep every bit; cells
  // that come in are unknown. Cost: proportional to the cells that come in, at most kSide * kSide.
  void recentre(CellIndex centre) {
    const CellIndex target = corner(centre);
    const std::int64_t dx = std::int64_t{target.ix} - first_.ix;
    const std::int64_t dy = std::int64_t{target.iy} - first_.iy;
    if (dx >= kSide || dx <= -kSide || dy >= kSide || dy <= -kSide) {
      reset(centre);
      return;
    }
    const auto cx = static_cast<std::int32_t>(dx);
    const auto cy = static_cast<std::int32_t>(dy);
    // Rows that come in, over the whole new width; then the columns of the rows that stay. The slot
    // of an index depends on the index alone, so the leaving cells' memory is what is cleared.
    const std::int32_t row_begin = cy > 0 ? first_.iy + kSide : target.iy;
    const std::int32_t row_end = cy > 0 ? target.iy + kSide : first_.iy;
    const std::int32_t column_begin = cx > 0 ? first_.ix + kSide : target.ix;
    const std::int32_t column_end = cx > 0 ? target.ix + kSide : first_.ix;
    first_ = target;
    for (std::int32_t iy = row_begin; iy < row_end; ++iy) {
      for_row(iy, target.ix, target.ix + kSide, [](std::int32_t, MapCell& cell) { cell = {}; });
    }
    if (cx == 0) return;
    for (std::int32_t iy = target.iy; iy < target.iy + kSide; ++iy) {
      for_row(iy, column_begin, column_end, [](std::int32_t, MapCell& cell) { cell = {}; });
    }
  }

  // Over every cell in index order: equal for equal content, however the map moved there.
  void add_to(Fnv64& hash) const {
    hash.word(static_cast<std::uint32_t>(first_.ix), 4);
    hash.word(static_cast<std::uint32_t>(first_.iy), 4);
    for (std::int32_t iy = first_.iy; iy < first_.iy + kSide; ++iy) {
      for (std::int32_t ix = first_.ix; ix < first_.ix + kSide; ++ix) {
        cells_[slot({ix, iy})].add_to(hash);
      }
    }
  }

 private:
  template <class Self, class Visit>
  static void visit_row(Self& self, std::int32_t iy, std::int32_t ix_begin, std::int32_t ix_end,
                        Visit& visit) {
    if (ix_begin >= ix_end) return;
    SUREFOOT_ASSERT(self.contains({ix_begin, iy}) && self.contains({ix_end - 1, iy}));
    const std::size_t row = wrap(iy) * kSide;
    std::size_t column = wrap(ix_begin);
    for (std::int32_t ix = ix_begin; ix < ix_end; ++ix) {
      visit(ix, self.cells_[row + column]);
      if (++column == kSide) column = 0;
    }
  }
  static constexpr std::uint32_t offset(std::int32_t i, std::int32_t first) {
    return static_cast<std::uint32_t>(i) - static_cast<std::uint32_t>(first);
  }
  static constexpr std::size_t wrap(std::int32_t i) {
    const std::int32_t remainder = i % kSide;
    return static_cast<std::size_t>(remainder < 0 ? remainder + kSide : remainder);
  }
  static constexpr std::size_t slot(CellIndex i) { return wrap(i.iy) * kSide + wrap(i.ix); }

  std::array<MapCell, static_cast<std::size_t>(kSide) * kSide> cells_{};
  CellIndex first_;
};

}  // namespace surefoot::mapping
