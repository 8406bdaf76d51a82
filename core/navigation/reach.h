// Which cells of the cost map can be walked to from a cell: by steps to the four neighbours, which
// is the same as by A*'s eight, as a step across a corner needs both cells beside it free. Asked
// before a search, so that no search is made in vain.
//
// Bounds: each cell once. A lethal start reaches nothing. No errors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/navigation/cost_map.h"
#include "core/navigation/grid_search.h"

namespace surefoot::navigation {

class Reach {
 public:
  void flood(const CostMap& map, Cell start);
  // The other way round: what the map's border, and these ends, can be walked to from.
  void flood_from_outside(const CostMap& map, const Ends& ends);

  bool contains(std::uint32_t cell) const { return reached_[cell] != 0; }
  bool touches_border() const { return touches_border_; }

 private:
  void clear(const CostMap& map);
  void reach(const CostMap& map, std::uint32_t cell);
  void spread(const CostMap& map);

  bool touches_border_ = false;
  std::size_t queued_ = 0;
  std::array<std::uint8_t, kMaxCells> reached_{};
  std::array<std::uint32_t, kMaxCells> queue_{};
};

}  // namespace surefoot::navigation
