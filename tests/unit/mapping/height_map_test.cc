#include "core/mapping/height_map.h"

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace surefoot::mapping {
namespace {

constexpr std::int32_t kSide = 24;
using SmallMap = HeightMap<kSide>;
using Reference = std::map<std::pair<std::int32_t, std::int32_t>, float>;

template <std::int32_t kSize>
std::uint64_t digest(const HeightMap<kSize>& map) {
  Fnv64 hash;
  map.add_to(hash);
  return hash.value();
}

MapCell measured(float height) {
  MapCell cell;
  cell.height_m = height;
  cell.stamp_ms = 1;
  cell.state = CellState::kMeasured;
  return cell;
}

TEST(CellCoordinate, OnAndOneUlpBesideEveryBorder) {
  for (const double size : {0.015, 0.02, 0.01, 0.1, 0.013}) {
    for (std::int32_t i = -3000; i <= 3000; ++i) {
      const double border = static_cast<double>(i) * size;
      ASSERT_EQ(cell_coordinate(border, size), i) << size;
      const double below = std::nextafter(border, -1e9);
      ASSERT_EQ(cell_coordinate(below, size), i - 1) << size;
      const double above = std::nextafter(border, 1e9);
      ASSERT_EQ(cell_coordinate(above, size), i) << size;
    }
  }
}

TEST(CellCoordinate, FarFromTheOrigin) {
  for (const double x : {kMaxCoordinate_m, -kMaxCoordinate_m, 12345.678, -98765.4321}) {
    const std::int32_t i = cell_coordinate(x, 0.015);
    EXPECT_LE(i * 0.015, x);
    EXPECT_GT((i + 1) * 0.015, x);
  }
  EXPECT_FALSE(is_mappable(std::nextafter(kMaxCoordinate_m, 1e9)));
  EXPECT_FALSE(is_mappable(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(is_mappable(std::numeric_limits<double>::infinity()));
}

TEST(CellCoordinate, CentreLiesInItsCell) {
  for (std::int32_t i = -2000; i <= 2000; ++i) {
    ASSERT_EQ(cell_coordinate(cell_centre(i, 0.015), 0.015), i);
  }
}

// Positions exactly on, one ulp inside and one ulp outside each edge of the map.
template <class Map>
void expect_edges(const Map& map, double size) {
  const auto inside = [&](double x, double y) { return map.contains(cell_index(x, y, size)); };
  const CellIndex first = map.first();
  const double low_x = first.ix * size;
  const double low_y = first.iy * size;
  const double high_x = (first.ix + Map::side()) * size;
  const double high_y = (first.iy + Map::side()) * size;
  const double mid_x = 0.5 * (low_x + high_x);
  const double mid_y = 0.5 * (low_y + high_y);
  ASSERT_TRUE(inside(low_x, mid_y));
  ASSERT_TRUE(inside(std::nextafter(low_x, 1e9), mid_y));
  ASSERT_FALSE(inside(std::nextafter(low_x, -1e9), mid_y));
  ASSERT_FALSE(inside(high_x, mid_y));
  ASSERT_TRUE(inside(std::nextafter(high_x, -1e9), mid_y));
  ASSERT_FALSE(inside(std::nextafter(high_x, 1e9), mid_y));
  ASSERT_TRUE(inside(mid_x, low_y));
  ASSERT_TRUE(inside(mid_x, std::nextafter(low_y, 1e9)));
  ASSERT_FALSE(inside(mid_x, std::nextafter(low_y, -1e9)));
  ASSERT_FALSE(inside(mid_x, high_y));
  ASSERT_TRUE(inside(mid_x, std::nextafter(high_y, -1e9)));
  ASSERT_FALSE(inside(mid_x, std::nextafter(high_y, 1e9)));
  ASSERT_TRUE(inside(low_x, low_y));
  ASSERT_FALSE(inside(high_x, high_y));
}

// A step of a walk: mostly small, sometimes a jump of about the map's side or far away.
CellIndex random_centre(Random& random, CellIndex from) {
  const std::uint32_t kind = random.below(20);
  const std::uint32_t reach = kind == 0 ? 100000 : (kind < 4 ? 3 * kSide : 5);
  const auto dx = static_cast<std::int32_t>(random.below(2 * reach + 1));
  const auto dy = static_cast<std::int32_t>(random.below(2 * reach + 1));
  const auto shift = static_cast<std::int32_t>(reach);
  if (kind == 0) return {dx - shift, dy - shift};
  return from + CellIndex{dx - shift, dy - shift};
}

void write_some(Random& random, SmallMap& map, Reference& reference) {
  for (int k = 0; k < 8; ++k) {
    const auto dx = static_cast<std::int32_t>(random.below(kSide + 4)) - 2;
    const auto dy = static_cast<std::int32_t>(random.below(kSide + 4)) - 2;
    const CellIndex index = map.first() + CellIndex{dx, dy};
    const auto height = static_cast<float>(random.uniform(-1, 1));
    const bool inside = dx >= 0 && dy >= 0 && dx < kSide && dy < kSide;
    MapCell* cell = map.find(index);
    ASSERT_EQ(cell != nullptr, inside);
    if (!inside) continue;
    *cell = measured(height);
    reference[{index.ix, index.iy}] = height;
  }
}

void forget_outside(const SmallMap& map, Reference& reference) {
  std::erase_if(reference, [&](const auto& item) {
    return !map.contains({item.first.first, item.first.second});
  });
}

void expect_equal(const SmallMap& map, const Reference& reference) {
  std::size_t known = 0;
  for (std::int32_t iy = map.first().iy; iy < map.first().iy + kSide; ++iy) {
    for (std::int32_t ix = map.first().ix; ix < map.first().ix + kSide; ++ix) {
      const MapCell& cell = map.at({ix, iy});
      const auto found = reference.find({ix, iy});
      ASSERT_EQ(cell.state == CellState::kMeasured, found != reference.end());
      if (found == reference.end()) continue;
      ASSERT_EQ(cell.height_m, found->second);
      ++known;
    }
  }
  ASSERT_EQ(known, reference.size());
}

TEST(HeightMap, TenThousandMovesAgainstAReference) {
  auto map = std::make_unique<SmallMap>();
  Reference reference;
  Random random(3);
  CellIndex centre;
  map->reset(centre);
  expect_edges(*map, 0.015);
  for (int move = 0; move < 10000; ++move) {
    write_some(random, *map, reference);
    centre = random_centre(random, centre);
    map->recentre(centre);
    forget_outside(*map, reference);
    ASSERT_EQ(map->first().ix, centre.ix - kSide / 2);
    ASSERT_EQ(map->first().iy, centre.iy - kSide / 2);
    expect_edges(*map, 0.015);
    if (move % 5 == 0) expect_equal(*map, reference);
    if (testing::Test::HasFatalFailure()) return;
  }
}

// The same content reached by walking there and by starting there has the same digest.
TEST(HeightMap, DigestDoesNotKnowTheWay) {
  auto walked = std::make_unique<SmallMap>();
  auto placed = std::make_unique<SmallMap>();
  Random random(5);
  CellIndex centre;
  walked->reset(centre);
  for (int move = 0; move < 200; ++move) {
    centre = random_centre(random, centre);
    walked->recentre(centre);
    placed->reset(centre);
    for (std::int32_t k = 0; k < kSide; ++k) {
      const CellIndex index = walked->first() + CellIndex{k, (k * 7) % kSide};
      *walked->find(index) = measured(0.01F * static_cast<float>(k));
    }
    for (std::int32_t dy = 0; dy < kSide; ++dy) {
      for (std::int32_t dx = 0; dx < kSide; ++dx) {
        const CellIndex index = placed->first() + CellIndex{dx, dy};
        *placed->find(index) = walked->at(index);
      }
    }
    ASSERT_EQ(digest(*walked), digest(*placed));
  }
}

TEST(HeightMap, AroundAgreesWithFind) {
  auto map = std::make_unique<SmallMap>();
  Random random(7);
  CellIndex centre;
  map->reset(centre);
  for (int move = 0; move < 300; ++move) {
    centre = random_centre(random, centre);
    map->recentre(centre);
    const CellIndex anchor =
        map->first() + CellIndex{static_cast<std::int32_t>(random.below(kSide)), 3};
    const SmallMap::Around around(*map, anchor);
    for (std::int32_t dy = -kSide / 2 + 1; dy < kSide / 2; ++dy) {
      for (std::int32_t dx = -kSide / 2 + 1; dx < kSide / 2; ++dx) {
        ASSERT_EQ(around.find(dx, dy), map->find(anchor + CellIndex{dx, dy}));
      }
    }
  }
}

TEST(HeightMap, RowsVisitEveryCellOnceInOrder) {
  auto map = std::make_unique<SmallMap>();
  map->reset({1005, -77});
  std::int32_t expected = map->first().ix;
  map->for_row(map->first().iy + 2, expected, expected + kSide,
               [&](std::int32_t ix, MapCell& cell) {
                 EXPECT_EQ(ix, expected);
                 EXPECT_EQ(&cell, map->find({ix, map->first().iy + 2}));
                 ++expected;
               });
  EXPECT_EQ(expected, map->first().ix + kSide);
}

}  // namespace
}  // namespace surefoot::mapping
