#include "core/obstacles/field_pool.h"

#include <gtest/gtest.h>

#include <memory>

#include "core/base/random.h"
#include "tests/support/samples.h"
#include "tests/unit/obstacles/windows.h"

namespace surefoot::obstacles {
namespace {

using mapping::CellState;
using mapping::MapWindow;
using mapping::Traversability;
using test::cell;
using test::kSide;

constexpr BlockingRule kRule{.jump_only = true, .min_rise_m = 0.12};

class Pool : public testing::Test {
 protected:
  Pool() : window_(std::make_unique<MapWindow>()), pool_(std::make_unique<FieldPool>()) {
    test::make_level(*window_);
    pool_->reset(config_);
  }
  void block(std::int32_t x0, std::int32_t x1, std::int32_t y0, std::int32_t y1,
             Traversability as = Traversability::kImpassable) {
    for (std::int32_t y = y0; y < y1; ++y) {
      for (std::int32_t x = x0; x < x1; ++x) cell(*window_, x, y).traversability = as;
    }
  }
  void update(const Vector2& robot_O_m = Vector2::Zero()) {
    pool_->update(*window_, kRule, robot_O_m);
  }
  double nearest_m(const Vector2& p) const {
    double nearest = 1e9;
    for (const Field& field : pool_->fields()) {
      nearest = std::min(nearest, (field.centre_O_m - p).norm());
    }
    return nearest;
  }

  ObstacleConfig config_ = test::config();
  std::unique_ptr<MapWindow> window_;
  std::unique_ptr<FieldPool> pool_;
};

TEST_F(Pool, DiscsNeverOverlapAndEveryCellIsWithinTwoRadii) {
  Random random(12);
  for (int sample = 0; sample < tests::samples(200, 10); ++sample) {
    // Moves, so that fields of other windows are about.
    window_->first = {static_cast<std::int32_t>(random.below(40)) - 70, -kSide / 2};
    if (sample % 3 == 0) test::make_level(*window_);
    const auto x = static_cast<std::int32_t>(random.below(80));
    const auto y = static_cast<std::int32_t>(random.below(80));
    const auto width = static_cast<std::int32_t>(1 + random.below(20));
    const auto length = static_cast<std::int32_t>(3 + random.below(17));
    block(x, x + width, y, y + length);
    update();
    const Fields& fields = pool_->fields();
    for (std::size_t a = 0; a < fields.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        ASSERT_GE((fields[a].centre_O_m - fields[b].centre_O_m).norm(),
                  2 * config_.field_radius_m - 1e-12);
      }
    }
    if (pool_->counters().refused > 0 || pool_->counters().replaced > 0) {
      pool_->reset(config_);
      continue;
    }
    for (std::int32_t cy = y; cy < y + length; ++cy) {
      for (std::int32_t cx = x; cx < x + width; ++cx) {
        const Vector2 centre(mapping::cell_centre(window_->first.ix + cx, test::kCell_m),
                             mapping::cell_centre(window_->first.iy + cy, test::kCell_m));
        ASSERT_LE(nearest_m(centre), 2 * config_.field_radius_m);
      }
    }
  }
}

TEST_F(Pool, ForgetsAfterSoManyWindowsThatShowTheGroundAndNotBefore) {
  block(70, 72, 40, 60);
  update();
  ASSERT_GT(pool_->fields().size(), 0U);
  const std::size_t made = pool_->fields().size();
  block(70, 72, 40, 60, Traversability::kSteppable);
  update();
  update();
  EXPECT_EQ(pool_->fields().size(), made);
  block(70, 72, 40, 60);  // there it is again: the count starts anew
  update();
  block(70, 72, 40, 60, Traversability::kSteppable);
  update();
  update();
  EXPECT_EQ(pool_->fields().size(), made);
  update();
  EXPECT_EQ(pool_->fields().size(), 0U);
  EXPECT_EQ(pool_->counters().forgotten, made);
}

TEST_F(Pool, FollowsAMovedObject) {
  block(70, 72, 40, 60);
  update();
  block(70, 72, 40, 60, Traversability::kSteppable);
  block(80, 82, 20, 40);
  for (int i = 0; i < 3; ++i) update();
  const Vector2 old_place(mapping::cell_centre(20, test::kCell_m), 0.0);
  const Vector2 new_place(mapping::cell_centre(30, test::kCell_m),
                          mapping::cell_centre(-20, test::kCell_m));
  EXPECT_GT(nearest_m(old_place), 0.2);
  EXPECT_LE(nearest_m(new_place), 2 * config_.field_radius_m);
}

TEST_F(Pool, KeepsWhatLeftTheWindowAndWhatIsUnseen) {
  block(70, 72, 40, 60);
  update();
  const std::size_t made = pool_->fields().size();
  test::make_level(*window_);
  window_->first = {200, 200};
  for (int i = 0; i < 10; ++i) update();
  EXPECT_EQ(pool_->fields().size(), made);
  test::make_level(*window_);
  for (auto& one : window_->cells) one = mapping::WindowCell{};
  for (int i = 0; i < 10; ++i) update();
  EXPECT_EQ(pool_->fields().size(), made);
  // Bounded: a line of sight passed.
  for (auto& one : window_->cells) one.state = CellState::kBounded;
  for (int i = 0; i < 3; ++i) update();
  EXPECT_EQ(pool_->fields().size(), 0U);
}

TEST_F(Pool, WhenFullTheFarthestGivesWayAndIsCounted) {
  block(0, kSide, 0, kSide);
  update();
  EXPECT_EQ(pool_->fields().size(), kMaxFields);
  const FieldCounters& counters = pool_->counters();
  EXPECT_EQ(counters.made, kMaxFields + counters.replaced);
  EXPECT_GT(counters.replaced, 0U);
  EXPECT_GT(counters.refused, 0U);
  // What is kept is what is near the robot.
  double farthest = 0;
  for (const Field& field : pool_->fields()) farthest = std::max(farthest, field.centre_O_m.norm());
  EXPECT_LT(farthest, 0.6);
  EXPECT_LE(nearest_m(Vector2::Zero()), 2 * config_.field_radius_m);
}

TEST_F(Pool, ForgetsTheSurroundingsOfAFall) {
  block(70, 72, 40, 60);
  update();
  pool_->forget_around(Vector2::Zero(), 0.1);
  EXPECT_GT(pool_->fields().size(), 0U);
  pool_->forget_around(Vector2::Zero(), 0.5);
  EXPECT_EQ(pool_->fields().size(), 0U);
}

}  // namespace
}  // namespace surefoot::obstacles
