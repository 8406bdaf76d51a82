// Scenes that do not tell all: the prior must be kept in the directions that they leave open.
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/registration_parts.h"
#include "tests/support/samples.h"

namespace surefoot::registration {
namespace {

constexpr int kPoints = 8000;
const Prior kPrior{.X_TS = {}, .sigma_m = 0.05, .sigma_rad = 0.05};

using Scene = Vector3 (*)(Random&);

Vector3 floor_point(Random& random) {
  const double x_m = random.uniform(-0.6, 0.6);
  const double y_m = random.uniform(-0.6, 0.6);
  return {x_m, y_m, 0.0113};
}

// Floor and two walls along x.
Vector3 corridor_point(Random& random) {
  Vector3 p = floor_point(random);
  const std::uint32_t side = random.below(3);
  if (side == 0) return p;
  p.y() = side == 1 ? 0.6 : -0.6;
  p.z() = random.uniform(0.0, 0.5);
  return p;
}

// Two walls that meet, and the floor: all is told.
Vector3 corner_point(Random& random) {
  Vector3 p = floor_point(random);
  const std::uint32_t side = random.below(3);
  if (side == 0) return p;
  p[side == 1 ? 0 : 1] = 0.6;
  p.z() = random.uniform(0.0, 0.5);
  return p;
}

std::vector<Vector3> scan(Scene scene, double noise_m, Random& random, const Vector3& offset_m) {
  std::vector<Vector3> points(kPoints);
  for (Vector3& p : points) {
    p = scene(random);
    for (int axis = 0; axis < 3; ++axis) p[axis] += noise_m * random.normal();
    p += offset_m;
  }
  return points;
}

class Degenerate : public ::testing::TestWithParam<double> {
 protected:
  Status run(Scene scene, std::uint64_t seed, const Vector3& offset_m) {
    Random random(seed, 21);
    EXPECT_TRUE(bench_.configure({}));
    bench_.fill(*bench_.target, scan(scene, GetParam(), random, Vector3::Zero()));
    bench_.fill(*bench_.source, scan(scene, GetParam(), random, offset_m));
    return bench_.align(kPrior);
  }
  tests::Workbench bench_;
};

// The source sees the floor 5 mm too high; that it is also 6 mm ahead and 4 mm aside nobody can
// know.
TEST_P(Degenerate, FlatFloorMovesInHeightAndTiltOnly) {
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(tests::samples(10, 2)); ++seed) {
    ASSERT_EQ(run(floor_point, seed, {0.006, -0.004, 0.005}), Status::kOk);
    const Registration& result = bench_.result;
    EXPECT_EQ(result.observed_directions, 3);
    EXPECT_NEAR(result.X_TS.origin.m.x(), 0.0, 2e-4);
    EXPECT_NEAR(result.X_TS.origin.m.y(), 0.0, 2e-4);
    EXPECT_NEAR(result.X_TS.origin.m.z(), -0.005, 5e-4);
    const Vector3 turn_rad = geometry::to_rotation_vector(result.X_TS.rotation.matrix);
    EXPECT_NEAR(turn_rad.z(), 0.0, 1e-4);
    // What is not observed keeps the prior's variance; what is observed is known better.
    EXPECT_NEAR(result.covariance(0, 0), math::square(kPrior.sigma_m), 1e-5);
    EXPECT_NEAR(result.covariance(1, 1), math::square(kPrior.sigma_m), 1e-5);
    EXPECT_NEAR(result.covariance(5, 5), math::square(kPrior.sigma_rad), 1e-5);
    EXPECT_LT(result.covariance(2, 2), math::square(0.002));
    EXPECT_NEAR(result.unobserved.trace(), 3.0, 1e-9);
  }
}

TEST_P(Degenerate, CorridorLeavesItsLengthOpen) {
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(tests::samples(10, 2)); ++seed) {
    ASSERT_EQ(run(corridor_point, seed, {0.006, -0.004, 0.005}), Status::kOk);
    const Registration& result = bench_.result;
    EXPECT_EQ(result.observed_directions, 5);
    EXPECT_NEAR(result.X_TS.origin.m.x(), 0.0, 2e-3);
    EXPECT_NEAR(result.X_TS.origin.m.y(), 0.004, 2e-3);
    EXPECT_NEAR(result.X_TS.origin.m.z(), -0.005, 2e-3);
    EXPECT_GT(result.covariance(0, 0), 0.5 * math::square(kPrior.sigma_m));
    EXPECT_LT(result.covariance(1, 1), math::square(0.005));
  }
}

TEST_P(Degenerate, CornerTellsAll) {
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(tests::samples(10, 2)); ++seed) {
    ASSERT_EQ(run(corner_point, seed, {0.006, -0.004, 0.005}), Status::kOk);
    const Registration& result = bench_.result;
    EXPECT_EQ(result.observed_directions, 6);
    EXPECT_LT((result.X_TS.origin.m - Vector3(-0.006, 0.004, -0.005)).norm(), 3e-3);
    EXPECT_EQ(result.unobserved.norm(), 0.0);
  }
}

// A flat floor, seen twice by a sensor whose pictures have a ripple of half a millimetre. It goes
// where the sensor goes: taken for structure, it says that the sensor has not moved.
TEST(Ripple, OfTheSensorIsNoStructureWhenNormalsAreGivenAnError) {
  constexpr double kRipple_m = 0.0005;
  constexpr double kLength_m = 0.08;
  const auto picture = [](Random& random) {
    std::vector<Vector3> points(kPoints);
    for (Vector3& p : points) {
      p = floor_point(random) * 0.5;
      p.z() += kRipple_m * math::sin(2 * math::kPi / kLength_m * p.x()) +
               kRipple_m * math::sin(2 * math::kPi / kLength_m * p.y());
    }
    return points;
  };
  const Vector3 way_m(0.006, -0.004, 0.0);
  for (const double error_rad : {0.0, 0.04}) {
    Random random(1, 22);
    tests::Workbench bench;
    RegistrationConfig config;
    config.cell_m = 0.015;
    config.normal_error_rad = error_rad;
    ASSERT_TRUE(bench.configure(config));
    bench.fill(*bench.target, picture(random));
    bench.fill(*bench.source, picture(random));
    ASSERT_EQ(bench.align({{{}, {way_m}}, 0.01, 0.01}), Status::kOk);
    const Vector3 off_m = bench.result.X_TS.origin.m - way_m;
    if (error_rad > 0) {
      EXPECT_EQ(bench.result.observed_directions, 3);
      EXPECT_LT(off_m.norm(), 2e-4);
    } else {
      EXPECT_GT(bench.result.observed_directions, 3);
      EXPECT_GT(off_m.norm(), 0.004);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Noise, Degenerate, ::testing::Values(0.0, 0.001, 0.003, 0.006));

}  // namespace
}  // namespace surefoot::registration
