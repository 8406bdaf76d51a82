// Ghosts must go, and nothing that stands may go with them.
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "tests/support/samples.h"
#include "tests/unit/mapping/scene.h"

namespace surefoot::mapping::test {
namespace {

using tests::samples;

constexpr double kSize = 0.015;

struct Rig {
  std::unique_ptr<Mapper> mapper = make_mapper();
  std::unique_ptr<hal::DepthFrame> frame = std::make_unique<hal::DepthFrame>();
  Random random{1};
  int frames = 0;

  IntegrationReport see(const Scene& scene, const Camera& camera, double body_x) {
    render(scene, camera, milliseconds(1 + 33 * frames++), &random, *frame);
    IntegrationReport report;
    EXPECT_EQ(mapper->integrate(*frame, camera.X_OC, bodiless(body_x, 0, 0.29), &report),
              Status::kOk);
    return report;
  }
};

// Measured cells of a rectangle that stand more than `above` over the scene.
int ghosts(const Mapper& mapper, const Scene& scene, Vector2 low, Vector2 high, double above) {
  int count = 0;
  const CellIndex first = cell_index(low.x(), low.y(), kSize);
  const CellIndex last = cell_index(high.x(), high.y(), kSize);
  for (std::int32_t iy = first.iy; iy <= last.iy; ++iy) {
    for (std::int32_t ix = first.ix; ix <= last.ix; ++ix) {
      const MapCell& cell = mapper.map().at({ix, iy});
      const double truth = scene.height(cell_centre(ix, kSize), cell_centre(iy, kSize));
      if (cell.has_height() && static_cast<double>(cell.height_m) > truth + above) ++count;
    }
  }
  return count;
}

Camera coarse(Camera camera, int factor) {
  camera.intrinsics.width_px = static_cast<std::uint16_t>(camera.intrinsics.width_px / factor);
  camera.intrinsics.height_px = static_cast<std::uint16_t>(camera.intrinsics.height_px / factor);
  camera.intrinsics.fx_px /= factor;
  camera.intrinsics.fy_px /= factor;
  camera.intrinsics.cx_px = (camera.intrinsics.cx_px + 0.5) / factor - 0.5;
  camera.intrinsics.cy_px = (camera.intrinsics.cy_px + 0.5) / factor - 0.5;
  return camera;
}

// Scans seen 1, 2, 5; image full or so coarse that at most one point falls into a cell.
TEST(Ghosts, NoneIsLeftAfterThreeClearFrames) {
  for (const int scans : {1, 2, 5, 30}) {
    for (const int factor : {1, 2}) {
      for (const double height : {0.10, 0.20}) {
        Rig rig;
        const Camera camera = coarse(mini_cheetah_camera({0.28, 0, 0.34}, 0, 0.7), factor);
        Scene with;
        with.boxes.push_back({{0.75, -0.15, 0}, {0.95, 0.15, height}});
        for (int i = 0; i < scans; ++i) rig.see(with, camera, 0);
        EXPECT_GT(ghosts(*rig.mapper, Scene{}, {0.7, -0.2}, {1.0, 0.2}, 0.05), 20);
        for (int i = 0; i < 3; ++i) rig.see(Scene{}, camera, 0);
        EXPECT_EQ(ghosts(*rig.mapper, Scene{}, {0.5, -0.4}, {1.3, 0.4}, 0.05), 0)
            << scans << " scans, coarse " << factor << ", height " << height;
      }
    }
  }
}

// An object that moves every few frames leaves no trail.
TEST(Ghosts, AMovingObjectLeavesNoTrail) {
  Rig rig;
  const Camera camera = mini_cheetah_camera({0.28, 0, 0.34}, 0, 0.7);
  Scene scene;
  for (int i = 0; i < 60; ++i) {
    const double y = -0.6 + 0.02 * i;
    scene.boxes.assign(1, {{0.8, y, 0}, {0.9, y + 0.1, 0.2}});
    rig.see(scene, camera, 0);
  }
  for (int i = 0; i < 3; ++i) rig.see(scene, camera, 0);
  // Cells the object's own shadow covers stay as they are; the trail beside it must be gone.
  EXPECT_EQ(ghosts(*rig.mapper, scene, {0.5, -0.6}, {1.0, 0.5}, 0.05), 0);
}

// What is gone is not walkable: it falls back to bounded until the ground itself is measured.
TEST(Ghosts, AClearedCellIsBounded) {
  Rig rig;
  const Camera camera = mini_cheetah_camera({0.28, 0, 0.34}, 0, 0.7);
  Scene with;
  with.boxes.push_back({{0.75, -0.15, 0}, {0.95, 0.15, 0.2}});
  rig.see(with, camera, 0);
  std::uint32_t cleared = 0;
  for (int i = 0; i < 3; ++i) cleared += rig.see(Scene{}, camera, 0).cells_cleared;
  EXPECT_GT(cleared, 10u);
}

Scene staircase() {
  Scene scene;
  scene.boxes.push_back({{0.7, -0.5, 0}, {0.9, 0.5, 0.04}});
  scene.boxes.push_back({{0.9, -0.5, 0}, {1.1, 0.5, 0.08}});
  scene.boxes.push_back({{1.1, -0.5, 0}, {3.0, 0.5, 0.12}});
  scene.boxes.push_back({{0.6, 0.3, 0}, {0.66, 0.36, 0.25}});      // a post
  scene.boxes.push_back({{0.8, -0.45, 0.2}, {0.95, -0.3, 0.24}});  // a table top, free below
  return scene;
}

std::uint32_t cleared_in_static_scene(const Scene& scene, double camera_z, double down, int frames,
                                      double sway) {
  Rig rig;
  std::uint32_t cleared = 0;
  for (int i = 0; i < frames; ++i) {
    const double phase = 0.37 * i;
    const Vector3 position(0.28 + sway * std::sin(phase), sway * std::cos(1.7 * phase),
                           camera_z + 0.3 * sway * std::sin(2.3 * phase));
    Camera camera = mini_cheetah_camera(position, 0, down + sway * std::sin(0.9 * phase));
    camera.dropout = 0.01;
    cleared += rig.see(scene, camera, 0).cells_cleared;
  }
  return cleared;
}

TEST(StaticScene, NothingIsEverClearedAtGrazingAngles) {
  EXPECT_EQ(cleared_in_static_scene(staircase(), 0.34, 0.7, samples(200, 20), 0), 0u);
  EXPECT_EQ(cleared_in_static_scene(staircase(), 0.20, 0.25, samples(1000, 60), 0),
            0u);  // 14 degrees
  EXPECT_EQ(cleared_in_static_scene(Scene{}, 0.12, 0.15, samples(200, 20), 0), 0u);
}

TEST(StaticScene, NothingIsEverClearedWhileTheBodySways) {
  EXPECT_EQ(cleared_in_static_scene(staircase(), 0.34, 0.7, samples(400, 50), 0.02), 0u);
  EXPECT_EQ(cleared_in_static_scene(staircase(), 0.20, 0.25, samples(400, 50), 0.02), 0u);
}

}  // namespace
}  // namespace surefoot::mapping::test
