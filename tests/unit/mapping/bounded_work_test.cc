// What a frame may not do any more is done by the next ones, and nothing waits for ever.
#include <gtest/gtest.h>

#include <memory>

#include "core/mapping/line_of_sight.h"
#include "core/mapping/mapper.h"
#include "tests/unit/mapping/scene.h"

namespace surefoot::mapping::test {
namespace {

constexpr double kCamera_m = 2.4;
constexpr double kReach_m = 7.2;  // of the view, to either side of the camera

// A camera of 144 degrees that looks straight down on level ground.
class WideView : public ::testing::Test {
 protected:
  WideView() {
    config_.max_height_above_body_m = 3.0;
    X_OC_.rotation.matrix << 0, -1, 0, -1, 0, 0, 0, 0, -1;
    X_OC_.origin.m = Vector3(0.0, 0.0, kCamera_m);
    const double focal_px = 80 * kCamera_m / kReach_m;
    frame_->intrinsics = {160, 128, focal_px, focal_px, 79.5, 63.5};
    for (std::size_t i = 0; i < frame_->pixel_count(); ++i) frame_->depth[i] = 2400;
  }

  MappingConfig config_ = recommended_config();
  DepthSensorModel sensor_{0.0006, 0.17, 4.0};
  CameraPose X_OC_;
  std::unique_ptr<hal::DepthFrame> frame_ = std::make_unique<hal::DepthFrame>();
};

int cells_at(const HeightMap<kMapSide>& map, float height_m) {
  int count = 0;
  for (std::int32_t y = -200; y < 200; ++y) {
    for (std::int32_t x = -200; x < 200; ++x) {
      const MapCell& cell = map.at({x, y});
      count += cell.has_height() && cell.height_m == height_m ? 1 : 0;
    }
  }
  return count;
}

// Ghosts fill more cells than one frame may look at: each row has its turn, so that three looks
// take five frames at five eighths of the rows each.
TEST_F(WideView, GhostsGoThoughRowsArePutOff) {
  constexpr float kGhost_m = 1.1F;
  const auto mapper = std::make_unique<Mapper>();
  ASSERT_TRUE(ok(mapper->configure(config_, sensor_, limits_of(config_))));
  AssumedPad pad;
  pad.z_O_m = 1.1;
  pad.half_length_m = 5.0;
  pad.half_width_m = 5.0;
  ASSERT_TRUE(ok(mapper->assume(pad)));
  ASSERT_GT(cells_at(mapper->map(), kGhost_m), 150000);
  SelfModel self;
  self.X_OB.origin.m = X_OC_.origin.m;
  for (int i = 0; i < 5; ++i) {
    frame_->stamp = frame_->stamp + milliseconds(33);
    IntegrationReport report;
    ASSERT_TRUE(ok(mapper->integrate(*frame_, X_OC_, self, &report)));
    EXPECT_LE(report.cells_looked_at, kMaxLooks);
    if (i < 3) {
      EXPECT_GT(report.rows_put_off, 100u);
    }
  }
  EXPECT_EQ(cells_at(mapper->map(), kGhost_m), 0);
}

// The rays of one pattern take several frames, and leave what they leave band by band.
TEST_F(WideView, EveryRayHasItsTurn) {
  config_.ceiling_pixel_stride = 2;
  const auto image = std::make_unique<DepthImage>();
  prepare(*frame_, config_, sensor_, *image);
  const Sight sight{*image, X_OC_, config_, sensor_, 1000};
  const auto map = std::make_unique<ControlMap>();
  map->reset({0, 0});
  SightTurn turn;
  int frames = 0;
  std::uint32_t put_off = 0;
  for (; turn.ceiling_pass == 0; ++frames) {
    ASSERT_LT(frames, 20);
    IntegrationReport report;
    lower_ceilings(sight, turn, *map, report);
    if (frames > 0) {
      EXPECT_LT(report.rays_put_off, put_off);
    }
    put_off = report.rays_put_off;
  }
  EXPECT_GT(frames, 2);
  EXPECT_EQ(put_off, 0u);
  EXPECT_EQ(turn.ceiling_ray, 0);

  const auto bands = std::make_unique<ControlMap>();
  bands->reset({0, 0});
  constexpr std::int32_t kBand = 8;  // few enough rows for one frame
  for (std::int32_t begin = 0; begin < image->height; begin += kBand) {
    prepare(*frame_, config_, sensor_, *image);
    for (std::int32_t v = 0; v < image->height; ++v) {
      if (v >= begin && v < begin + kBand) continue;
      for (std::int32_t u = 0; u < image->width; ++u) image->z_m[image->at(u, v)] = 0;
    }
    SightTurn fresh;
    IntegrationReport report;
    lower_ceilings(sight, fresh, *bands, report);
    ASSERT_EQ(report.rays_put_off, 0u);
  }
  Fnv64 in_turns;
  Fnv64 in_bands;
  map->add_to(in_turns);
  bands->add_to(in_bands);
  EXPECT_EQ(in_turns.value(), in_bands.value());
}

}  // namespace
}  // namespace surefoot::mapping::test
