// What is known about cells, and how windows of the map become grids.
#include "core/terrain/terrain_grid.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>

namespace surefoot::terrain {
namespace {

TEST(TerrainGrid, CeilingsTightenAndNeverLoosen) {
  const auto grid = std::make_unique<TerrainGrid>();
  ASSERT_EQ(grid->reset(4, 3, 0.01), Status::kOk);
  const std::size_t i = grid->index(2, 1);
  EXPECT_EQ(i, 6u);
  grid->bound(i, 0.5f);
  EXPECT_EQ(grid->knowledge[i], Knowledge::kBounded);
  grid->bound(i, 0.7f);
  EXPECT_EQ(grid->value_m[i], 0.5f);
  grid->bound(i, -0.25f);
  EXPECT_EQ(grid->value_m[i], -0.25f);
  grid->measure(i, -0.5f);
  grid->bound(i, -0.75f);
  EXPECT_EQ(grid->knowledge[i], Knowledge::kMeasured);
  EXPECT_EQ(grid->value_m[i], -0.5f);
}

TEST(TerrainGrid, RefusesSizesItCannotHoldAndStaysAsItWas) {
  const auto grid = std::make_unique<TerrainGrid>();
  ASSERT_EQ(grid->reset(kMaxSide, kMaxSide, 0.005, {-5, 9}), Status::kOk);
  grid->measure(kMaxCells - 1, 1.0f);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(grid->reset(0, 3, 0.01), Status::kInvalid);
  EXPECT_EQ(grid->reset(3, kMaxSide + 1, 0.01), Status::kInvalid);
  EXPECT_EQ(grid->reset(3, 3, nan), Status::kInvalid);
  EXPECT_EQ(grid->reset(3, 3, 0.0), Status::kInvalid);
  EXPECT_EQ(grid->reset(3, 3, 1.5), Status::kInvalid);
  EXPECT_EQ(grid->reset(3, 3, 0.01, {2'000'000'000, 0}), Status::kInvalid);
  EXPECT_EQ(grid->columns, kMaxSide);
  EXPECT_EQ(grid->first, (mapping::CellIndex{-5, 9}));
  EXPECT_EQ(grid->value_m[kMaxCells - 1], 1.0f);
  ASSERT_EQ(grid->reset(2, 2, 0.01), Status::kOk);
  EXPECT_EQ(grid->knowledge[kMaxCells - 1], Knowledge::kUnknown);
}

TEST(TerrainGrid, WindowOfTheMapKeepsHeightsCeilingsAndIgnorance) {
  const auto window = std::make_unique<mapping::MapWindow>();
  const auto grid = std::make_unique<TerrainGrid>();
  ASSERT_EQ(grid->reset(3, 3, 0.5), Status::kOk);
  EXPECT_EQ(load(*window, *grid), Status::kUnavailable);
  EXPECT_EQ(grid->columns, 3);
  window->cell_size_m = 0.015;
  window->first = {-40, 12};
  window->cells[0] = {.height_m = 0.1f, .state = mapping::CellState::kMeasured};
  window->cells[1] = {.height_m = 0.2f, .state = mapping::CellState::kAssumed};
  window->cells[2] = {.height_m = 0.3f, .state = mapping::CellState::kBounded};
  window->cells[103] = {.height_m = 0.4f, .state = mapping::CellState::kBounded, .bridged = true};
  ASSERT_EQ(load(*window, *grid), Status::kOk);
  EXPECT_EQ(grid->columns, mapping::kWindowSide);
  EXPECT_EQ(grid->rows, mapping::kWindowSide);
  EXPECT_EQ(grid->cell_m, 0.015);
  EXPECT_EQ(grid->first, (mapping::CellIndex{-40, 12}));
  EXPECT_EQ(grid->knowledge[0], Knowledge::kMeasured);
  EXPECT_EQ(grid->knowledge[1], Knowledge::kMeasured);
  EXPECT_EQ(grid->value_m[1], 0.2f);
  EXPECT_EQ(grid->knowledge[2], Knowledge::kBounded);
  EXPECT_EQ(grid->value_m[2], 0.3f);
  EXPECT_EQ(grid->knowledge[3], Knowledge::kUnknown);
  EXPECT_EQ(grid->knowledge[grid->index(3, 1)], Knowledge::kMeasured);
}

}  // namespace
}  // namespace surefoot::terrain
