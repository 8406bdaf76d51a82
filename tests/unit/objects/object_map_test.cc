#include "core/objects/object_map.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <limits>
#include <memory>
#include <set>
#include <vector>

#include "tests/support/samples.h"
#include "tests/unit/objects/config.h"
#include "tests/unit/objects/scan_world.h"

namespace surefoot::objects {
namespace {

using test::plane_at;
using test::pose_at;
using test::ScanWorld;
using test::still;

TimeNs at_scan(int n) { return {static_cast<std::int64_t>(n) * 13'333'333}; }

class Map : public testing::Test {
 protected:
  Map() { map_->reset(config_); }
  Status update(const hal::LidarScan& scan) {
    return map_->update(scan, still(pose_at(0, 0, 0.9)), plane_at(0, 0), nullptr);
  }
  hal::LidarScan filled(int n, float range_m) const {
    hal::LidarScan scan;
    scan.stamp = at_scan(n);
    scan.beam_count = hal::kMaxLidarBeams;
    scan.first_angle_rad = -2.3F;
    scan.angle_step_rad = 0.00436F;
    scan.range_m.fill(range_m);
    return scan;
  }

  ObjectsConfig config_ = test::config();
  std::unique_ptr<ObjectMap> map_ = std::make_unique<ObjectMap>();
};

TEST_F(Map, ScansOfNothingAndOfNonsenseMakeNoObjects) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  int n = 0;
  for (const float range : {0.0F, nan, -1.0F, 0.01F, 1e30F}) {
    EXPECT_EQ(update(filled(n++, range)), Status::kOk);
    EXPECT_TRUE(map_->objects().empty());
  }
  EXPECT_EQ(update(hal::LidarScan{}), Status::kInvalid);
  EXPECT_EQ(update(filled(0, 1.0F)), Status::kOutOfRange);
  GroundPlane ground;
  ground.slope[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(map_->update(filled(n, 1.0F), still(pose_at(0, 0, 0.9)), ground, nullptr),
            Status::kInvalid);
  EXPECT_EQ(map_->counters().invalid, 2u);
  EXPECT_EQ(map_->counters().late, 1u);
  EXPECT_EQ(map_->counters().beams.no_return, 1u * hal::kMaxLidarBeams);
  EXPECT_EQ(map_->counters().beams.not_finite, 2u * hal::kMaxLidarBeams);
}

TEST_F(Map, AFullCircleOfReturnsIsPiecesThatStayTheSame) {
  for (int n = 0; n < 50; ++n) ASSERT_EQ(update(filled(n, 5.0F)), Status::kOk);
  const std::size_t count = map_->objects().size();
  EXPECT_GT(count, 8u);
  EXPECT_EQ(map_->counters().memory.made, count);
}

TEST_F(Map, StrideSkipsScans) {
  config_.scan_stride = 3;
  map_->reset(config_);
  for (int n = 0; n < 30; ++n) ASSERT_EQ(update(filled(n, 5.0F)), Status::kOk);
  EXPECT_EQ(map_->counters().scans, 10u);
  EXPECT_EQ(map_->counters().skipped, 20u);
}

TEST_F(Map, ALongWallKeepsItsPiecesWhileTheRobotWalksAlong) {
  ScanWorld world;
  world.ground.present = false;
  world.walls.push_back({{-30, 3.2}, {30, 3.2}, 5});
  Random random(2);
  for (int n = 0; n < 1500; ++n) {
    const double x = -10 + n * 0.8 / 75;
    const ScanPoses poses = still(pose_at(x, 0, 0.9, 0, 0.02 * std::sin(0.05 * n)));
    ASSERT_EQ(map_->update(world.scan(poses, at_scan(n), random), poses, plane_at(x, 0), nullptr),
              Status::kOk);
  }
  std::set<int> squares;
  for (const Object& object : map_->objects()) {
    EXPECT_FALSE(object.moving);
    squares.insert(static_cast<int>(std::floor(object.centre_O_m[0] / 3)));
  }
  std::printf("60 m of wall: %zu objects now, %zu made, %zu squares\n", map_->objects().size(),
              static_cast<std::size_t>(map_->counters().memory.made), squares.size());
  EXPECT_LE(map_->counters().memory.made, squares.size() + 6);
}

TEST_F(Map, TheHeightMapsBouldersAreObjectsUntilItShowsThemGone) {
  const auto window = std::make_unique<mapping::MapWindow>();
  EXPECT_EQ(map_->add_terrain(*window, Vector2::Zero()), Status::kUnavailable);
  window->cell_size_m = 0.04;
  window->first = {-50, -50};
  mapping::WindowCell level;
  level.state = mapping::CellState::kMeasured;
  window->cells.fill(level);
  const auto boulder = [&](float height) {
    for (std::int32_t iy = 0; iy < 10; ++iy) {
      for (std::int32_t ix = 20; ix < 30; ++ix) {
        window->cells[window->place({ix, iy})].height_m = height;
      }
    }
  };
  boulder(0.4F);
  for (int n = 0; n < 5; ++n) {
    window->stamp = at_scan(10 * n);
    ASSERT_EQ(map_->add_terrain(*window, Vector2::Zero()), Status::kOk);
    ASSERT_EQ(map_->objects().size(), 1u);
    EXPECT_EQ(map_->objects()[0].id, 1u);
    EXPECT_NEAR(map_->objects()[0].centre_O_m[0], 1.0, 0.1);
  }
  // The scanner looks over it and does not clear it.
  for (int n = 50; n < 150; ++n) ASSERT_EQ(update(filled(n, 20.0F)), Status::kOk);
  bool there = false;
  for (const Object& object : map_->objects()) there = there || object.id == 1;
  EXPECT_TRUE(there);
  boulder(0.0F);
  window->stamp = at_scan(151);
  ASSERT_EQ(map_->add_terrain(*window, Vector2::Zero()), Status::kOk);
  for (const Object& object : map_->objects()) EXPECT_NE(object.id, 1u);
}

// Ten times as many things as there is room for, among noise.
TEST_F(Map, OverloadKeepsWhatIsNear) {
  Random random(6);
  const auto began = std::chrono::steady_clock::now();
  const int scans = tests::samples(1000, 30);
  for (int n = 0; n < scans; ++n) {
    hal::LidarScan scan = filled(n, 0.0F);
    for (std::size_t i = 0; i < scan.beam_count; ++i) {
      scan.range_m[i] = static_cast<float>(random.uniform(3.0, 29.0));
    }
    for (std::size_t i = 500; i < 510; ++i) scan.range_m[i] = 1.5F;
    ASSERT_EQ(update(scan), Status::kOk);
    bool near = false;
    for (const Object& object : map_->objects()) {
      near = near || distance_m(object.points_O_m, Vector2::Zero()) < 1.6;
    }
    ASSERT_TRUE(near);
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  std::printf("noise: %.2f ms a scan; ObjectMap is %zu bytes\n", 1e3 * took.count() / scans,
              sizeof(ObjectMap));
  EXPECT_LE(sizeof(ObjectMap), std::size_t{2'500'000});
  const MemoryCounters& memory = map_->counters().memory;
  EXPECT_GT(memory.refused + memory.recent + memory.short_lived,
            static_cast<std::uint64_t>(10 * scans));
}

TEST_F(Map, TheSameScansGiveTheSameBits) {
  const auto run = [&] {
    map_->reset(config_);
    ScanWorld world;
    world.posts = {{{3, 1}, 0.2, 3}, {{5, -1}, 0.3, 3}};
    world.walls.push_back({{8, -9}, {8, 9}, 5});
    Random random(9);
    std::vector<double> seen;
    for (int n = 0; n < 200; ++n) {
      const ScanPoses poses = still(pose_at(0.01 * n, 0, 0.9, 0.05 * std::sin(0.1 * n)));
      const hal::LidarScan scan = world.scan(poses, at_scan(n), random);
      EXPECT_EQ(map_->update(scan, poses, plane_at(0.01 * n, 0), nullptr), Status::kOk);
      for (const Object& object : map_->objects()) {
        seen.push_back(object.id);
        seen.push_back(object.centre_O_m[0]);
        seen.push_back(object.velocity_O_m_s[1]);
      }
    }
    return seen;
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace surefoot::objects
