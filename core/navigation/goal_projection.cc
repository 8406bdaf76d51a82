#include "core/navigation/goal_projection.h"

#include "core/math/elementary.h"

namespace surefoot::navigation {

void goal_ends(const CostMap& map, const Vector2& goal_O_m, double moved_m, Ends& ends) {
  ends.list.clear();
  ends.towards = map.cell_of(goal_O_m);
  if (!map.inside(ends.towards)) return;
  Cell cell = ends.towards;
  if (map.lethal(cell)) {
    const std::int32_t rings = math::floor_of(moved_m / map.cell_m()) + 2;
    if (!map.nearest_free(ends.towards, rings, cell)) return;
    const Vector2 moved = map.centre_of_O_m(cell) - goal_O_m;
    if (moved.squaredNorm() > math::square(moved_m + map.cell_m())) return;
    ends.towards = cell;
  }
  static_cast<void>(ends.list.push_back({map.index(cell), 0}));
}

void border_ends(const CostMap& map, const Vector2& goal_O_m, const WayField* field,
                 const Reach* reach, Ends& ends) {
  ends.list.clear();
  ends.towards = map.cell_of(goal_O_m);
  const std::int32_t side = map.side();
  const auto add = [&](Cell cell) {
    if (map.lethal(cell) || (reach != nullptr && !reach->contains(map.index(cell)))) return;
    std::uint32_t cost = octile(cell, ends.towards) * kFreeCost;
    if (field != nullptr) cost = field->cost_at(map.centre_of_O_m(cell));
    if (cost == WayField::kUnreachable || cost >= kMaxReachable) return;
    static_cast<void>(ends.list.push_back({map.index(cell), cost}));
  };
  for (std::int32_t i = 0; i < side; ++i) {
    add({i, 0});
    add({i, side - 1});
    if (i == 0 || i == side - 1) continue;
    add({0, i});
    add({side - 1, i});
  }
}

}  // namespace surefoot::navigation
