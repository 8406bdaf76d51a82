#include "core/mapping/self_filter.h"

#include <cmath>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "tests/support/samples.h"
#include "tests/unit/mapping/scene.h"

namespace surefoot::mapping::test {
namespace {

TEST(SelfFilter, CapsuleAndTrunkWithInflation) {
  SelfModel self = bodiless(1, 2, 0.3);
  self.trunk_size_m = {0.4, 0.2, 0.1};
  ASSERT_TRUE(ok(self.capsules.push_back({{1, 1, 0}, {1, 1, 0.2}, 0.02})));
  ASSERT_TRUE(ok(self.capsules.push_back({{0, 0, 0}, {0, 0, 0}, 0.05})));  // a ball
  const SelfFilter filter(self, 0.01);
  EXPECT_TRUE(filter.covers({1.029, 1, 0.1}));
  EXPECT_FALSE(filter.covers({1.031, 1, 0.1}));
  EXPECT_TRUE(filter.covers({1, 1, 0.229}));
  EXPECT_FALSE(filter.covers({1, 1, 0.231}));
  EXPECT_TRUE(filter.covers({0, 0.059, 0}));
  EXPECT_FALSE(filter.covers({0, 0.061, 0}));
  EXPECT_TRUE(filter.covers({1.209, 2.109, 0.359}));
  EXPECT_FALSE(filter.covers({1.211, 2, 0.3}));
  EXPECT_FALSE(filter.covers({1, 2.111, 0.3}));
}

// No trunk size, no trunk: the origin of B itself is not covered.
TEST(SelfFilter, ABodyOfNoSizeCoversNothing) {
  const SelfModel self = bodiless(0, 0, 0.3);
  const SelfFilter filter(self, 0.05);
  EXPECT_FALSE(filter.covers({0, 0, 0.3}));
}

TEST(SelfFilter, Validation) {
  SelfModel self = bodiless(0, 0, 0);
  EXPECT_EQ(validate(self), Status::kOk);
  self.trunk_size_m[1] = -0.1;
  EXPECT_EQ(validate(self), Status::kInvalid);
  self.trunk_size_m[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(validate(self), Status::kInvalid);
}

// A trot in front of the camera: legs swing through the view, the map stays flat.
TEST(SelfFilter, NoLegCellsInATrot) {
  auto mapper = make_mapper();
  auto frame = std::make_unique<hal::DepthFrame>();
  Random random(8);
  std::uint32_t self_points = 0;
  for (int i = 0; i < tests::samples(150, 60); ++i) {
    const double x = 0.0167 * i;
    Scene scene;
    SelfModel self = bodiless(x, 0, 0.29);
    self.trunk_size_m = {0.38, 0.2, 0.1};
    for (const double side : {-1.0, 1.0}) {
      // A swinging front leg, far enough ahead to stand in the view.
      const double swing = 0.12 * std::sin(0.5 * i + side);
      const Vector3 hip(x + 0.19, side * 0.11, 0.29);
      const Vector3 knee(x + 0.30 + 0.5 * swing, side * 0.11, 0.18);
      const Vector3 foot(x + 0.40 + swing, side * 0.11, 0.02 + 0.05 * std::fabs(std::sin(0.5 * i)));
      for (const SelfCapsule& link :
           {SelfCapsule{hip, knee, 0.03}, SelfCapsule{knee, foot, 0.02}}) {
        scene.capsules.push_back({link.a_O_m, link.b_O_m, link.radius_m});
        ASSERT_TRUE(ok(self.capsules.push_back(link)));
      }
    }
    const Camera camera = mini_cheetah_camera({x + 0.28, 0, 0.34}, 0, 0.7);
    render(scene, camera, milliseconds(1 + 33 * i), &random, *frame);
    IntegrationReport report;
    ASSERT_EQ(mapper->integrate(*frame, camera.X_OC, self, &report), Status::kOk);
    self_points += report.self;
  }
  int legs = 0;
  int measured = 0;
  for (std::int32_t iy = -60; iy < 60; ++iy) {
    for (std::int32_t ix = 0; ix < 300; ++ix) {
      const MapCell& cell = mapper->map().at({ix, iy});
      if (cell.state != CellState::kMeasured) continue;
      ++measured;
      if (std::fabs(static_cast<double>(cell.height_m)) > 0.03) ++legs;
    }
  }
  EXPECT_GT(self_points, 10000u);
  EXPECT_GT(measured, 10000);
  EXPECT_EQ(legs, 0);
}

}  // namespace
}  // namespace surefoot::mapping::test
