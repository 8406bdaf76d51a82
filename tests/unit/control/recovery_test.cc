// Getting up: one resting pose of each class, with joints that follow their commands and a trunk
// that turns over when a roll has been made.
#include "core/control/recovery.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "core/geometry/rotations.h"

namespace surefoot::control {
namespace {

constexpr double kStep_s = 0.002;
constexpr double kPi = 3.14159265358979;
constexpr std::array<double, 3> kFolded_rad{0.0, -1.4, 2.7};

Matrix3 rotation_x(double rad) { return geometry::from_roll_pitch_yaw(rad, 0.0, 0.0); }
Matrix3 rotation_y(double rad) { return geometry::from_roll_pitch_yaw(0.0, rad, 0.0); }

RecoveryConfig config() {
  RecoveryConfig c;
  c.upright_tilt_rad = 0.7;
  c.quiet_rad_s = 0.2;
  c.quiet_s = 0.1;
  c.speed_rad_s = 8.0;
  c.kp_Nm_rad = 60.0;
  c.kd_Nm_s_rad = 1.5;
  c.limp_damping_Nm_s_rad = 1.0;
  c.max_rolls = 4;
  const RollKeyframe keyframes[] = {{0.05, {-1.4, -1.6, 2.75}, {0.9, -3.1, 2.75}},
                                    {0.20, {0.0, -1.4, 2.7}, {1.4, -3.4, 0.7}}};
  for (const RollKeyframe& keyframe : keyframes) EXPECT_TRUE(ok(c.roll.push_back(keyframe)));
  return c;
}

estimation::RobotState lying(double roll_rad, const std::array<double, 3>& leg_rad = kFolded_rad) {
  estimation::RobotState state;
  state.R_OB = rotation_x(roll_rad);
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    const std::size_t i = joint % robot::kJointsPerLeg;
    const double sign = i == 0 ? robot::left_sign(joint / robot::kJointsPerLeg) : 1.0;
    state.joints[joint].position_rad = sign * leg_rad[i];
  }
  return state;
}

// What a robot does that obeys: joints follow, but for one that may be held; a roll turns the trunk
// upright, `turns` permitting.
class World {
 public:
  World(const RecoveryConfig& config, estimation::RobotState start) : state(start) {
    recovery.reset(config, robot::RobotModel{}, kFolded_rad);
    recovery.begin();
    recovery.start();
  }

  void run(double longest_s) {
    for (double t = 0; t < longest_s && !recovery.done() && !recovery.failed(); t += kStep_s) {
      const actuation::JointCommands& commands = recovery.update(state, kStep_s);
      elapsed_s += kStep_s;
      note(recovery.stage());
      follow(commands);
      if (recovery.rolls() > turned && recovery.stage() == RecoveryStage::kFoldOut) {
        ++turned;
        if (turned > rolls_in_vain) state.R_OB = Matrix3::Identity();
      }
    }
  }

  bool has_been(RecoveryStage stage) const {
    return std::find(stages.begin(), stages.end(), stage) != stages.end();
  }

  Recovery recovery;
  estimation::RobotState state;
  int rolls_in_vain = 0;
  int turned = 0;
  std::set<std::size_t> held;  // joints that do not move
  double elapsed_s = 0;
  double fastest_rad_s = 0;  // of the commands
  std::vector<RecoveryStage> stages;
  // Largest outward abduction and hip command of each leg during the rolls.
  std::array<double, robot::kLegs> roll_hip_rad{};

 private:
  void note(RecoveryStage stage) {
    if (stages.empty() || stages.back() != stage) stages.push_back(stage);
  }

  void follow(const actuation::JointCommands& commands) {
    const RecoveryStage stage = recovery.stage();
    for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
      const actuation::JointCommand& command = commands[joint];
      if (stage == RecoveryStage::kLimp || stage == RecoveryStage::kFailed) {
        EXPECT_EQ(command.kp_Nm_rad, 0.0);
        EXPECT_GT(command.kd_Nm_s_rad, 0.0);
        continue;
      }
      EXPECT_GT(command.kp_Nm_rad, 0.0);
      double& position = state.joints[joint].position_rad;
      if (held.contains(joint)) continue;
      fastest_rad_s = std::max(fastest_rad_s, std::fabs(command.position_rad - position) / kStep_s);
      position = command.position_rad;
    }
    if (stage != RecoveryStage::kRoll) return;
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      const double hip = commands[robot::joint_index(leg, 1)].position_rad;
      roll_hip_rad[leg] = std::min(roll_hip_rad[leg], hip);
    }
  }
};

void expect_folded(const World& world) {
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    EXPECT_NEAR(world.state.joints[joint].position_rad, kFolded_rad[joint % 3], 1e-9);
  }
}

TEST(Recovery, GravityTellsHowItLies) {
  const double limit = 0.7;
  EXPECT_EQ(lie_of(rotation_x(0.69), limit), Lie::kUpright);
  EXPECT_EQ(lie_of(rotation_y(-0.69), limit), Lie::kUpright);
  EXPECT_EQ(lie_of(rotation_x(0.71), limit), Lie::kRightDown);
  EXPECT_EQ(lie_of(rotation_x(-0.71), limit), Lie::kLeftDown);
  EXPECT_EQ(lie_of(rotation_x(kPi - 0.2), limit), Lie::kRightDown);
  EXPECT_EQ(lie_of(rotation_x(kPi + 0.2), limit), Lie::kLeftDown);
  // Heading does not matter.
  for (double yaw = -3; yaw < 3; yaw += 0.5) {
    EXPECT_EQ(lie_of(geometry::rotation_z(yaw) * rotation_x(1.5), limit), Lie::kRightDown);
  }
}

TEST(Recovery, OnItsBellyItOnlyFolds) {
  for (const std::array<double, 3>& legs : {kFolded_rad, std::array<double, 3>{0.6, 2.0, 0.4}}) {
    World world(config(), lying(0.3, legs));
    world.run(10);
    EXPECT_TRUE(world.recovery.done());
    EXPECT_EQ(world.recovery.rolls(), 0);
    EXPECT_FALSE(world.has_been(RecoveryStage::kSpread));
    EXPECT_LT(world.elapsed_s, 1.5);
    expect_folded(world);
  }
}

// Abduction joints and knees are in place before a hip moves.
TEST(Recovery, NoLegSweepsThroughTheTrunk) {
  World world(config(), lying(0.0, {0.8, 2.5, 0.5}));
  while (!world.has_been(RecoveryStage::kFoldIn)) {
    ASSERT_LT(world.elapsed_s, 3.0);
    EXPECT_EQ(world.state.joints[robot::joint_index(1, 1)].position_rad, 2.5);
    world.run(kStep_s);
  }
  EXPECT_NEAR(world.state.joints[robot::joint_index(1, 0)].position_rad, 0.0, 1e-3);
  EXPECT_NEAR(world.state.joints[robot::joint_index(1, 2)].position_rad, 2.7, 1e-3);
}

TEST(Recovery, OnASideOrTheBackItRollsOverTheNearerSide) {
  for (const double roll_rad : {1.4, 2.4, kPi - 0.05, -1.4, -2.4, -kPi + 0.05}) {
    World world(config(), lying(roll_rad, {0.3, 1.0, 1.0}));
    world.run(10);
    EXPECT_TRUE(world.recovery.done()) << roll_rad;
    EXPECT_EQ(world.recovery.rolls(), 1);
    EXPECT_LT(world.elapsed_s, 4.0);
    expect_folded(world);
    // The legs of the high side push: their hips reach far back.
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      const bool high = robot::is_left(leg) == (roll_rad > 0);
      EXPECT_NEAR(world.roll_hip_rad[leg], high ? -3.4 : -1.6, 0.01) << roll_rad << " leg " << leg;
    }
  }
}

TEST(Recovery, ARollInVainIsMadeOverTheOtherSide) {
  World world(config(), lying(2.0));
  world.rolls_in_vain = 1;
  world.run(10);
  EXPECT_TRUE(world.recovery.done());
  EXPECT_EQ(world.recovery.rolls(), 2);
  for (const double hip_rad : world.roll_hip_rad) EXPECT_NEAR(hip_rad, -3.4, 0.01);
}

TEST(Recovery, GivesUpAfterTheLastRollAndGoesLimp) {
  World world(config(), lying(kPi));
  world.rolls_in_vain = 1000;
  world.run(60);
  EXPECT_TRUE(world.recovery.failed());
  EXPECT_EQ(world.recovery.rolls(), config().max_rolls);
  const actuation::JointCommands& commands = world.recovery.update(world.state, kStep_s);
  for (const actuation::JointCommand& command : commands) EXPECT_EQ(command.kp_Nm_rad, 0.0);
}

// Stands up, falls, again and again: begin() is not called, since it never stood.
TEST(Recovery, GivesUpWhenStandingUpFailsAgainAndAgain) {
  World world(config(), lying(0.0));
  int starts = 1;
  for (; starts < 20; ++starts) {
    world.run(10);
    if (world.recovery.failed()) break;
    ASSERT_TRUE(world.recovery.done());
    world.recovery.start();
  }
  EXPECT_EQ(starts, config().max_rolls + 1);
  world.recovery.begin();
  world.recovery.start();
  world.run(10);
  EXPECT_TRUE(world.recovery.done());
}

// Two legs of the left side have crossed: the outer one is spread before both are folded anew.
TEST(Recovery, ALegThatIsCaughtIsFreedByTheOuterOfTheTwo) {
  estimation::RobotState crossed = lying(0.0);
  const std::size_t front = robot::kFrontLeft;
  const std::size_t hind = robot::kHindLeft;
  crossed.joints[robot::joint_index(front, 1)].position_rad = -2.5;
  crossed.joints[robot::joint_index(hind, 1)].position_rad = 1.5;
  crossed.joints[robot::joint_index(front, 0)].position_rad = 0.1;
  crossed.joints[robot::joint_index(hind, 0)].position_rad = 0.3;  // outer
  World world(config(), crossed);
  for (const std::size_t leg : {front, hind}) {
    for (std::size_t i = 0; i < 2; ++i) world.held.insert(robot::joint_index(leg, i));
  }
  while (!world.has_been(RecoveryStage::kSpread)) {
    ASSERT_LT(world.elapsed_s, 3.0);
    world.run(kStep_s);
  }
  world.held.clear();
  world.run(0.25);
  EXPECT_GT(world.state.joints[robot::joint_index(hind, 0)].position_rad, 0.9);
  EXPECT_LT(world.state.joints[robot::joint_index(front, 0)].position_rad, 0.2);
  EXPECT_NEAR(world.state.joints[robot::joint_index(robot::kFrontRight, 0)].position_rad, 0, 1e-9);
  world.run(10);
  EXPECT_TRUE(world.recovery.done());
  expect_folded(world);
}

TEST(Recovery, WhatStaysCaughtDoesNotHoldItForever) {
  World world(config(), lying(0.0, {0.0, 1.5, 2.7}));
  world.held.insert(robot::joint_index(robot::kHindRight, 1));
  world.run(10);
  EXPECT_TRUE(world.recovery.done());
  EXPECT_LT(world.elapsed_s, 4.0);
}

// No step in a command, whatever it starts from: the peak of a blend is 1.5 times its mean speed.
TEST(Recovery, CommandsAreContinuous) {
  World world(config(), lying(2.5, {-1.2, 3.3, 0.3}));
  world.run(10);
  EXPECT_TRUE(world.recovery.done());
  EXPECT_LT(world.fastest_rad_s, 1.5 * config().speed_rad_s * 1.01);
}

TEST(Recovery, StaysLimpWhileItTumblesButNotForLong) {
  estimation::RobotState state = lying(0.0);
  state.angular_velocity_B_rad_s = Vector3(3.0, 0.0, 0.0);
  World world(config(), state);
  world.run(0.5);
  EXPECT_EQ(world.recovery.stage(), RecoveryStage::kLimp);
  world.run(0.5);
  EXPECT_NE(world.recovery.stage(), RecoveryStage::kLimp);
}

}  // namespace
}  // namespace surefoot::control
