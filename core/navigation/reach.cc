#include "core/navigation/reach.h"

namespace surefoot::navigation {

void Reach::flood(const CostMap& map, Cell start) {
  const auto side = static_cast<std::uint32_t>(map.side());
  for (std::uint32_t i = 0; i < side * side; ++i) reached_[i] = 0;
  touches_border_ = false;
  if (map.lethal(start)) return;
  std::size_t end = 0;
  const auto reach = [&](std::uint32_t cell) {
    if (reached_[cell] != 0 || map.cost(cell) == kLethalCost) return;
    reached_[cell] = 1;
    queue_[end++] = cell;
  };
  reach(map.index(start));
  for (std::size_t i = 0; i < end; ++i) {
    const std::uint32_t cell = queue_[i];
    const std::uint32_t x = cell % side;
    const bool low = cell < side;
    const bool high = cell >= side * (side - 1);
    if (x == 0 || x + 1 == side || low || high) touches_border_ = true;
    if (x > 0) reach(cell - 1);
    if (x + 1 < side) reach(cell + 1);
    if (!low) reach(cell - side);
    if (!high) reach(cell + side);
  }
}

}  // namespace surefoot::navigation
