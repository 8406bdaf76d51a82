// The ray caster against exact distances and a brute-force oracle; the errors against their model.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "core/base/random.h"
#include "sim_hal/robot/articulation.h"
#include "sim_hal/sensors/sim_depth_camera_port.h"
#include "sim_hal/world/terrain_index.h"
#include "tests/unit/sim_hal/sim_fixture.h"

namespace surefoot::sim {
namespace {

WorldSpec clutter(double height_m) {
  WorldSpec world;
  world.generator = Generator::kClutter;
  world.height_m = height_m;
  world.cover = 0.5;
  return world;
}

// First t along a fine march at which the point is inside a box or under the ground, refined by
// bisection: slow, and shares nothing with the code under test.
double oracle(const Terrain& terrain, const Vector3& origin, const Vector3& direction,
              double t_max) {
  const auto inside = [&](double t) {
    const Vector3 p = origin + t * direction;
    const double ground =
        terrain.grid.contains(p.x(), p.y()) ? terrain.grid.height_m(p.x(), p.y()) : 0.0;
    if (p.z() <= ground) return true;
    for (const TerrainBox& box : terrain.boxes) {
      if (p.z() >= box.bottom_m && p.z() <= box.top_m && box.covers(p.x(), p.y())) return true;
    }
    return false;
  };
  constexpr double kStep = 0.0005;
  for (double t = kStep; t < t_max; t += kStep) {
    if (!inside(t)) continue;
    double low = t - kStep;
    double high = t;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      (inside(middle) ? high : low) = middle;
    }
    return high;
  }
  return kNoHit;
}

struct Agreement {
  int rays = 0;
  int wrong = 0;
  double worst_m = 0;
};

Agreement compare(const Terrain& terrain, std::uint64_t seed, int rays) {
  const TerrainIndex index(terrain);
  Random random(seed);
  Agreement result;
  for (int i = 0; i < rays; ++i) {
    Vector3 origin;
    origin.x() = random.uniform(-0.5, 3.2);
    origin.y() = random.uniform(-0.8, 0.8);
    origin.z() = terrain.height_m(origin.x(), origin.y()) + random.uniform(0.01, 0.4);
    Vector3 direction;
    direction.x() = random.uniform(-1.0, 1.0);
    direction.y() = random.uniform(-1.0, 1.0);
    direction.z() = random.uniform(-1.0, 0.1);
    const double expected = oracle(terrain, origin, direction, 1.5);
    const double got = index.cast(origin, direction, 1.5);
    ++result.rays;
    if (expected == kNoHit && got == kNoHit) continue;
    const double error = std::fabs(got - expected);
    if (!(error < 1e-6)) ++result.wrong;  // the march steps over corners thinner than its stride
    if (error < kNoHit) result.worst_m = std::max(result.worst_m, error);
  }
  return result;
}

TEST(Rays, AgreeWithBruteForceOnBoxes) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Agreement a = compare(make_terrain(clutter(0.1), seed), seed, 1500);
    EXPECT_LE(a.wrong, 3) << a.worst_m;
  }
}

TEST(Rays, AgreeWithBruteForceOnHeightFields) {
  WorldSpec world;
  world.generator = Generator::kRamps;
  world.slope_rad = 0.26;
  Terrain terrain = make_terrain(world, 4);
  Agreement a = compare(terrain, 4, 1500);
  EXPECT_LE(a.wrong, 3) << a.worst_m;
  // Rough ground: every node its own height.
  Random random(5);
  for (double& z : terrain.grid.z_m) z = random.uniform(-0.05, 0.08);
  a = compare(terrain, 5, 1500);
  EXPECT_LE(a.wrong, 8) << a.worst_m;
}

TEST(Rays, AlongTheAxesAndGridLines) {
  Terrain terrain;
  TerrainBox box;
  box.x_m = 1;
  box.half_length_m = 0.1;
  box.half_width_m = 0.2;
  box.top_m = 0.1;
  terrain.boxes.push_back(box);
  const TerrainIndex index(terrain);
  EXPECT_DOUBLE_EQ(index.cast({0, 0, 0.05}, {1, 0, 0}, 5), 0.9);
  EXPECT_DOUBLE_EQ(index.cast({0, 0.2, 0.05}, {1, 0, 0}, 5), 0.9);  // grazes the side
  EXPECT_EQ(index.cast({0, 0.21, 0.05}, {1, 0, 0}, 5), kNoHit);
  EXPECT_EQ(index.cast({0, 0, 0.05}, {-1, 0, 0}, 5), kNoHit);
  EXPECT_DOUBLE_EQ(index.cast({1, 0, 0.5}, {0, 0, -1}, 5), 0.4);
  EXPECT_DOUBLE_EQ(index.cast({1.5, 0, 0.5}, {0, 0, -1}, 5), 0.5);
  EXPECT_EQ(index.cast({1, 0, 0.5}, {0, 0, -1}, 0.3), kNoHit);  // out of range
  EXPECT_EQ(index.cast({1, 0, 0.5}, {0, 0, 1}, 5), kNoHit);
}

TEST(Rays, CapsuleAgreesWithItsDistanceField) {
  Random random(11);
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    Capsule capsule;
    for (Vector3* end : {&capsule.a_m, &capsule.b_m}) {
      end->x() = random.uniform(-0.3, 0.3);
      end->y() = random.uniform(-0.3, 0.3);
      end->z() = random.uniform(0.2, 0.8);
    }
    if (i % 10 == 0) capsule.b_m = capsule.a_m;
    capsule.radius_m = random.uniform(0.01, 0.1);
    Vector3 direction(0, 0, 1);
    direction.x() = random.uniform(-0.5, 0.5);
    direction.y() = random.uniform(-0.5, 0.5);
    const auto distance = [&](const Vector3& p) {
      const Vector3 axis = capsule.b_m - capsule.a_m;
      const double s = axis.squaredNorm() == 0
                           ? 0.0
                           : std::clamp((p - capsule.a_m).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
      return (p - capsule.a_m - s * axis).norm() - capsule.radius_m;
    };
    // Sphere tracing.
    double t = 0;
    for (int k = 0; k < 2000 && t < 1.5 && distance(t * direction) > 1e-9; ++k) {
      t += distance(t * direction) / direction.norm();
    }
    const double got = cast_capsule(capsule, direction);
    if (t < 1.5) {
      ++hits;
      EXPECT_NEAR(got, t, 1e-5);
    } else {
      EXPECT_EQ(got, kNoHit);
    }
  }
  EXPECT_GT(hits, 200);
}

// A camera alone over a terrain.
struct Scene {
  explicit Scene(const WorldSpec& world = {}, const DepthNoiseConfig& noise = {},
                 const FaultConfig& faults = {}, double disparity_noise_px = 0)
      : specification(mini_cheetah().depth_camera),
        terrain(make_terrain(world, 1)),
        index(terrain) {
    specification.disparity_noise_px = disparity_noise_px;
    camera = std::make_unique<SimDepthCameraPort>(specification, noise, faults, index, 1);
  }
  // Level trunk, origin at the given height over x = 0.
  bool shoot(TimeNs now, double height_m, std::span<const Capsule> shapes = {}) {
    camera->expose(now, Vector3(0, 0, height_m), Matrix3::Identity(), shapes);
    camera->advance(now);
    hal::DepthCameraPort& port = *camera;
    return ok(port.receive(*frame));
  }
  robot::DepthCameraSpecification specification;
  Terrain terrain;
  TerrainIndex index;
  std::unique_ptr<SimDepthCameraPort> camera;
  std::unique_ptr<hal::DepthFrame> frame = std::make_unique<hal::DepthFrame>();
};

TEST(SimDepthCamera, SeesThePlaneAtItsExactDistance) {
  Scene scene;
  ASSERT_TRUE(scene.shoot(milliseconds(33), 0.3));
  const hal::PinholeIntrinsics& k = scene.frame->intrinsics;
  ASSERT_EQ(k.width_px, 160);
  ASSERT_EQ(k.height_px, 90);
  const double pitch = scene.specification.mount.roll_pitch_yaw_rad[1];
  const double height = 0.3 + scene.specification.mount.position_B_m[2];
  int seen = 0;
  for (int v = 0; v < 90; ++v) {
    for (int u = 0; u < 160; ++u) {
      // The ray's fall per metre of z-depth: forward tilt plus the pixel's own y.
      const double fall = std::sin(pitch) + (v - k.cy_px) / k.fy_px * std::cos(pitch);
      const double z = fall > 0 ? height / fall : 1e9;
      const double measured = scene.frame->depth[static_cast<std::size_t>(v * 160 + u)] * 0.001;
      if (z > scene.specification.max_range_m || z < scene.specification.min_range_m) {
        EXPECT_EQ(measured, 0.0);
      } else {
        ++seen;
        EXPECT_NEAR(measured, z, 0.00051);
      }
    }
  }
  EXPECT_GT(seen, 9000);
}

TEST(SimDepthCamera, SeesTheRobotsOwnLegs) {
  Scene scene;
  const std::array<Capsule, 1> leg{{{Vector3(0.5, 0.1, 0.25), Vector3(0.5, 0.1, 0.02), 0.02}}};
  ASSERT_TRUE(scene.shoot(milliseconds(33), 0.3));
  const std::vector<std::uint16_t> without(scene.frame->depth.begin(),
                                           scene.frame->depth.begin() + 160 * 90);
  ASSERT_TRUE(scene.shoot(milliseconds(66), 0.3, leg));
  // Every pixel, by the caster without windows.
  const Matrix3 r = rotation_y(scene.specification.mount.roll_pitch_yaw_rad[1]);
  Matrix3 optical;
  optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Matrix3 rotation_WC = r * optical;
  const Vector3 eye(0.28, 0, 0.33);
  const Capsule in_C{rotation_WC.transpose() * (leg[0].a_m - eye),
                     rotation_WC.transpose() * (leg[0].b_m - eye), 0.02};
  const hal::PinholeIntrinsics& k = scene.frame->intrinsics;
  int hidden = 0;
  for (std::size_t i = 0; i < without.size(); ++i) {
    const Vector3 ray((static_cast<double>(i % 160) - k.cx_px) / k.fx_px,
                      (static_cast<double>(i / 160) - k.cy_px) / k.fy_px, 1);
    const double hit = cast_capsule(in_C, ray);
    const double before = without[i] == 0 ? kNoHit : without[i] * 0.001;
    if (hit < before && hit > 0.17) {
      ++hidden;
      EXPECT_NEAR(scene.frame->depth[i] * 0.001, hit, 0.00051);
    } else {
      EXPECT_EQ(scene.frame->depth[i], hit < 0.17 ? 0 : without[i]);
    }
  }
  EXPECT_GT(hidden, 100);
}

TEST(SimDepthCamera, NoiseGrowsWithTheSquareOfRange) {
  DepthNoiseConfig noise;
  noise.correlated_part = 0.5;
  Scene scene({}, noise, {}, 0.1);
  // disparity = native focal length * baseline / z
  const double constant = 848 / 2 / std::tan(1.518 / 2) * 0.05;
  std::array<double, 3> squares{};
  std::array<double, 3> expected{};
  std::array<int, 3> count{};
  const std::array<int, 3> rows{85, 60, 38};
  for (int shot = 1; shot <= 60; ++shot) {
    ASSERT_TRUE(scene.shoot(milliseconds(33 * shot), 0.3));
    for (std::size_t r = 0; r < 3; ++r) {
      for (int u = 0; u < 160; ++u) {
        const auto i = static_cast<std::size_t>(rows[r] * 160 + u);
        const double z = scene.camera->exact_depth_m()[i];
        const double error = scene.frame->depth[i] * 0.001 - z;
        squares[r] += error * error;
        expected[r] = z * z / constant * 0.1;
        ++count[r];
      }
    }
  }
  for (std::size_t r = 0; r < 3; ++r) {
    const double rounding = 0.001 / std::sqrt(12.0);
    EXPECT_NEAR(std::sqrt(squares[r] / count[r]), std::hypot(expected[r], rounding),
                0.06 * expected[r]);
  }
  EXPECT_GT(expected[2], 3 * expected[0]);
}

TEST(SimDepthCamera, NoiseIsCommonToAPatchAsStated) {
  DepthNoiseConfig noise;
  noise.correlated_part = 0.6;
  Scene scene({}, noise, {}, 0.3);
  double within = 0;
  double across = 0;
  double variance = 0;
  for (int shot = 1; shot <= 60; ++shot) {
    ASSERT_TRUE(scene.shoot(milliseconds(33 * shot), 0.5));
    const auto error = [&](int u) {
      const auto i = static_cast<std::size_t>(60 * 160 + u);
      return scene.frame->depth[i] * 0.001 - scene.camera->exact_depth_m()[i];
    };
    for (int u = 0; u + 4 < 160; u += 4) {
      within += error(u) * error(u + 2);
      across += error(u + 3) * error(u + 4);
      variance += error(u) * error(u);
    }
  }
  EXPECT_NEAR(within / variance, 0.6, 0.08);
  EXPECT_NEAR(across / variance, 0.0, 0.08);
}

TEST(SimDepthCamera, DropOutsComeWithTheirProbabilityAndAreCounted) {
  DepthNoiseConfig noise;
  noise.random_dropout = 0.1;
  Scene flat({}, noise);
  int zero = 0;
  int seen = 0;
  for (int shot = 1; shot <= 10; ++shot) {
    ASSERT_TRUE(flat.shoot(milliseconds(33 * shot), 0.3));
    for (std::size_t i = 0; i < 160 * 90; ++i) {
      const double z = flat.camera->exact_depth_m()[i];
      if (z < 0.17 || z > 3.0) continue;
      ++seen;
      zero += flat.frame->depth[i] == 0 ? 1 : 0;
    }
  }
  EXPECT_NEAR(static_cast<double>(zero) / seen, 0.1, 0.005);
  EXPECT_EQ(flat.camera->depth_counters().random_dropouts, static_cast<std::uint64_t>(zero));
  EXPECT_EQ(flat.camera->depth_counters().edge_dropouts, 0u);

  noise.random_dropout = 0;
  noise.edge_dropout = 1;
  Scene boxes(clutter(0.15), noise);
  ASSERT_TRUE(boxes.shoot(milliseconds(33), 0.3));
  // Whatever jumps by more than 4 px of disparity between neighbours is gone, on the near side or
  // the far.
  const double constant = 848 / 2 / std::tan(1.518 / 2) * 0.05;
  int jumps = 0;
  for (std::size_t i = 1; i < 160 * 90; ++i) {
    const double a = boxes.camera->exact_depth_m()[i - 1];
    const double b = boxes.camera->exact_depth_m()[i];
    if (i % 160 == 0 || std::fabs(constant / a - constant / b) < 4) continue;
    ++jumps;
    EXPECT_TRUE(boxes.frame->depth[i] == 0 || boxes.frame->depth[i - 1] == 0);
  }
  EXPECT_GT(jumps, 20);
  EXPECT_GT(boxes.camera->depth_counters().edge_dropouts, 100u);
  EXPECT_LT(boxes.camera->depth_counters().edge_dropouts, 4000u);
}

TEST(SimDepthCamera, DeliversWithLatencyUnderTheExposuresStamp) {
  SimulatorConfig config;
  config.depth.latency_s = 0.030;
  Rig rig({}, config);
  const auto frame = std::make_unique<hal::DepthFrame>();
  std::vector<double> delays;
  std::uint32_t expected = 0;
  TimeNs last;
  for (int i = 0; i < 500; ++i) {
    rig.tick();
    while (ok(rig.board.depth_camera->receive(*frame))) {
      delays.push_back((rig.time - frame->stamp).seconds());
      EXPECT_EQ(frame->sequence, expected++);
      if (delays.size() > 1) {
        EXPECT_NEAR((frame->stamp - last).seconds(), 1.0 / 30, 0.0006);
      }
      last = frame->stamp;
    }
  }
  EXPECT_EQ(delays.size(), 29u);
  for (const double delay : delays) {
    EXPECT_GE(delay, 0.030);
    EXPECT_LE(delay, 0.0321);
  }
}

TEST(SimDepthCamera, AnOutageLosesExposuresAndShowsAsAGap) {
  SimulatorConfig config;
  config.faults.camera_off_from_s = 0.2;
  config.faults.camera_off_until_s = 0.4;
  Rig rig({}, config);
  const auto frame = std::make_unique<hal::DepthFrame>();
  for (int i = 0; i < 300; ++i) {
    rig.tick();
    while (ok(rig.board.depth_camera->receive(*frame))) {
    }
  }
  EXPECT_EQ(rig.simulator->counters().camera_exposures_lost, 6u);
  EXPECT_EQ(rig.board.depth_camera->counters().gaps, 6u);
}

TEST(SimDepthCamera, TiltedMountAndPoseLandOnTheGround) {
  // Points deprojected with the true pose lie on the true ground: mount, pose and intrinsics agree.
  Scene scene(clutter(0.08));
  scene.specification.mount.roll_pitch_yaw_rad = {0.05, 0.5, 0.1};
  scene.camera = std::make_unique<SimDepthCameraPort>(scene.specification, DepthNoiseConfig{},
                                                      FaultConfig{}, scene.index, 1);
  const Matrix3 rotation_WB = rotation_z(0.2) * rotation_y(-0.1) * rotation_x(0.08);
  const Vector3 p_WB(0.1, -0.05, 0.32);
  scene.camera->expose(milliseconds(33), p_WB, rotation_WB, {});
  scene.camera->advance(milliseconds(33));
  hal::DepthCameraPort& port = *scene.camera;
  ASSERT_TRUE(ok(port.receive(*scene.frame)));
  const hal::PinholeIntrinsics& k = scene.frame->intrinsics;
  const Matrix3 rotation_BX = mount_rotation(scene.specification.mount);
  int on_top = 0;
  int points = 0;
  for (std::size_t i = 0; i < 160 * 90; ++i) {
    if (scene.frame->depth[i] == 0) continue;
    const double z = scene.frame->depth[i] * 0.001;
    const Vector3 p_C((static_cast<double>(i % 160) - k.cx_px) / k.fx_px * z,
                      (static_cast<double>(i / 160) - k.cy_px) / k.fy_px * z, z);
    const Vector3 p_X(p_C.z(), -p_C.x(), -p_C.y());
    const Vector3 p_W = p_WB + rotation_WB * (Vector3(0.28, 0, 0.03) + rotation_BX * p_X);
    ++points;
    on_top += std::fabs(p_W.z() - scene.terrain.height_m(p_W.x(), p_W.y())) < 0.002 ? 1 : 0;
  }
  EXPECT_GT(points, 5000);
  EXPECT_GT(on_top, points * 70 / 100);  // the rest are side faces
}

}  // namespace
}  // namespace surefoot::sim
