#include "core/navigation/grid_search.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/base/random.h"
#include "core/navigation/goal_projection.h"
#include "tests/support/samples.h"

namespace surefoot::navigation {
namespace {

struct Case {
  std::unique_ptr<CostMap> map = std::make_unique<CostMap>();
  Cell start;
  Ends ends;
};

Case random_case(Random& random, std::int32_t side) {
  Case made;
  made.map->resize(side, 0.2);
  made.map->clear(Vector2::Zero());
  const double lethal = random.uniform(0.0, 0.45);
  const bool uniform = random.below(2) == 0;
  for (std::int32_t y = 0; y < side; ++y) {
    for (std::int32_t x = 0; x < side; ++x) {
      const bool blocked = random.uniform() < lethal;
      const auto cost = static_cast<std::uint16_t>(kMinCost + random.below(kMaxCost - kMinCost));
      if (!uniform) made.map->set_cost({x, y}, cost);
      if (blocked) made.map->set_cost({x, y}, kLethalCost);
    }
  }
  const auto any = [&] {
    return static_cast<std::int32_t>(random.below(static_cast<std::uint32_t>(side)));
  };
  made.start.x = any();
  made.start.y = any();
  Cell goal;
  goal.x = any();
  goal.y = any();
  if (random.below(3) == 0) {
    goal.x += 3 * side;
    border_ends(*made.map, made.map->centre_of_O_m(goal), nullptr, nullptr, made.ends);
  } else {
    goal_ends(*made.map, made.map->centre_of_O_m(goal), 10.0, made.ends);
  }
  return made;
}

// Bellman-Ford, as plain as can be: until nothing changes.
std::uint64_t exhaustive(const Case& c) {
  const CostMap& map = *c.map;
  const std::int32_t side = map.side();
  std::vector<std::uint64_t> cost(static_cast<std::size_t>(side * side), UINT64_MAX);
  cost[map.index(c.start)] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::int32_t i = 0; i < side * side; ++i) {
      const Cell at = map.cell(static_cast<std::uint32_t>(i));
      if (cost[map.index(at)] == UINT64_MAX) continue;
      for (std::int32_t k = 0; k < 9; ++k) {
        const Cell to{at.x + k % 3 - 1, at.y + k / 3 - 1};
        if (to == at || map.lethal(to)) continue;
        const bool across = to.x != at.x && to.y != at.y;
        if (across && (map.lethal({to.x, at.y}) || map.lethal({at.x, to.y}))) continue;
        const std::uint64_t there =
            cost[map.index(at)] + std::uint64_t{map.cost(to)} * (across ? 14 : 10);
        if (there < cost[map.index(to)]) {
          cost[map.index(to)] = there;
          changed = true;
        }
      }
    }
  }
  std::uint64_t best = UINT64_MAX;
  for (const End& end : c.ends.list) {
    if (cost[end.cell] != UINT64_MAX) best = std::min(best, cost[end.cell] + end.cost);
  }
  return best;
}

std::uint64_t path_cost(const CostMap& map, const RawPath& path) {
  std::uint64_t sum = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Cell from = map.cell_of(path[i - 1]);
    const Cell to = map.cell_of(path[i]);
    EXPECT_FALSE(map.lethal(to));
    EXPECT_LE(std::abs(to.x - from.x), 1);
    EXPECT_LE(std::abs(to.y - from.y), 1);
    sum += std::uint64_t{map.cost(to)} * (from.x != to.x && from.y != to.y ? 14 : 10);
  }
  return sum;
}

TEST(GridSearch, CostsWhatAnExhaustiveSearchFindsOnEveryMap) {
  Random random(1);
  const auto search = std::make_unique<GridSearch>();
  const auto path = std::make_unique<RawPath>();
  int found = 0;
  for (int i = 0; i < tests::samples(10'000, 200); ++i) {
    const auto side = static_cast<std::int32_t>(20 + random.below(20));
    const Case c = random_case(random, side);
    const std::uint64_t wanted = exhaustive(c);
    const SearchResult result = search->search(*c.map, c.start, c.ends, *path);
    ASSERT_EQ(result.found, wanted != UINT64_MAX) << "map " << i;
    if (!result.found) continue;
    ++found;
    ASSERT_EQ(result.cost, wanted) << "map " << i;
    std::uint64_t rest = 0;
    for (const End& end : c.ends.list) {
      if (end.cell == result.end_cell) rest = end.cost;
    }
    ASSERT_EQ(path_cost(*c.map, *path) + rest, wanted);
    ASSERT_EQ(c.map->cell_of((*path)[0]), c.start);
  }
  EXPECT_GT(found, tests::samples(800, 80));
}

TEST(Reach, HoldsWhatASearchFinds) {
  Random random(2);
  const auto search = std::make_unique<GridSearch>();
  const auto path = std::make_unique<RawPath>();
  const auto reach = std::make_unique<Reach>();
  int found = 0;
  for (int i = 0; i < tests::samples(300, 50); ++i) {
    const Case c = random_case(random, 30);
    if (c.ends.list.size() != 1 || c.map->lethal(c.start)) continue;
    reach->flood(*c.map, c.start);
    const SearchResult result = search->search(*c.map, c.start, c.ends, *path);
    ASSERT_EQ(reach->contains(c.ends.list[0].cell), result.found) << "map " << i;
    if (result.found) ++found;
  }
  EXPECT_GT(found, 10);
}

TEST(GridSearch, GivesThePathToTheBestCellWhenABoundIsMet) {
  const auto search = std::make_unique<GridSearch>();
  const auto path = std::make_unique<RawPath>();
  CostMap* map = nullptr;
  const auto owned = std::make_unique<CostMap>();
  map = owned.get();
  map->resize(100, 0.2);
  map->clear(Vector2::Zero());
  Ends ends;
  goal_ends(*map, map->centre_of_O_m({90, 50}), 0, ends);
  const SearchResult result = search->search(*map, {10, 50}, ends, *path, 40);
  EXPECT_TRUE(result.partial);
  EXPECT_FALSE(result.found);
  EXPECT_EQ(result.closed, 40u);
  EXPECT_GT(map->cell_of(path->back()).x, 30);
}

TEST(GoalProjection, MovesAGoalOnLethalGroundToTheNearestFreeCell) {
  const auto map = std::make_unique<CostMap>();
  map->resize(50, 0.2);
  map->clear(Vector2::Zero());
  for (std::int32_t y = 20; y < 25; ++y) map->set_cost({30, y}, kLethalCost);
  Ends ends;
  goal_ends(*map, map->centre_of_O_m({30, 22}), 1.0, ends);
  ASSERT_EQ(ends.list.size(), 1u);
  EXPECT_EQ(map->cell(ends.list[0].cell), (Cell{29, 22}));
  goal_ends(*map, Vector2(100, 0), 1.0, ends);
  EXPECT_TRUE(ends.list.empty());
}

TEST(GoalProjection, ChoosesTheBorderCellByTheWholeWay) {
  const auto map = std::make_unique<CostMap>();
  map->resize(50, 0.2);
  map->clear(Vector2::Zero());
  // A wall before the border, open at its low end only.
  for (std::int32_t y = 5; y < 50; ++y) map->set_cost({45, y}, kLethalCost);
  Ends ends;
  border_ends(*map, Vector2(50, 0), nullptr, nullptr, ends);
  const auto search = std::make_unique<GridSearch>();
  const auto path = std::make_unique<RawPath>();
  const SearchResult result = search->search(*map, {25, 25}, ends, *path);
  ASSERT_TRUE(result.found);
  EXPECT_EQ(map->cell(result.end_cell).x, 49);
}

}  // namespace
}  // namespace surefoot::navigation
