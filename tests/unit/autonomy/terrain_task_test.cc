// Windows of the map completed and rated in slices.
#include "core/autonomy/terrain_task.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "tests/support/terrain_task_parts.h"

namespace surefoot::autonomy {
namespace {

using tests::terrain_window;

constexpr double kCell_m = tests::kTerrainCell_m;

TerrainConfig config() { return tests::terrain_task_config(); }

std::unique_ptr<TerrainTask> task_with(const TerrainConfig& config) {
  auto task = std::make_unique<TerrainTask>();
  EXPECT_EQ(task->reset(config, kCell_m), Status::kOk);
  return task;
}

// Ticks until the window's map is published.
int finish(TerrainTask& task, const mapping::MapWindow& window) {
  const std::uint64_t maps = task.counters().maps;
  int ticks = 0;
  while (task.counters().maps == maps && ticks < 100'000) {
    if (!task.release(window, window.digest(), 0.3)) break;
    task.run();
    task.publish();
    ++ticks;
  }
  return ticks;
}

TEST(TerrainTask, FillsUnderTheCeilingsAndLeavesTheRestAlone) {
  const auto task = task_with(config());
  const auto seen = terrain_window(3);
  finish(*task, *seen);
  ASSERT_EQ(task->counters().maps, 1u);
  std::uint64_t filled = 0;
  std::uint64_t unknown = 0;
  for (std::size_t i = 0; i < seen->cells.size(); ++i) {
    const mapping::WindowCell& before = seen->cells[i];
    const mapping::WindowCell& after = task->map().ground.cells[i];
    switch (before.state) {
      case mapping::CellState::kBounded:
        ++filled;
        EXPECT_TRUE(after.has_height());
        EXPECT_LE(after.height_m, before.height_m);
        break;
      case mapping::CellState::kUnknown:
        ++unknown;
        EXPECT_FALSE(after.has_height());
        EXPECT_EQ(task->map().cost[i], 0.0f);
        break;
      default: EXPECT_EQ(after.height_m, before.height_m); EXPECT_EQ(task->map().spread_m[i], 0.0f);
    }
    EXPECT_GE(task->map().cost[i], 0.0f);
    EXPECT_LE(task->map().cost[i], 1.0f);
  }
  EXPECT_GT(filled, 100u);
  EXPECT_GT(unknown, 10u);
  EXPECT_EQ(task->counters().filled, filled);
  EXPECT_EQ(task->counters().unknown, unknown);
  EXPECT_GT(*std::max_element(task->map().spread_m.begin(), task->map().spread_m.end()), 0.0f);
}

TEST(TerrainTask, TheSlicesDoNotChangeTheResult) {
  TerrainConfig large = config();
  large.fill_work = 10'000'000;
  large.cost_rows = 100;
  const auto in_slices = task_with(config());
  const auto at_once = task_with(large);
  const auto seen = terrain_window(4);
  const int slices = finish(*in_slices, *seen);
  EXPECT_LT(finish(*at_once, *seen), 10);
  EXPECT_GT(slices, 50);
  EXPECT_EQ(in_slices->map_digest(), at_once->map_digest());
}

TEST(TerrainTask, WithoutFillUnseenCellsAreLeftOut) {
  TerrainConfig off = config();
  off.fill = FillUse::kOff;
  const auto task = task_with(off);
  const auto seen = terrain_window(5);
  finish(*task, *seen);
  EXPECT_EQ(task->counters().filled, 0u);
  for (std::size_t i = 0; i < seen->cells.size(); ++i) {
    EXPECT_EQ(task->map().ground.cells[i].has_height(), seen->cells[i].has_height());
  }
}

TEST(TerrainTask, TakesTheYoungestWindowAndNoneTwice) {
  const auto task = task_with(config());
  const auto first = terrain_window(6);
  const auto second = terrain_window(7);
  const auto third = terrain_window(8);
  ASSERT_TRUE(task->release(*first, first->digest(), 0));
  task->run();
  task->publish();
  // Two are published while the first is in work.
  ASSERT_TRUE(task->release(*second, second->digest(), 0));
  task->run();
  task->publish();
  finish(*task, *third);
  EXPECT_EQ(task->map().ground.frames, 6u);
  finish(*task, *third);
  EXPECT_EQ(task->map().ground.frames, 8u);
  EXPECT_FALSE(task->release(*third, third->digest(), 0));
}

TEST(TerrainTask, AWindowWithNothingMeasuredIsRefusedAndTheOldMapStays) {
  const auto task = task_with(config());
  const auto seen = terrain_window(3);
  finish(*task, *seen);
  const std::uint64_t digest = task->map_digest();
  mapping::MapWindow empty = *seen;
  for (mapping::WindowCell& cell : empty.cells) cell = mapping::WindowCell{};
  ASSERT_TRUE(task->release(empty, empty.digest(), 0));
  task->run();
  task->publish();
  EXPECT_EQ(task->counters().refused, 1u);
  EXPECT_EQ(task->map_digest(), digest);
}

TEST(TerrainTask, RefusesAModelThatDoesNotFit) {
  const auto task = std::make_unique<TerrainTask>();
  EXPECT_EQ(task->reset(TerrainConfig{}, kCell_m), Status::kOk);  // not present: nothing to do
  EXPECT_FALSE(task->enabled());
  EXPECT_EQ(task->reset(config(), 0.015), Status::kInvalid);
  TerrainConfig thin = config();
  EXPECT_EQ(thin.model.rows.resize(2), Status::kOk);
  EXPECT_EQ(task->reset(thin, kCell_m), Status::kInvalid);
  TerrainConfig empty = config();
  empty.model.rows.clear();
  EXPECT_EQ(task->reset(empty, kCell_m), Status::kInvalid);
  EXPECT_FALSE(task->enabled());
}

}  // namespace
}  // namespace surefoot::autonomy
