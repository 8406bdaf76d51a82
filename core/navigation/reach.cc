#include "core/navigation/reach.h"

namespace surefoot::navigation {

void Reach::clear(const CostMap& map) {
  const auto side = static_cast<std::uint32_t>(map.side());
  for (std::uint32_t i = 0; i < side * side; ++i) reached_[i] = 0;
  touches_border_ = false;
  queued_ = 0;
}

void Reach::reach(const CostMap& map, std::uint32_t cell) {
  if (reached_[cell] != 0 || map.cost(cell) == kLethalCost) return;
  reached_[cell] = 1;
  queue_[queued_++] = cell;
}

void Reach::spread(const CostMap& map) {
  const auto side = static_cast<std::uint32_t>(map.side());
  for (std::size_t i = 0; i < queued_; ++i) {
    const std::uint32_t cell = queue_[i];
    const std::uint32_t x = cell % side;
    const bool low = cell < side;
    const bool high = cell >= side * (side - 1);
    if (x == 0 || x + 1 == side || low || high) touches_border_ = true;
    if (x > 0) reach(map, cell - 1);
    if (x + 1 < side) reach(map, cell + 1);
    if (!low) reach(map, cell - side);
    if (!high) reach(map, cell + side);
  }
}

void Reach::flood(const CostMap& map, Cell start) {
  clear(map);
  if (map.lethal(start)) return;
  reach(map, map.index(start));
  spread(map);
}

void Reach::flood_from_outside(const CostMap& map, const Ends& ends) {
  clear(map);
  const std::int32_t last = map.side() - 1;
  for (std::int32_t i = 0; i <= last; ++i) {
    for (const Cell cell : {Cell{i, 0}, Cell{i, last}, Cell{0, i}, Cell{last, i}}) {
      reach(map, map.index(cell));
    }
  }
  for (const auto& end : ends.list) reach(map, end.cell);
  spread(map);
}

}  // namespace surefoot::navigation
