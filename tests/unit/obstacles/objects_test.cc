#include "core/obstacles/objects.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <set>
#include <vector>

#include "core/base/random.h"
#include "tests/support/samples.h"
#include "tests/unit/obstacles/windows.h"

namespace surefoot::obstacles {
namespace {

using mapping::MapWindow;
using mapping::Traversability;
using test::cell;
using test::kSide;

constexpr BlockingRule kClassesOnly{.jump_only = true, .min_rise_m = 100.0};

// Joins every pair of blocked neighbours until nothing changes: slow and plain.
std::vector<std::set<std::size_t>> brute_force(const std::vector<bool>& blocked) {
  std::vector<std::size_t> group(blocked.size());
  for (std::size_t i = 0; i < group.size(); ++i) group[i] = i;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::int32_t y = 0; y < kSide; ++y) {
      for (std::int32_t x = 0; x < kSide; ++x) {
        for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}, {1, 1}, {-1, 1}}) {
          const std::int32_t nx = x + dx;
          const std::int32_t ny = y + dy;
          if (nx < 0 || nx >= kSide || ny >= kSide) continue;
          const auto a = static_cast<std::size_t>(y * kSide + x);
          const auto b = static_cast<std::size_t>(ny * kSide + nx);
          if (!blocked[a] || !blocked[b] || group[a] == group[b]) continue;
          group[a] = group[b] = std::min(group[a], group[b]);
          changed = true;
        }
      }
    }
  }
  std::map<std::size_t, std::set<std::size_t>> sets;
  for (std::size_t i = 0; i < blocked.size(); ++i) {
    if (blocked[i]) sets[group[i]].insert(i);
  }
  std::vector<std::set<std::size_t>> result;
  for (auto& [first, members] : sets) result.push_back(std::move(members));
  return result;
}

TEST(Objects, AreTheConnectedSetsThatBruteForceFinds) {
  const auto window = std::make_unique<MapWindow>();
  const auto finder = std::make_unique<ObjectFinder>();
  Random random(11);
  for (int sample = 0; sample < tests::samples(60, 3); ++sample) {
    test::make_level(*window);
    const double density = random.uniform(0.02, 0.6);
    std::vector<bool> blocked(kWindowCells);
    for (std::size_t i = 0; i < kWindowCells; ++i) {
      blocked[i] = random.uniform() < density;
      const bool jump = random.below(2) == 0;
      if (!blocked[i]) continue;
      window->cells[i].traversability =
          jump ? Traversability::kJumpOnly : Traversability::kImpassable;
    }
    const std::size_t min_cells = 1 + random.below(5);
    finder->find(*window, kClassesOnly, min_cells);
    std::size_t objects = 0;
    std::size_t small = 0;
    std::vector<std::uint16_t> expected(kWindowCells, 0);
    for (const auto& members : brute_force(blocked)) {
      if (members.size() < min_cells) {
        ++small;
        continue;
      }
      ++objects;
      for (const std::size_t i : members) expected[i] = static_cast<std::uint16_t>(objects);
    }
    ASSERT_EQ(finder->objects(), objects);
    ASSERT_EQ(finder->too_small(), small);
    for (std::size_t i = 0; i < kWindowCells; ++i) ASSERT_EQ(finder->label(i), expected[i]) << i;
  }
}

TEST(Objects, AWholeWindowIsOneAndNeverPublishedHasNone) {
  const auto window = std::make_unique<MapWindow>();
  const auto finder = std::make_unique<ObjectFinder>();
  for (auto& one : window->cells) one.traversability = Traversability::kImpassable;
  finder->find(*window, kClassesOnly, 1);
  EXPECT_EQ(finder->objects(), 0U);
  window->cell_size_m = test::kCell_m;
  finder->find(*window, kClassesOnly, kWindowCells);
  EXPECT_EQ(finder->objects(), 1U);
  EXPECT_EQ(finder->label(0), 1);
  EXPECT_EQ(finder->label(kWindowCells - 1), 1);
}

TEST(Objects, AMissionThatJumpsIsNotBlockedByPlacesToJump) {
  const auto window = std::make_unique<MapWindow>();
  const auto finder = std::make_unique<ObjectFinder>();
  test::make_level(*window);
  for (std::int32_t y = 40; y < 50; ++y)
    cell(*window, 70, y).traversability = Traversability::kJumpOnly;
  finder->find(*window, kClassesOnly, 3);
  EXPECT_EQ(finder->objects(), 1U);
  finder->find(*window, {.jump_only = false, .min_rise_m = 100.0}, 3);
  EXPECT_EQ(finder->objects(), 0U);
}

// The face of a box on ground that was known before: one cell thick, noise to the opening.
TEST(Objects, AFaceOneCellThickIsFoundByItsRise) {
  const auto window = std::make_unique<MapWindow>();
  const auto finder = std::make_unique<ObjectFinder>();
  test::make_level(*window);
  for (std::int32_t y = 40; y < 60; ++y) cell(*window, 70, y).height_m = 0.2F;
  finder->find(*window, {.jump_only = true, .min_rise_m = 0.12}, 3);
  EXPECT_EQ(finder->objects(), 1U);
  for (std::int32_t y = 40; y < 60; ++y) {
    EXPECT_EQ(finder->label(static_cast<std::size_t>(y * kSide + 70)), 1);
    EXPECT_EQ(finder->label(static_cast<std::size_t>(y * kSide + 69)), 0);
  }
  finder->find(*window, {.jump_only = true, .min_rise_m = 0.21}, 3);
  EXPECT_EQ(finder->objects(), 0U);
}

// Level ground however high over the rest of the window; and a wild cell alone.
TEST(Objects, WhatDoesNotRiseAndWhatIsAloneAreNone) {
  const auto window = std::make_unique<MapWindow>();
  const auto finder = std::make_unique<ObjectFinder>();
  test::make_level(*window);
  for (std::int32_t y = 0; y < kSide; ++y) {
    for (std::int32_t x = 0; x < kSide; ++x) {
      cell(*window, x, y).height_m = 0.02F * static_cast<float>(x);  // 0.06 m over three cells
    }
  }
  cell(*window, 20, 20).height_m += 0.3F;
  finder->find(*window, {.jump_only = true, .min_rise_m = 0.12}, 3);
  EXPECT_EQ(finder->objects(), 0U);
  EXPECT_EQ(finder->too_small(), 1U);
}

}  // namespace
}  // namespace surefoot::obstacles
