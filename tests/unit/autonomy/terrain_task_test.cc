// Windows of the map completed and rated in slices.
#include "core/autonomy/terrain_task.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "tests/support/terrain_parts.h"

namespace surefoot::autonomy {
namespace {

constexpr double kCell_m = 0.01;
constexpr std::int32_t kSide = mapping::kWindowSide;

TerrainConfig config() {
  TerrainConfig config;
  config.present = true;
  config.fill = FillUse::kOn;
  config.fill_work = 5000;
  config.cost_rows = 10;
  config.synthesis = tests::some_fill();
  config.synthesis.weight_deviation = 0.4;
  config.cost.radius_cells = {1, 2, 4};
  for (terrain::FeatureCost* feature : {&config.cost.slope, &config.cost.height_difference,
                                        &config.cost.deviation, &config.cost.roughness}) {
    feature->scale.fill(0.05);
    feature->weight.fill(1.0);
  }
  terrain::TerrainModel& model = config.model;
  model.cell_m = kCell_m;
  const std::vector<float> heights = tests::rough_heights(77, 100, 40);
  EXPECT_EQ(model.rows.resize(40), Status::kOk);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    model.rows[i / 100].heights_m[i % 100] = static_cast<double>(heights[i]);
  }
  model.prior_constant = -0.01;
  return config;
}

// A scene of the terrain tests as a window.
std::unique_ptr<mapping::MapWindow> window(std::uint64_t seed) {
  auto grid = std::make_unique<terrain::TerrainGrid>();
  tests::make_scene(seed, kSide, kSide, kCell_m, *grid);
  auto window = std::make_unique<mapping::MapWindow>();
  window->cell_size_m = kCell_m;
  window->first = grid->first;
  window->frames = seed;
  for (std::size_t i = 0; i < window->cells.size(); ++i) {
    mapping::WindowCell& cell = window->cells[i];
    cell.height_m = grid->value_m[i];
    if (grid->knowledge[i] == terrain::Knowledge::kMeasured) {
      cell.state = mapping::CellState::kMeasured;
    } else if (grid->knowledge[i] == terrain::Knowledge::kBounded) {
      cell.state = mapping::CellState::kBounded;
    }
  }
  return window;
}

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
  const auto seen = window(3);
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
  const auto seen = window(4);
  const int slices = finish(*in_slices, *seen);
  EXPECT_LT(finish(*at_once, *seen), 10);
  EXPECT_GT(slices, 50);
  EXPECT_EQ(in_slices->map_digest(), at_once->map_digest());
}

TEST(TerrainTask, WithoutFillUnseenCellsAreLeftOut) {
  TerrainConfig off = config();
  off.fill = FillUse::kOff;
  const auto task = task_with(off);
  const auto seen = window(5);
  finish(*task, *seen);
  EXPECT_EQ(task->counters().filled, 0u);
  for (std::size_t i = 0; i < seen->cells.size(); ++i) {
    EXPECT_EQ(task->map().ground.cells[i].has_height(), seen->cells[i].has_height());
  }
}

TEST(TerrainTask, TakesTheYoungestWindowAndNoneTwice) {
  const auto task = task_with(config());
  const auto first = window(6);
  const auto second = window(7);
  const auto third = window(8);
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
  const auto seen = window(3);
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
  TerrainTask task;
  EXPECT_EQ(task.reset(TerrainConfig{}, kCell_m), Status::kOk);  // not present: nothing to do
  EXPECT_FALSE(task.enabled());
  EXPECT_EQ(task.reset(config(), 0.015), Status::kInvalid);
  TerrainConfig thin = config();
  EXPECT_EQ(thin.model.rows.resize(2), Status::kOk);
  EXPECT_EQ(task.reset(thin, kCell_m), Status::kInvalid);
  TerrainConfig empty = config();
  empty.model.rows.clear();
  EXPECT_EQ(task.reset(empty, kCell_m), Status::kInvalid);
  EXPECT_FALSE(task.enabled());
}

}  // namespace
}  // namespace surefoot::autonomy
