// Forces of standing feet, against the equations of statics.
#include "core/control/load_sharing.h"

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace surefoot::control {
namespace {

constexpr double kWeight_N = 31.0;

planning::Feet uneven_feet(Random& random) {
  planning::Feet feet;
  for (std::size_t i = 0; i < robot::kLegs; ++i) {
    const double along_m = random.uniform(-0.03, 0.03);
    const double across_m = random.uniform(-0.02, 0.02);
    const double up_m = random.uniform(-0.05, 0.05);
    feet[i] =
        Vector3(robot::front_sign(i) * 0.1 + along_m, robot::left_sign(i) * 0.07 + across_m, up_m);
  }
  return feet;
}

Vector3 sum_of(const std::array<Vector3, robot::kLegs>& forces) {
  Vector3 sum = Vector3::Zero();
  for (const Vector3& force : forces) sum += force;
  return sum;
}

Vector3 moment_of(const std::array<Vector3, robot::kLegs>& forces, const planning::Feet& feet,
                  const Vector3& centre) {
  Vector3 moment = Vector3::Zero();
  for (std::size_t i = 0; i < robot::kLegs; ++i) moment += (feet[i] - centre).cross(forces[i]);
  return moment;
}

// Level or not, at rest or pushed sideways, on four feet or on three.
TEST(LoadSharing, TheForcesAddUpAndTurnNothing) {
  Random random(1);
  int carried = 0;
  for (int k = 0; k < 1000; ++k) {
    const planning::Feet feet = uneven_feet(random);
    LoadShares shares{1, 1, 1, 1};
    if (k % 3 == 0) shares[random.below(robot::kLegs)] = random.uniform(0.0, 1.0);
    const double x_m = random.uniform(-0.01, 0.01);
    const double y_m = random.uniform(-0.01, 0.01);
    const double x_N = random.uniform(-2.0, 2.0);
    const double y_N = random.uniform(-2.0, 2.0);
    const Vector3 centre(x_m, y_m, 0.13);
    const Vector3 force(x_N, y_N, kWeight_N);
    const auto forces = share_load(feet, shares, centre, force);
    bool all_carry = true;
    for (std::size_t i = 0; i < robot::kLegs; ++i) {
      EXPECT_GE(forces[i][2], 0.0);
      all_carry = all_carry && (forces[i][2] > 0.0 || shares[i] == 0.0);
    }
    if (!all_carry) continue;
    ++carried;
    EXPECT_LT((sum_of(forces) - force).norm(), 1e-6);
    EXPECT_LT(moment_of(forces, feet, centre).head<2>().norm(), 1e-6);
  }
  EXPECT_GT(carried, 800);
}

TEST(LoadSharing, AFootInTheAirIsAskedForNothing) {
  Random random(2);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    LoadShares shares{1, 1, 1, 1};
    shares[leg] = 0;
    const auto forces =
        share_load(uneven_feet(random), shares, Vector3(0, 0, 0.13), Vector3(0, 0, kWeight_N));
    EXPECT_EQ(forces[leg].norm(), 0.0);
  }
}

// A trunk that is pushed ahead leans on its hind feet.
TEST(LoadSharing, APushAheadLoadsTheHindFeet) {
  planning::Feet feet;
  for (std::size_t i = 0; i < robot::kLegs; ++i) {
    feet[i] = Vector3(robot::front_sign(i) * 0.1, robot::left_sign(i) * 0.07, 0.0);
  }
  const auto forces =
      share_load(feet, {1, 1, 1, 1}, Vector3(0, 0, 0.13), Vector3(3.1, 0.0, kWeight_N));
  const double front_N = forces[robot::kFrontLeft][2] + forces[robot::kFrontRight][2];
  // The line of the force meets the ground 13 mm behind the middle.
  EXPECT_NEAR(front_N, kWeight_N * (0.1 - 0.013) / 0.2, 1e-6);
}

TEST(LoadSharing, FeetInALineStillGetFiniteForces) {
  planning::Feet feet;
  for (std::size_t i = 0; i < robot::kLegs; ++i) {
    feet[i] = Vector3(0.1 * static_cast<double>(i), 0.0, 0.0);
  }
  const auto forces =
      share_load(feet, {1, 1, 1, 1}, Vector3(0.1, 0.02, 0.13), Vector3(0, 0, kWeight_N));
  for (const Vector3& force : forces) EXPECT_TRUE(force.allFinite());
}

}  // namespace
}  // namespace surefoot::control
