// What stands in the way: connected cells of the published window that cannot be passed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/mapping/map_window.h"

namespace surefoot::obstacles {

inline constexpr std::size_t kWindowCells =
    static_cast<std::size_t>(mapping::kWindowSide) * mapping::kWindowSide;

// What blocks beside the class IMPASSABLE.
struct BlockingRule {
  bool jump_only = true;  // the class JUMP_ONLY: places that a mission without jumps cannot pass
  // A cell this much higher than the lowest within kRiseReach_cells. The camera sees the face of an
  // object, one or two cells of the map, and where the ground behind it is known from before, the
  // opening of the height filter takes that for noise.
  double min_rise_m = 0;
};

inline constexpr std::int32_t kRiseReach_cells = 3;

// Objects are sets of blocked cells connected over sides and corners. Every cell is visited a fixed
// number of times, by an explicit queue: no recursion, no bound but the window's size.
class ObjectFinder {
 public:
  // Touches every page.
  void reset();

  // min_cells: smaller ones are not objects. A window that was never published has none.
  void find(const mapping::MapWindow& window, const BlockingRule& rule, std::size_t min_cells);

  // Label of the object that the window's cell belongs to (row-major index), from 1 in the order of
  // their first cells; 0: none.
  std::uint16_t label(std::size_t cell) const { return labels_[cell]; }
  std::size_t objects() const { return objects_; }
  // Sets of cells below min_cells in this window.
  std::size_t too_small() const { return too_small_; }

 private:
  void mark(const mapping::MapWindow& window, const BlockingRule& rule);
  // Cells of the set that holds `seed`, which become label; they stand in queue_.
  std::size_t flood(std::uint16_t seed, std::uint16_t label);

  std::array<std::uint16_t, kWindowCells> labels_{};
  std::array<std::uint16_t, kWindowCells> queue_{};
  std::size_t objects_ = 0;
  std::size_t too_small_ = 0;
};

}  // namespace surefoot::obstacles
