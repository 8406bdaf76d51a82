#include "core/objects/terrain_points.h"

#include <gtest/gtest.h>

#include <memory>

#include "core/base/random.h"
#include "tests/unit/objects/config.h"

namespace surefoot::objects {
namespace {

using mapping::MapWindow;

constexpr double kCell_m = 0.04;

class Terrain : public testing::Test {
 protected:
  Terrain() {
    finder_->reset(config_);
    window_->cell_size_m = kCell_m;
    window_->first = {-50, -50};
  }
  template <class Height>
  void fill(Height height) {
    for (std::int32_t iy = -50; iy < 50; ++iy) {
      for (std::int32_t ix = -50; ix < 50; ++ix) {
        mapping::WindowCell& cell = window_->cells[window_->place({ix, iy})];
        cell.state = mapping::CellState::kMeasured;
        cell.height_m = static_cast<float>(height((ix + 0.5) * kCell_m, (iy + 0.5) * kCell_m));
      }
    }
  }
  SurfacePoints& find() {
    finder_->find(*window_, *out_);
    return *out_;
  }

  ObjectsConfig config_ = test::config();
  std::unique_ptr<MapWindow> window_ = std::make_unique<MapWindow>();
  std::unique_ptr<TerrainPoints> finder_ = std::make_unique<TerrainPoints>();
  std::unique_ptr<SurfacePoints> out_ = std::make_unique<SurfacePoints>();
};

TEST_F(Terrain, AnElevenDegreeSlopeOfRoughGroundHasNone) {
  Random random(2);
  fill([&](double x, double y) { return 0.19 * x + 0.05 * y + random.uniform(-0.06, 0.06); });
  EXPECT_TRUE(find().empty());
}

TEST_F(Terrain, ABoulderAndALogAreFoundAndThinned) {
  fill([](double x, double y) {
    if ((x - 1) * (x - 1) + (y - 0.5) * (y - 0.5) < 0.3 * 0.3) return 0.5;
    if (x < -0.6 && x > -0.8) return 0.3;
    return 0.0;
  });
  bool boulder = false;
  bool log = false;
  for (const SurfacePoint& point : find()) {
    const bool on_boulder = (point.p_O_m - Vector2(1, 0.5)).norm() < 0.35;
    const bool on_log = point.p_O_m[0] < -0.55 && point.p_O_m[0] > -0.85;
    ASSERT_TRUE(on_boulder || on_log);
    boulder = boulder || on_boulder;
    log = log || on_log;
  }
  EXPECT_TRUE(boulder && log);
  EXPECT_GT(finder_->counters().thinned, out_->size());
  EXPECT_FALSE(finder_->is_level(*window_, {0.95, 0.3}));
  EXPECT_TRUE(finder_->is_level(*window_, {0, 0}));
  EXPECT_FALSE(finder_->is_level(*window_, {5, 0})) << "outside";
}

TEST_F(Terrain, AWindowNeverPublishedOrUnknownHasNone) {
  EXPECT_TRUE(find().empty());
  window_->cell_size_m = 0;
  EXPECT_TRUE(find().empty());
}

TEST_F(Terrain, StaysWithinItsRoomOnTheWorstGround) {
  config_.thin_m = 0.01;
  finder_->reset(config_);
  fill([n = 0](double, double) mutable { return (n++ % 2) != 0 ? 1.0 : 0.0; });
  EXPECT_TRUE(find().full());
  EXPECT_EQ(finder_->counters().refused + finder_->counters().thinned + out_->size(),
            finder_->counters().cells);
}

}  // namespace
}  // namespace surefoot::objects
