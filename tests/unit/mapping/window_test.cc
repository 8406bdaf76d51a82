#include "core/mapping/map_window.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/mapping/classifier.h"
#include "core/mapping/foothold.h"
#include "tests/unit/mapping/scene.h"

namespace surefoot::mapping {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kSize = 0.015;

// A window of random heights and classes at an odd place.
std::unique_ptr<MapWindow> random_window(std::uint64_t seed) {
  auto window = std::make_unique<MapWindow>();
  Random random(seed);
  window->cell_size_m = kSize;
  window->first = {static_cast<std::int32_t>(random.below(4000)) - 2000,
                   static_cast<std::int32_t>(random.below(4000)) - 2000};
  for (WindowCell& cell : window->cells) {
    cell.state = static_cast<CellState>(random.below(4));
    if (cell.state == CellState::kUnknown) continue;
    cell.height_m = static_cast<float>(random.uniform(-0.1, 0.1));
    if (!cell.has_height() || random.below(4) != 0) continue;
    cell.traversability = Traversability::kSteppable;
    cell.margin_cells = static_cast<std::uint8_t>(1 + random.below(kMaxMargin_cells));
  }
  return window;
}

TEST(MapWindow, NothingPublishedIsUnavailable) {
  const auto window = std::make_unique<MapWindow>();
  EXPECT_EQ(window->locate(0, 0).status(), Status::kUnavailable);
  EXPECT_EQ(window->height_at(0, 0).status(), Status::kUnavailable);
  EXPECT_EQ(window->max_height_along(0, 0, 1, 1, 0.1).status(), Status::kUnavailable);
  EXPECT_EQ(window->patch(0, 0, 0.1).status(), Status::kUnavailable);
  EXPECT_EQ(find_foothold(*window, FootholdQuery{}).status(), Status::kUnavailable);
}

TEST(MapWindow, EveryBorderOnAndOneUlpBeside) {
  for (std::uint64_t seed = 1; seed < 200; ++seed) {
    const auto window = random_window(seed);
    const double low_x = window->first.ix * kSize;
    const double low_y = window->first.iy * kSize;
    const double high_x = (window->first.ix + kWindowSide) * kSize;
    const double high_y = (window->first.iy + kWindowSide) * kSize;
    const double x = low_x + 0.7;
    const double y = low_y + 0.7;
    ASSERT_TRUE(window->locate(low_x, y).ok());
    ASSERT_EQ(window->locate(std::nextafter(low_x, -1e9), y).status(), Status::kOutOfRange);
    ASSERT_TRUE(window->locate(std::nextafter(high_x, -1e9), y).ok());
    ASSERT_EQ(window->locate(high_x, y).status(), Status::kOutOfRange);
    ASSERT_TRUE(window->locate(x, low_y).ok());
    ASSERT_EQ(window->locate(x, std::nextafter(low_y, -1e9)).status(), Status::kOutOfRange);
    ASSERT_TRUE(window->locate(x, std::nextafter(high_y, -1e9)).ok());
    ASSERT_EQ(window->locate(x, high_y).status(), Status::kOutOfRange);
  }
}

TEST(MapWindow, RefusesWhatIsNotAPosition) {
  const auto window = random_window(1);
  for (const double bad : {kNan, kInf, -kInf}) {
    EXPECT_EQ(window->locate(bad, 0).status(), Status::kInvalid);
    EXPECT_EQ(window->height_at(0, bad).status(), Status::kInvalid);
    EXPECT_EQ(window->max_height_along(0, bad, 0, 0, 0.1).status(), Status::kInvalid);
    EXPECT_EQ(window->max_height_along(0, 0, 0, 0, bad).status(), Status::kInvalid);
    EXPECT_EQ(window->patch(bad, 0, 0.1).status(), Status::kInvalid);
    EXPECT_EQ(window->patch(0, 0, bad).status(), Status::kInvalid);
  }
  EXPECT_EQ(window->locate(1e300, 0).status(), Status::kOutOfRange);
  EXPECT_EQ(window->patch(0, 0, -0.1).status(), Status::kInvalid);
  EXPECT_EQ(window->max_height_along(0, 0, 0, 0, -1e-9).status(), Status::kInvalid);
}

// Straight from the definition, over every cell of the window.
TEST(MapWindow, MaxAlongASegmentAgainstBruteForce) {
  Random random(11);
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto window = random_window(seed);
    const double x0 = window->first.ix * kSize;
    const double y0 = window->first.iy * kSize;
    const Vector2 a{x0 + random.uniform(-0.3, 1.8), y0 + random.uniform(-0.3, 1.8)};
    const Vector2 b{x0 + random.uniform(-0.3, 1.8), y0 + random.uniform(-0.3, 1.8)};
    const double radius = random.uniform(0, 0.1);
    bool found = false;
    double highest = -1e9;
    for (std::int32_t i = 0; i < kWindowSide * kWindowSide; ++i) {
      const CellIndex index = window->first + CellIndex{i % kWindowSide, i / kWindowSide};
      const Vector2 p(cell_centre(index.ix, kSize), cell_centre(index.iy, kSize));
      const double along = std::min(1.0, std::max(0.0, (p - a).dot(b - a) / (b - a).squaredNorm()));
      if ((p - a - along * (b - a)).norm() > radius) continue;
      if (!window->at(index).has_height()) continue;
      found = true;
      highest = std::max(highest, static_cast<double>(window->at(index).height_m));
    }
    const auto result = window->max_height_along(a.x(), a.y(), b.x(), b.y(), radius);
    ASSERT_EQ(result.ok(), found) << seed;
    if (found) {
      ASSERT_EQ(result.value(), highest) << seed;
    }
  }
}

TEST(MapWindow, PatchCountsCellsOutsideAsUnknown) {
  auto window = random_window(4);
  for (WindowCell& cell : window->cells) {
    cell.state = CellState::kMeasured;
    cell.height_m = 0.25F;
  }
  const double x = window->first.ix * kSize;
  const double y = window->first.iy * kSize;
  const auto corner = window->patch(x, y, 0.3).value();
  EXPECT_EQ(corner.cells, 4 * corner.known);
  EXPECT_NEAR(corner.cells, 3.14159 * 400, 10);
  EXPECT_EQ(corner.min_m, 0.25);
  EXPECT_EQ(corner.max_m, 0.25);
  EXPECT_EQ(corner.mean_m, 0.25);
  const auto outside = window->patch(x - 1, y - 1, 0.3).value();
  EXPECT_EQ(outside.known, 0u);
}

TEST(MapWindow, DigestSeesEveryField) {
  const auto window = random_window(2);
  const std::uint64_t before = window->digest();
  auto copy = std::make_unique<MapWindow>(*window);
  EXPECT_EQ(copy->digest(), before);
  copy->cells[9999].height_m += 1e-6F;
  EXPECT_NE(copy->digest(), before);
  *copy = *window;
  copy->cells[17].bridged = !copy->cells[17].bridged;
  EXPECT_NE(copy->digest(), before);
  *copy = *window;
  ++copy->first.iy;
  EXPECT_NE(copy->digest(), before);
}

// ---- foothold search ----

struct Candidate {
  bool found = false;
  double cost = 0;
};

double cost_of(const WindowCell& cell, const FootholdQuery& query, double distance) {
  return distance + query.margin_weight_m * (kMaxMargin_cells - cell.margin_cells);
}

double distance_to(const FootholdQuery& query, CellIndex index) {
  const bool own = index == cell_index(query.x_O_m, query.y_O_m, kSize);
  if (own) return 0;
  return std::hypot(cell_centre(index.ix, kSize) - query.x_O_m,
                    cell_centre(index.iy, kSize) - query.y_O_m);
}

bool in_reach(const FootholdQuery& query, CellIndex index) {
  const bool own = index == cell_index(query.x_O_m, query.y_O_m, kSize);
  const double x = own ? query.x_O_m : cell_centre(index.ix, kSize);
  const double y = own ? query.y_O_m : cell_centre(index.iy, kSize);
  return std::hypot(x - query.reach_x_O_m, y - query.reach_y_O_m) <= query.reach_m;
}

Candidate brute_force(const MapWindow& window, const FootholdQuery& query) {
  Candidate best;
  for (std::int32_t i = 0; i < kWindowSide * kWindowSide; ++i) {
    const CellIndex index = window.first + CellIndex{i % kWindowSide, i / kWindowSide};
    const WindowCell& cell = window.at(index);
    if (cell.traversability != Traversability::kSteppable) continue;
    const double distance = distance_to(query, index);
    if (distance > query.max_radius_m || !in_reach(query, index)) continue;
    const double cost = cost_of(cell, query, distance);
    if (!best.found || cost < best.cost) best = {true, cost};
  }
  return best;
}

TEST(FindFoothold, AgreesWithBruteForce) {
  Random random(21);
  int found = 0;
  int none = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    auto window = random_window(static_cast<std::uint64_t>(trial));
    const std::uint32_t keep = 1 + random.below(60);  // thin the steppable cells to a share
    for (WindowCell& cell : window->cells) {
      if (random.below(keep) != 0) cell.traversability = Traversability::kUnsteppable;
    }
    FootholdQuery query;
    query.x_O_m = window->first.ix * kSize + random.uniform(-0.2, 1.7);
    query.y_O_m = window->first.iy * kSize + random.uniform(-0.2, 1.7);
    query.max_radius_m = random.uniform(0, 0.3);
    query.reach_x_O_m = query.x_O_m + random.uniform(-0.1, 0.1);
    query.reach_y_O_m = query.y_O_m + random.uniform(-0.1, 0.1);
    query.reach_m = random.uniform(0.01, 0.4);
    query.margin_weight_m = trial % 2 == 0 ? 0 : random.uniform(0, 0.02);
    const Candidate expected = brute_force(*window, query);
    const auto result = find_foothold(*window, query);
    ASSERT_EQ(result.ok(), expected.found) << trial;
    if (!result.ok()) {
      ASSERT_EQ(result.status(), Status::kNotFound);
      ++none;
      continue;
    }
    ++found;
    const Foothold& foothold = result.value();
    ASSERT_TRUE(window->contains(foothold.cell));
    ASSERT_EQ(window->at(foothold.cell).traversability, Traversability::kSteppable);
    ASSERT_EQ(cell_index(foothold.x_O_m, foothold.y_O_m, kSize), foothold.cell);
    ASSERT_LE(foothold.distance_m, query.max_radius_m);
    ASSERT_NEAR(cost_of(window->at(foothold.cell), query, foothold.distance_m), expected.cost,
                1e-12);
    if (!foothold.moved) {
      ASSERT_EQ(foothold.x_O_m, query.x_O_m);
      ASSERT_EQ(foothold.y_O_m, query.y_O_m);
    }
  }
  EXPECT_GT(found, 300);
  EXPECT_GT(none, 300);
}

TEST(FindFoothold, EveryCornerOfTheWindow) {
  auto window = random_window(5);
  for (WindowCell& cell : window->cells) cell.traversability = Traversability::kUnsteppable;
  const double low_x = window->first.ix * kSize;
  const double low_y = window->first.iy * kSize;
  for (const double x : {low_x, low_x + kWindowSide * kSize}) {
    for (const double y : {low_y, low_y + kWindowSide * kSize}) {
      for (const double dx : {-0.1, -1e-12, 0.0, 1e-12, 0.1}) {
        FootholdQuery query;
        query.x_O_m = x + dx;
        query.y_O_m = y - dx;
        query.max_radius_m = 0.3;
        EXPECT_EQ(find_foothold(*window, query).status(), Status::kNotFound);
      }
    }
  }
}

TEST(FindFoothold, RefusesBadQueries) {
  const auto window = random_window(6);
  FootholdQuery query;
  query.max_radius_m = 0.1;
  query.x_O_m = kNan;
  EXPECT_EQ(find_foothold(*window, query).status(), Status::kInvalid);
  query.x_O_m = 0;
  query.reach_y_O_m = kInf;
  EXPECT_EQ(find_foothold(*window, query).status(), Status::kInvalid);
  query.reach_y_O_m = 0;
  query.max_radius_m = -1;
  EXPECT_EQ(find_foothold(*window, query).status(), Status::kInvalid);
  query.max_radius_m = 0.3000001;
  EXPECT_EQ(find_foothold(*window, query).status(), Status::kOutOfRange);
  query.max_radius_m = 0.1;
  query.x_O_m = 1e6;
  EXPECT_EQ(find_foothold(*window, query).status(), Status::kOutOfRange);
}

// ---- classes ----

class Classes : public testing::Test {
 protected:
  Classes() { map_->reset({0, 0}); }

  void fill(std::int32_t reach, double slope_x) {
    for (std::int32_t iy = -reach; iy <= reach; ++iy) {
      for (std::int32_t ix = -reach; ix <= reach; ++ix) set({ix, iy}, slope_x * ix * kSize);
    }
  }
  void set(CellIndex index, double height, CellState state = CellState::kMeasured) {
    MapCell& cell = *map_->find(index);
    cell = MapCell{};
    cell.height_m = static_cast<float>(height);
    cell.state = state;
  }
  void run(CellIndex centre, MapWindow& window) {
    classifier_->reset(config_, test::limits_of(config_));
    classifier_->run(*map_, centre, window);
  }
  const WindowCell& classified(CellIndex index) {
    run({0, 0}, *window_);
    return window_->at(index);
  }

  MappingConfig config_ = test::recommended_config();
  std::unique_ptr<ControlMap> map_ = std::make_unique<ControlMap>();
  std::unique_ptr<WindowClassifier> classifier_ = std::make_unique<WindowClassifier>();
  std::unique_ptr<MapWindow> window_ = std::make_unique<MapWindow>();
};

TEST_F(Classes, FlatMeasuredAndAssumedGroundBearsAFoot) {
  fill(10, 0);
  EXPECT_EQ(classified({0, 0}).traversability, Traversability::kSteppable);
  EXPECT_EQ(classified({0, 0}).margin_cells, kMaxMargin_cells);
  set({0, 0}, 0, CellState::kAssumed);
  EXPECT_EQ(classified({0, 0}).traversability, Traversability::kSteppable);
}

TEST_F(Classes, UnknownAndBoundedNeverDo) {
  run({0, 0}, *window_);
  for (const WindowCell& cell : window_->cells) {
    ASSERT_EQ(cell.traversability, Traversability::kUnknown);
  }
  for (std::int32_t iy = -60; iy <= 60; ++iy) {
    for (std::int32_t ix = -60; ix <= 60; ++ix) set({ix, iy}, 0, CellState::kBounded);
  }
  run({0, 0}, *window_);
  for (const WindowCell& cell : window_->cells) {
    ASSERT_EQ(cell.traversability, Traversability::kUnknown);
    ASSERT_FALSE(cell.has_height());
  }
}

TEST_F(Classes, SlopeLimit) {
  fill(12, 0.35);
  EXPECT_EQ(classified({0, 0}).traversability, Traversability::kSteppable);
  fill(12, 0.36);
  EXPECT_EQ(classified({0, 0}).traversability, Traversability::kUnsteppable);
}

// A plane's slope is found where up to the allowed number of cells is missing.
TEST_F(Classes, SlopeWithMissingCells) {
  config_.bridge_holes = false;
  fill(12, 0.34);
  set({1, 0}, 0, CellState::kUnknown);
  set({-2, 0}, 0, CellState::kUnknown);
  set({0, 2}, 0, CellState::kUnknown);
  EXPECT_EQ(classified({0, 0}).traversability, Traversability::kSteppable);
  set({0, 1}, 0, CellState::kUnknown);  // a fourth
  EXPECT_EQ(classified({0, 0}).traversability, Traversability::kUnknown);
}

TEST_F(Classes, StepsOnEitherSideAreKeptAway) {
  fill(12, 0);
  for (std::int32_t iy = -12; iy <= 12; ++iy) {
    for (std::int32_t ix = 3; ix <= 12; ++ix) set({ix, iy}, 0.05);
  }
  EXPECT_EQ(classified({0, 0}).traversability, Traversability::kSteppable);
  EXPECT_EQ(classified({0, 0}).margin_cells, 1);
  for (std::int32_t ix = 1; ix <= 4; ++ix) {
    EXPECT_EQ(classified({ix, 0}).traversability, Traversability::kUnsteppable) << ix;
  }
  EXPECT_EQ(classified({5, 0}).traversability, Traversability::kSteppable);
}

// Ledges of several heights across the window: what the step height (0.12 m here) and the jump
// (0.27 m) allow. Up and down are the same ledge.
TEST_F(Classes, LedgesByHeight) {
  const auto at_the_ledge = [this](double height) {
    fill(12, 0);
    for (std::int32_t iy = -12; iy <= 12; ++iy) {
      for (std::int32_t ix = 1; ix <= 12; ++ix) set({ix, iy}, height);
    }
    const Traversability below = classified({0, 0}).traversability;
    EXPECT_EQ(classified({1, 0}).traversability, below) << height;
    EXPECT_EQ(classified({-4, 0}).traversability, Traversability::kSteppable) << height;
    EXPECT_EQ(classified({5, 0}).traversability, Traversability::kSteppable) << height;
    return below;
  };
  EXPECT_EQ(at_the_ledge(0.01), Traversability::kSteppable);
  EXPECT_EQ(at_the_ledge(0.05), Traversability::kUnsteppable);
  EXPECT_EQ(at_the_ledge(0.10), Traversability::kUnsteppable);
  EXPECT_EQ(at_the_ledge(0.13), Traversability::kJumpOnly);
  EXPECT_EQ(at_the_ledge(-0.13), Traversability::kJumpOnly);
  EXPECT_EQ(at_the_ledge(0.25), Traversability::kJumpOnly);
  EXPECT_EQ(at_the_ledge(0.30), Traversability::kImpassable);
}

TEST_F(Classes, OneHoleIsBridgedAndFlaggedTwoAreNot) {
  fill(10, 0);
  set({0, 0}, 0, CellState::kUnknown);
  EXPECT_TRUE(classified({0, 0}).bridged);
  EXPECT_TRUE(classified({0, 0}).has_height());
  EXPECT_EQ(classified({0, 0}).state, CellState::kUnknown);
  EXPECT_EQ(classified({0, 0}).traversability, Traversability::kSteppable);
  EXPECT_EQ(map_->at({0, 0}).state, CellState::kUnknown);
  set({1, 0}, 0, CellState::kUnknown);
  EXPECT_FALSE(classified({0, 0}).bridged);
  EXPECT_EQ(classified({0, 0}).traversability, Traversability::kUnknown);
}

TEST_F(Classes, ABridgeStaysBelowTheCeiling) {
  fill(10, 0);
  set({0, 0}, -0.03, CellState::kBounded);
  EXPECT_TRUE(classified({0, 0}).bridged);
  EXPECT_EQ(classified({0, 0}).height_m, -0.03F);
  EXPECT_NE(classified({0, 0}).traversability, Traversability::kSteppable);
}

// The class of a cell depends on the map, not on where the window ends.
TEST_F(Classes, WindowBorderIsInvisible) {
  Random random(9);
  for (std::int32_t iy = -120; iy <= 120; ++iy) {
    for (std::int32_t ix = -120; ix <= 120; ++ix) {
      if (random.below(40) != 0) set({ix, iy}, random.uniform(0, 0.012) + (ix / 30) * 0.05);
    }
  }
  auto other = std::make_unique<MapWindow>();
  run({0, 0}, *window_);
  run({33, -41}, *other);
  int compared = 0;
  for (std::int32_t i = 0; i < kWindowSide * kWindowSide; ++i) {
    const CellIndex index = window_->first + CellIndex{i % kWindowSide, i / kWindowSide};
    const WindowCell* cell = other->find(index);
    if (cell == nullptr) continue;
    ASSERT_EQ(cell->traversability, window_->at(index).traversability);
    ASSERT_EQ(cell->margin_cells, window_->at(index).margin_cells);
    ASSERT_EQ(cell->height_m, window_->at(index).height_m);
    ++compared;
  }
  EXPECT_EQ(compared, (100 - 33) * (100 - 41));
}

}  // namespace
}  // namespace surefoot::mapping
