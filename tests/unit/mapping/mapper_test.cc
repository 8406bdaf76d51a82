#include "core/mapping/mapper.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/samples.h"
#include "tests/unit/mapping/scene.h"

namespace surefoot::mapping::test {
namespace {

constexpr double kSize = 0.015;

TimeNs frame_time(int frame) { return milliseconds(1 + 33 * frame); }

// A standing robot: camera 0.28 m ahead of the body, 40 degrees down.
class Standing : public testing::Test {
 protected:
  IntegrationReport see(int frame) {
    render(scene_, camera_, frame_time(frame), &random_, *frame_);
    IntegrationReport report;
    EXPECT_EQ(mapper_->integrate(*frame_, camera_.X_OC, self_, &report), Status::kOk);
    return report;
  }
  void look_from(double x, double y, double yaw = 0) {
    camera_ =
        mini_cheetah_camera({x + 0.28 * std::cos(yaw), y + 0.28 * std::sin(yaw), 0.34}, yaw, 0.7);
    self_ = bodiless(x, y, 0.29);
  }
  const MapCell& cell_at(double x, double y) const {
    return mapper_->map().at(cell_index(x, y, kSize));
  }

  Scene scene_;
  Camera camera_ = mini_cheetah_camera({0.28, 0, 0.34}, 0, 0.7);
  SelfModel self_ = bodiless(0, 0, 0.29);
  Random random_{1};
  std::unique_ptr<hal::DepthFrame> frame_ = std::make_unique<hal::DepthFrame>();
  std::unique_ptr<Mapper> mapper_ = make_mapper();
};

struct MapError {
  double mean = 0;
  double rms = 0;
  double worst = 0;
  int cells = 0;
};

// Against the truth at the cells' centres, over measured cells of a rectangle.
MapError map_error(const Mapper& mapper, const Scene& scene, Vector2 low, Vector2 high) {
  MapError error;
  const CellIndex first = cell_index(low.x(), low.y(), kSize);
  const CellIndex last = cell_index(high.x(), high.y(), kSize);
  for (std::int32_t iy = first.iy; iy <= last.iy; ++iy) {
    for (std::int32_t ix = first.ix; ix <= last.ix; ++ix) {
      const MapCell& cell = mapper.map().at({ix, iy});
      if (cell.state != CellState::kMeasured) continue;
      const double truth = scene.height(cell_centre(ix, kSize), cell_centre(iy, kSize));
      const double difference = static_cast<double>(cell.height_m) - truth;
      error.mean += difference;
      error.rms += difference * difference;
      error.worst = std::max(error.worst, std::fabs(difference));
      ++error.cells;
    }
  }
  error.mean /= error.cells;
  error.rms = std::sqrt(error.rms / error.cells);
  return error;
}

TEST_F(Standing, TheThreeStatesAreKeptApart) {
  scene_.boxes.push_back({{0.9, -0.2, 0}, {1.0, 0.2, 0.1}});
  for (int frame = 0; frame < 10; ++frame) see(frame);
  EXPECT_EQ(cell_at(0.7, 0).state, CellState::kMeasured);
  EXPECT_NEAR(cell_at(0.7, 0).height_m, 0, 0.01);
  EXPECT_NEAR(cell_at(0.95, 0).height_m, 0.1, 0.01);
  EXPECT_EQ(cell_at(-0.5, 0).state, CellState::kUnknown);  // behind
  EXPECT_EQ(cell_at(-0.5, 0).stamp_ms, 0u);
  const MapCell& shadow = cell_at(1.12, 0);  // behind the box
  EXPECT_EQ(shadow.state, CellState::kBounded);
  EXPECT_GT(shadow.height_m, 0.0F);
  EXPECT_LT(shadow.height_m, 0.1F + 0.03F);
}

// No ceiling may lie below the true ground: the bound is a bound.
TEST_F(Standing, CeilingsAreNeverBelowTheGround) {
  Random place(3);
  for (int i = 0; i < 30; ++i) {
    const double x = place.uniform(0.4, 2.2);
    const double y = place.uniform(-0.8, 0.8);
    const double height = place.uniform(0.02, 0.15);
    scene_.boxes.push_back({{x, y, 0}, {x + 0.12, y + 0.15, height}});
  }
  int bounded = 0;
  int below = 0;
  for (int frame = 0; frame < 30; ++frame) {
    look_from(0.01 * frame, 0);
    see(frame);
  }
  for (std::int32_t iy = -100; iy < 100; ++iy) {
    for (std::int32_t ix = 0; ix < 200; ++ix) {
      const MapCell& cell = mapper_->map().at({ix, iy});
      if (cell.state != CellState::kBounded) continue;
      // A cell may straddle an edge: the ground of its lowest corner counts.
      double truth = 1e9;
      for (const double dx : {0.05, 0.95}) {
        for (const double dy : {0.05, 0.95}) {
          truth = std::min(truth, scene_.height((ix + dx) * kSize, (iy + dy) * kSize));
        }
      }
      ++bounded;
      if (static_cast<double>(cell.height_m) < truth - 0.01) ++below;
    }
  }
  EXPECT_GT(bounded, 300);
  EXPECT_EQ(below, 0);
}

TEST_F(Standing, BadInputLeavesEveryBitAlone) {
  for (int frame = 0; frame < 3; ++frame) see(frame);
  const auto before = std::make_unique<ControlMap>(mapper_->map());
  const auto refuse = [&](Status expected, const hal::DepthFrame& frame, const CameraPose& pose,
                          const SelfModel& self, const char* what) {
    IntegrationReport report;
    EXPECT_EQ(mapper_->integrate(frame, pose, self, &report), expected) << what;
    EXPECT_EQ(std::memcmp(before.get(), &mapper_->map(), sizeof(ControlMap)), 0) << what;
    EXPECT_EQ(mapper_->frames(), 3u);
    EXPECT_EQ(mapper_->stamp(), frame_time(2));
  };
  render(scene_, camera_, frame_time(3), nullptr, *frame_);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(), -1e300}) {
    for (int i = 0; i < 3; ++i) {
      CameraPose pose = camera_.X_OC;
      pose.origin.m[i] = bad;
      refuse(bad == -1e300 ? Status::kOutOfRange : Status::kInvalid, *frame_, pose, self_,
             "camera");
      SelfModel self = self_;
      self.X_OB.origin.m[i] = bad;
      refuse(bad == -1e300 ? Status::kOutOfRange : Status::kInvalid, *frame_, camera_.X_OC, self,
             "body");
      pose = camera_.X_OC;
      pose.rotation.matrix(i, 1) = bad;
      refuse(Status::kInvalid, *frame_, pose, self_, "rotation");
    }
    auto frame = std::make_unique<hal::DepthFrame>(*frame_);
    frame->intrinsics.fx_px = bad;
    refuse(Status::kInvalid, *frame, camera_.X_OC, self_, "focal length");
    *frame = *frame_;
    frame->intrinsics.cy_px = bad;
    refuse(Status::kInvalid, *frame, camera_.X_OC, self_, "centre");
    *frame = *frame_;
    frame->depth_unit_m = static_cast<float>(bad);
    refuse(Status::kInvalid, *frame, camera_.X_OC, self_, "unit");
    if (bad == -1e300) break;  // a capsule that far away is no error
    SelfModel self = self_;
    ASSERT_TRUE(ok(self.capsules.push_back({{bad, 0, 0}, {0, 0, 0}, 0.1})));
    refuse(Status::kInvalid, *frame_, camera_.X_OC, self, "capsule");
  }
}

TEST_F(Standing, EmptyAndTinyFramesLeaveEveryBitAlone) {
  for (int frame = 0; frame < 3; ++frame) see(frame);
  const auto before = std::make_unique<ControlMap>(mapper_->map());
  const auto refuse = [&](Status expected) {
    EXPECT_EQ(mapper_->integrate(*frame_, camera_.X_OC, self_), expected);
    EXPECT_EQ(std::memcmp(before.get(), &mapper_->map(), sizeof(ControlMap)), 0);
  };
  frame_->stamp = frame_time(3);
  frame_->depth.fill(0);
  refuse(Status::kNotFound);  // nothing measured
  frame_->depth.fill(65535);
  refuse(Status::kNotFound);  // beyond the range
  frame_->depth.fill(0);
  frame_->depth[40 * 160 + 80] = 500;
  refuse(Status::kNotFound);  // one lonely pixel is a mixed pixel
  frame_->intrinsics.width_px = 0;
  refuse(Status::kInvalid);
  frame_->intrinsics.width_px = 641;
  refuse(Status::kInvalid);
  frame_->intrinsics.width_px = 160;
  frame_->stamp = frame_time(2);
  frame_->depth.fill(500);
  refuse(Status::kInvalid);  // not after the last frame
}

TEST(Mapper, NotConfiguredOrDisabled) {
  auto mapper = std::make_unique<Mapper>();
  auto frame = std::make_unique<hal::DepthFrame>();
  const Camera camera = mini_cheetah_camera({0, 0, 0.3}, 0, 0.7);
  render(Scene{}, camera, milliseconds(1), nullptr, *frame);
  const SelfModel self = bodiless(0, 0, 0.3);
  auto window = std::make_unique<MapWindow>();
  EXPECT_EQ(mapper->integrate(*frame, camera.X_OC, self), Status::kUnavailable);
  EXPECT_EQ(mapper->publish(0, 0, *window), Status::kUnavailable);
  EXPECT_EQ(mapper->assume(AssumedPad{}), Status::kUnavailable);
  MappingConfig config = recommended_config();
  config.enabled = false;
  const DepthSensorModel sensor = sensor_model(mini_cheetah_camera_specification());
  const TraversabilityLimits limits = limits_of(config);
  EXPECT_EQ(mapper->configure(config, sensor, limits), Status::kOk);
  EXPECT_EQ(mapper->integrate(*frame, camera.X_OC, self), Status::kUnavailable);
  config.gate_sigma = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(mapper->configure(config, sensor, limits), Status::kInvalid);
  EXPECT_EQ(mapper->configure(recommended_config(), DepthSensorModel{}, limits), Status::kInvalid);
  TraversabilityLimits reversed = limits;
  reversed.max_jump_m = 0.5 * limits.max_step_m;
  EXPECT_EQ(mapper->configure(recommended_config(), sensor, reversed), Status::kInvalid);
}

TEST(Mapper, PublishRefusesBadPositionsAndTouchesNothing) {
  auto mapper = make_mapper();
  auto window = std::make_unique<MapWindow>();
  const std::uint64_t before = window->digest();
  EXPECT_EQ(mapper->publish(std::numeric_limits<double>::quiet_NaN(), 0, *window),
            Status::kInvalid);
  EXPECT_EQ(mapper->publish(0, 1e7, *window), Status::kOutOfRange);
  EXPECT_EQ(window->digest(), before);
}

// 800 frames of a still camera: the cells converge and their mean does not creep (1 mm).
TEST_F(Standing, NoiseConvergesWithoutDrift) {
  const Vector2 low(0.45, -0.15);
  const Vector2 high(1.2, 0.15);
  for (int frame = 0; frame < 100; ++frame) see(frame);
  const MapError early = map_error(*mapper_, scene_, low, high);
  for (int frame = 100; frame < tests::samples(800, 150); ++frame) see(frame);
  const MapError late = map_error(*mapper_, scene_, low, high);
  EXPECT_GT(early.cells, 700);
  EXPECT_LT(std::fabs(early.mean), 1e-3);
  EXPECT_LT(std::fabs(late.mean), 1e-3);
  EXPECT_LT(std::fabs(late.mean - early.mean), 5e-4);
  EXPECT_LT(late.rms, 2e-3);
  EXPECT_LT(late.worst, 0.01);
}

// The stereo noise model predicts the spread of single heights within 20 % from 0.3 to 3 m. The
// pixels are 2.5 cells apart, so that no cell averages two.
TEST(Mapper, PredictedNoiseMatchesSimulatedNoise) {
  MappingConfig config = recommended_config();
  config.attitude_noise_rad = 0;
  config.min_sigma_m = 1e-4;
  config.depth_noise_floor_m = 3e-4;  // the millimetre of the image
  config.max_height_above_body_m = 3.0;
  auto mapper = make_mapper(config);
  auto frame = std::make_unique<hal::DepthFrame>();
  Random random(17);
  int trial = 0;
  for (const double distance : {0.3, 0.6, 1.0, 2.0, 3.0}) {
    Camera camera = mini_cheetah_camera({0, 0.005, distance}, 0, 1.5707963);  // straight down
    const double focal_px = distance / (2.5 * kSize);
    camera.intrinsics = {3, 3, focal_px, focal_px, 1, 1};
    double sum2 = 0;
    double predicted2 = 0;
    for (int i = 0; i < 400; ++i, ++trial) {
      const double x = 0.5 * trial - 3000 + 0.005;  // fresh cells
      camera.X_OC.origin.m.x() = x;
      Scene scene;
      scene.ground_z_m = random.uniform(-0.002, 0.002);  // any place between two millimetres
      render(scene, camera, milliseconds(trial + 1), &random, *frame);
      ASSERT_EQ(mapper->integrate(*frame, camera.X_OC, bodiless(x, 0, distance)), Status::kOk);
      const MapCell& cell = mapper->map().at(cell_index(x, 0.005, kSize));
      const double error = static_cast<double>(cell.height_m) - scene.ground_z_m;
      sum2 += error * error;
      predicted2 += static_cast<double>(cell.variance_m2);
    }
    EXPECT_NEAR(std::sqrt(predicted2 / sum2), 1.0, 0.2) << distance;
  }
}

// Edges of steps: all cells but those that straddle an edge are right to a centimetre.
TEST_F(Standing, StepEdgesStaySharp) {
  scene_.boxes.push_back({{0.75, -0.3, 0}, {0.9, 0.3, 0.05}});
  scene_.boxes.push_back({{0.9, -0.3, 0}, {1.2, 0.3, 0.10}});
  for (int frame = 0; frame < 60; ++frame) {
    look_from(0.003 * frame, 0);
    see(frame);
  }
  int wrong = 0;
  int cells = 0;
  for (std::int32_t iy = -16; iy < 16; ++iy) {
    for (std::int32_t ix = 40; ix < 79; ++ix) {
      const MapCell& cell = mapper_->map().at({ix, iy});
      if (cell.state != CellState::kMeasured) continue;
      const double low = scene_.height((ix - 0.1) * kSize, (iy + 0.5) * kSize);
      const double high = scene_.height((ix + 1.1) * kSize, (iy + 0.5) * kSize);
      if (low != high) continue;
      ++cells;
      if (std::fabs(static_cast<double>(cell.height_m) - low) > 0.01) ++wrong;
    }
  }
  EXPECT_GT(cells, 900);
  EXPECT_LE(wrong, cells / 200);
}

// One wrong frame does not move a cell; agreeing frames do, in the stated number.
TEST_F(Standing, OutliersNeedConfirmation) {
  for (int frame = 0; frame < 20; ++frame) see(frame);
  const float before = cell_at(0.8, 0).height_m;
  const Scene flat = scene_;
  scene_.boxes.push_back({{0.7, -0.1, 0}, {0.9, 0.1, 0.08}});
  IntegrationReport report = see(20);
  EXPECT_EQ(cell_at(0.8, 0).height_m, before);
  EXPECT_GT(report.cells_pending, 100u);
  scene_ = flat;
  see(21);
  EXPECT_EQ(cell_at(0.8, 0).confirmations, 0);
  scene_.boxes.push_back({{0.7, -0.1, 0}, {0.9, 0.1, 0.08}});
  see(22);
  EXPECT_NEAR(cell_at(0.8, 0).height_m, 0, 0.01);
  report = see(23);  // confirmations_up = 2
  EXPECT_NEAR(cell_at(0.8, 0).height_m, 0.08, 0.01);
  EXPECT_GT(report.cells_replaced, 50u);
}

TEST_F(Standing, AssumedGroundIsAStateOfItsOwnUntilItIsSeen) {
  AssumedPad pad;
  pad.z_O_m = 0.02;
  pad.half_length_m = 0.6;
  pad.half_width_m = 0.3;
  pad.yaw_rad = 0.3;
  pad.slope_x = 0.05;
  ASSERT_EQ(mapper_->assume(pad), Status::kOk);
  int assumed = 0;
  for (std::int32_t iy = -60; iy < 60; ++iy) {
    for (std::int32_t ix = -60; ix < 60; ++ix) {
      const double x = cell_centre(ix, kSize);
      const double y = cell_centre(iy, kSize);
      const double along = std::cos(0.3) * x + std::sin(0.3) * y;
      const double across = std::cos(0.3) * y - std::sin(0.3) * x;
      const bool inside = std::fabs(along) <= 0.6 && std::fabs(across) <= 0.3;
      const MapCell& cell = mapper_->map().at({ix, iy});
      ASSERT_EQ(cell.state == CellState::kAssumed, inside);
      if (inside) {
        ASSERT_NEAR(cell.height_m, 0.02 + 0.05 * x, 1e-6);
        ++assumed;
      }
    }
  }
  EXPECT_NEAR(assumed, 1.2 * 0.6 / (kSize * kSize), 60);
  see(0);
  EXPECT_EQ(cell_at(0.5, 0).state, CellState::kMeasured);
  EXPECT_NEAR(cell_at(0.5, 0).height_m, 0, 0.012);
  EXPECT_EQ(cell_at(-0.2, 0).state, CellState::kAssumed);
  ASSERT_EQ(mapper_->assume(pad), Status::kOk);  // again: what was measured stays
  EXPECT_EQ(cell_at(0.5, 0).state, CellState::kMeasured);
  pad.slope_x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(mapper_->assume(pad), Status::kInvalid);
}

// A cell seen half a metre ahead is still there when the hind foot lands.
TEST_F(Standing, TerrainUnderTheRobotIsKept) {
  scene_.boxes.push_back({{0.8, -0.2, 0}, {0.95, 0.2, 0.05}});
  int frame = 0;
  for (double x = 0; x < 1.2; x += 0.0167) {
    look_from(x, 0);
    see(frame++);
  }
  auto window = std::make_unique<MapWindow>();
  ASSERT_EQ(mapper_->publish(1.2, 0, *window), Status::kOk);
  int kept = 0;
  for (double x = 0.81; x < 0.94; x += kSize) {
    const auto height = window->height_at(x, 0);
    ASSERT_TRUE(height.ok());
    EXPECT_NEAR(height.value(), 0.05, 0.01);
    ++kept;
  }
  EXPECT_GT(kept, 7);
}

struct Outcome {
  std::uint64_t map = 0;
  std::uint64_t window = 0;
};

// A short walk with noise over boxes; `detour` sends the map far away and back before it starts.
Outcome walk(bool detour) {
  auto mapper = make_mapper();
  auto frame = std::make_unique<hal::DepthFrame>();
  if (detour) {
    for (const double x : {777.7, -3.21, 12.3, 0.4}) {
      AssumedPad pad;
      pad.x_O_m = x;
      pad.y_O_m = -2 * x;
      EXPECT_EQ(mapper->assume(pad), Status::kOk);
    }
    AssumedPad last;  // of no area, but it places the map
    EXPECT_EQ(mapper->assume(last), Status::kOk);
  }
  Scene scene;
  scene.boxes.push_back({{0.7, -0.3, 0}, {0.9, 0.1, 0.04}});
  scene.boxes.push_back({{1.0, 0.0, 0}, {1.2, 0.4, 0.06}});
  Random random(99);
  for (int i = 0; i < 30; ++i) {
    const double x = 0.02 * i;
    Camera camera = mini_cheetah_camera({x + 0.28, 0.01 * i, 0.34}, 0.02 * i, 0.7);
    camera.dropout = 0.02;
    render(scene, camera, frame_time(i), &random, *frame);
    EXPECT_EQ(mapper->integrate(*frame, camera.X_OC, bodiless(x, 0.01 * i, 0.29)), Status::kOk);
  }
  auto window = std::make_unique<MapWindow>();
  EXPECT_EQ(mapper->publish(0.6, 0.3, *window), Status::kOk);
  return {mapper->digest(), window->digest()};
}

TEST(Mapper, SameInputSameBitsAndTheRingIsInvisible) {
  const Outcome first = walk(false);
  const Outcome again = walk(false);
  const Outcome moved = walk(true);
  EXPECT_EQ(first.map, again.map);
  EXPECT_EQ(first.window, again.window);
  EXPECT_EQ(first.map, moved.map);
  EXPECT_EQ(first.window, moved.window);
  // The same on every compiler and CPU; changes only when the mapping itself is meant to change.
  EXPECT_EQ(first.map, 12642988510630165141ull);
  EXPECT_EQ(first.window, 5606229589697747894ull);
}

// The same scene carried to another place in the ring gives the same heights, classes and
// footholds: a whole number of cells that is exact in binary, so that every rounding is the same.
TEST(Mapper, MovedByWholeCellsGivesTheSameWindow) {
  MappingConfig config = recommended_config();
  config.cell_size_m = 0.015625;  // 2^-6
  const auto run = [&](double shift) {
    auto mapper = make_mapper(config);
    auto frame = std::make_unique<hal::DepthFrame>();
    Random random(4);
    Scene scene;  // rendered at the origin: what the camera sees does not depend on the place
    scene.boxes.push_back({{0.7, -0.3, 0}, {0.9, 0.1, 0.04}});
    for (int i = 0; i < 10; ++i) {
      const double x = 0.03125 * i;
      Camera camera = mini_cheetah_camera({x + 0.28125, 0, 0.34}, 0, 0.7);
      render(scene, camera, frame_time(i), &random, *frame);
      camera.X_OC.origin.m += Vector3(shift, -2 * shift, 0);
      EXPECT_EQ(mapper->integrate(*frame, camera.X_OC, bodiless(x + shift, -2 * shift, 0.29)),
                Status::kOk);
    }
    auto window = std::make_unique<MapWindow>();
    EXPECT_EQ(mapper->publish(0.3 + shift, -2 * shift, *window), Status::kOk);
    return window;
  };
  const auto here = run(0);
  const auto there = run(8 * 1000 * 0.015625 + 0.015625 * 431);
  int same = 0;
  for (std::size_t i = 0; i < here->cells.size(); ++i) {
    const WindowCell& a = here->cells[i];
    const WindowCell& b = there->cells[i];
    // Sums such as camera + offset round differently far from the origin: points within rounding of
    // a cell border may change sides, so nearly all cells, not all.
    same += a.state == b.state && a.traversability == b.traversability &&
            std::fabs(static_cast<double>(a.height_m - b.height_m)) < 1e-5;
  }
  EXPECT_GE(same, static_cast<int>(here->cells.size()) - 5);
}

TEST_F(Standing, LargeImagesAreThinnedToTheBound) {
  camera_.intrinsics = {640, 480, 585, 585, 320, 240};
  const IntegrationReport report = see(0);
  EXPECT_LE(report.pixels, kMaxPixels);
  EXPECT_GT(report.pixels, kMaxPixels / 2);
  EXPECT_EQ(cell_at(0.7, 0).state, CellState::kMeasured);
}

// A robot that fell: what it knew around the place is gone, what lies beyond stays, and wrong
// orders change nothing.
TEST_F(Standing, ForgetsASquareAndNothingBeyondIt) {
  AssumedPad pad;
  pad.half_length_m = 0.9;
  pad.half_width_m = 0.6;
  ASSERT_EQ(mapper_->assume(pad), Status::kOk);
  EXPECT_EQ(mapper_->forget(NAN, 0.0, 0.3), Status::kInvalid);
  EXPECT_EQ(mapper_->forget(0.0, 0.0, -0.1), Status::kInvalid);
  EXPECT_EQ(mapper_->forget(0.0, 0.0, 5.1), Status::kInvalid);
  EXPECT_TRUE(cell_at(0.2, 0.0).has_height());
  ASSERT_EQ(mapper_->forget(0.2, 0.1, 0.3), Status::kOk);
  for (double x = -0.8; x <= 0.8; x += 0.03) {
    for (double y = -0.5; y <= 0.5; y += 0.03) {
      const double off = std::max(std::fabs(x - 0.2), std::fabs(y - 0.1));
      if (std::fabs(off - 0.3) < 0.02) continue;  // the square's edge within a cell
      EXPECT_EQ(cell_at(x, y).has_height(), off > 0.3) << x << " " << y;
    }
  }
}

TEST(Mapper, ForgetsNothingBeforeItIsConfigured) {
  const auto mapper = std::make_unique<Mapper>();
  EXPECT_EQ(mapper->forget(0.0, 0.0, 0.3), Status::kUnavailable);
}

}  // namespace
}  // namespace surefoot::mapping::test
