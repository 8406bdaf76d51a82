// The robot that is thrown on the ground: what is drawn, and that it lies there.
#include "sim_hal/robot/random_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/unit/sim_hal/sim_fixture.h"

namespace surefoot::sim {
namespace {

SimulatorConfig thrown() {
  SimulatorConfig config;
  config.scenario.start.kind = StartConfig::Kind::kRandomPose;
  return config;
}

Matrix3 rotation_of(const Truth& truth) {
  const std::array<double, 4>& q = truth.q_WB_wxyz;
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

// Lowest point of trunk and feet over level ground.
double lowest_m(const Truth& truth, const robot::RobotModel& model) {
  double lowest = truth.p_WB_m[2];
  const Matrix3 R = rotation_of(truth);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    lowest -= 0.5 * std::fabs(R(2, axis)) * model.trunk_size_m[static_cast<std::size_t>(axis)];
  }
  for (const FootTruth& foot : truth.feet) {
    lowest = std::min(lowest, foot.p_WF_m[2] - model.foot_radius_m);
  }
  return lowest;
}

double supported_N(const Truth& truth) {
  double force = 0;
  for (const FootTruth& foot : truth.feet) force += foot.force_W_N[2];
  return force;
}

// A uniform rotation turns any axis to a uniform point of the sphere: its height is uniform.
TEST(RandomPose, RotationsAreUniform) {
  Random random(3, 6);
  constexpr int kDraws = 20000;
  constexpr int kBins = 10;
  std::array<std::array<int, kBins>, 9> counts{};
  Matrix3 mean = Matrix3::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Matrix3 R = random_rotation(random);
    ASSERT_NEAR((R * R.transpose() - Matrix3::Identity()).norm(), 0.0, 1e-12);
    ASSERT_NEAR(R.determinant(), 1.0, 1e-12);
    mean += R / kDraws;
    for (Eigen::Index k = 0; k < 9; ++k) {
      const double share = std::min(0.999999, 0.5 * (R(k / 3, k % 3) + 1.0));
      ++counts[static_cast<std::size_t>(k)][static_cast<std::size_t>(share * kBins)];
    }
  }
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 0.02);  // 5 sigma of a mean of uniform values
  for (const auto& bins : counts) {
    for (const int count : bins) EXPECT_NEAR(count, kDraws / kBins, 5 * 42);
  }
}

TEST(RandomPose, LegsAreBetweenTheirStops) {
  const robot::RobotModel model = mini_cheetah();
  Random random(4, 6);
  robot::LegVector low = robot::LegVector::Constant(10);
  robot::LegVector high = robot::LegVector::Constant(-10);
  for (int i = 0; i < 500; ++i) {
    for (const robot::LegVector& leg : random_legs(model, random)) {
      low = low.cwiseMin(leg);
      high = high.cwiseMax(leg);
    }
  }
  for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double range = model.actuators[i].max_rad - model.actuators[i].min_rad;
    EXPECT_GE(low[k], model.actuators[i].min_rad);
    EXPECT_LE(high[k], model.actuators[i].max_rad);
    EXPECT_GT(high[k] - low[k], 0.98 * range);
  }
}

// At rest, not in the ground, not in itself; limp drives leave it there.
TEST(RandomPose, ARunBeginsWithTheRobotAtRestOnTheGround) {
  std::set<int> ways;  // the axis of the trunk that points up
  std::set<std::uint64_t> states;
  for (std::uint64_t seed = 1; seed <= 14; ++seed) {
    Rig rig({}, thrown(), seed);
    const Truth before = rig.simulator->truth();
    states.insert(rig.simulator->state_hash());
    EXPECT_GT(lowest_m(before, rig.model), -0.002) << seed;
    EXPECT_LT(lowest_m(before, rig.model), 0.05) << seed;
    EXPECT_EQ(before.stamp, TimeNs{});
    EXPECT_LT(std::hypot(before.p_WB_m[0], before.p_WB_m[1]), 0.6) << seed;
    for (int i = 0; i < 250; ++i) rig.tick();
    const Truth after = rig.simulator->truth();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(after.p_WB_m[axis], before.p_WB_m[axis], 0.005) << seed;
    }
    EXPECT_LT((rotation_of(after) - rotation_of(before)).norm(), 0.03) << seed;
    EXPECT_LE(supported_N(after), 9.81 * 9.1) << seed;
    EXPECT_LT(rig.simulator->counters().deepest_self_overlap_m, 0.006) << seed;
    EXPECT_EQ(rig.simulator->counters().contacts_dropped, 0u) << seed;
    Eigen::Index axis = 0;
    const Matrix3 R = rotation_of(before);
    R.row(2).cwiseAbs().maxCoeff(&axis);
    ways.insert(R(2, axis) > 0 ? static_cast<int>(axis) + 1 : -static_cast<int>(axis) - 1);
  }
  EXPECT_EQ(states.size(), 14u);
  EXPECT_TRUE(ways.contains(3)) << "never on its belly";
  EXPECT_TRUE(ways.contains(-3)) << "never on its back";
}

TEST(RandomPose, SameSeedSameBits) {
  const Rig first({}, thrown(), 5);
  const Rig second({}, thrown(), 5);
  EXPECT_EQ(first.simulator->state_hash(), second.simulator->state_hash());
}

TEST(RandomPose, OnBlocksItLiesOnTheBlocks) {
  WorldSpec world;
  world.generator = Generator::kClutter;
  world.height_m = 0.05;
  world.cover = 0.5;
  SimulatorConfig config = thrown();
  config.scenario.start.x_m = 1.5;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Rig rig(world, config, seed);
    const Truth truth = rig.simulator->truth();
    EXPECT_NEAR(truth.p_WB_m[0], 1.5, 0.6);
    EXPECT_GT(lowest_m(truth, rig.model), -0.002) << seed;
    for (const FootTruth& foot : truth.feet) {
      const double ground = rig.simulator->terrain_height_m(foot.p_WF_m[0], foot.p_WF_m[1]);
      EXPECT_GT(foot.p_WF_m[2] - rig.model.foot_radius_m, ground - 0.003) << seed;
    }
  }
}

TEST(StartPose, FoldedCanBeSetDownElsewhere) {
  SimulatorConfig config;
  const Rig origin({}, config);
  config.scenario.start.x_m = 0.7;
  const Rig ahead({}, config);
  const Truth a = origin.simulator->truth();
  const Truth b = ahead.simulator->truth();
  EXPECT_NEAR(b.p_WB_m[0] - a.p_WB_m[0], 0.7, 1e-12);
  EXPECT_NEAR(b.p_WB_m[1], a.p_WB_m[1], 1e-12);
  EXPECT_NEAR(b.p_WB_m[2], a.p_WB_m[2], 1e-12);
}

}  // namespace
}  // namespace surefoot::sim
