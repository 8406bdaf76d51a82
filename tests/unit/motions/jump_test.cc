// The state machine that plays a motion, and the start set it asks about.
#include "core/motions/jump.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/jump_parts.h"

namespace surefoot::motions {
namespace {

constexpr double kStep_s = 0.002;

StartState good_start() {
  StartState state;
  state.edge_m = 0.34;
  state.rise_m = 0.13;
  state.all_feet = true;
  state.landing_free = true;
  return state;
}

TEST(StartSet, TakesItsInsideAndItsBorders) {
  const StartSet set = tests::small_motion().start;
  EXPECT_EQ(check_start(set, good_start()), JumpRefusal::kNone);
  StartState border = good_start();
  border.edge_m = set.edge_max_m;
  border.rise_m = set.rise_min_m;
  border.heading_rad = -set.max_heading_rad;
  border.tilt_rad = set.max_tilt_rad;
  border.joint_error_rad = set.max_joint_error_rad;
  EXPECT_EQ(check_start(set, border), JumpRefusal::kNone);
}

TEST(StartSet, NamesWhatLiesOutside) {
  const StartSet set = tests::small_motion().start;
  const auto refusal = [&](auto change) {
    StartState state = good_start();
    change(state);
    return check_start(set, state);
  };
  EXPECT_EQ(refusal([](StartState& s) { s.edge_m = 0.309; }), JumpRefusal::kDistance);
  EXPECT_EQ(refusal([](StartState& s) { s.edge_m = 0.371; }), JumpRefusal::kDistance);
  EXPECT_EQ(refusal([](StartState& s) { s.edge_m = std::nan(""); }), JumpRefusal::kDistance);
  EXPECT_EQ(refusal([](StartState& s) { s.heading_rad = 0.13; }), JumpRefusal::kHeading);
  EXPECT_EQ(refusal([](StartState& s) { s.heading_rad = -0.13; }), JumpRefusal::kHeading);
  EXPECT_EQ(refusal([](StartState& s) { s.rise_m = 0.09; }), JumpRefusal::kRise);
  EXPECT_EQ(refusal([](StartState& s) { s.rise_m = 0.17; }), JumpRefusal::kRise);
  EXPECT_EQ(refusal([](StartState& s) { s.landing_free = false; }), JumpRefusal::kLanding);
  EXPECT_EQ(refusal([](StartState& s) { s.tilt_rad = 0.11; }), JumpRefusal::kTilt);
  EXPECT_EQ(refusal([](StartState& s) { s.tilt_rad = std::nan(""); }), JumpRefusal::kTilt);
  EXPECT_EQ(refusal([](StartState& s) { s.speed_m_s = 0.11; }), JumpRefusal::kSpeed);
  EXPECT_EQ(refusal([](StartState& s) { s.rate_rad_s = 0.51; }), JumpRefusal::kRate);
  EXPECT_EQ(refusal([](StartState& s) { s.joint_error_rad = 0.21; }), JumpRefusal::kJoints);
  EXPECT_EQ(refusal([](StartState& s) { s.all_feet = false; }), JumpRefusal::kFoot);
}

class Jump : public testing::Test {
 protected:
  Jump()
      : model_(robot::full_mini_cheetah()),
        motion_(tests::small_motion()),
        state_(tests::robot_at(model_, -0.8, 1.6)) {
    jump_.reset(tests::jump_config(), model_, 0.29);
  }

  // One tick; the robot does as commanded.
  void tick() {
    const actuation::JointCommands& commands = jump_.update(state_, kStep_s);
    for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
      const double limit = model_.actuators[joint % robot::kJointsPerLeg].torque_limit_Nm;
      EXPECT_LE(std::fabs(commands[joint].torque_Nm), limit);
      EXPECT_TRUE(std::isfinite(commands[joint].position_rad));
    }
    if (follows_) tests::follow(model_, commands, state_);
  }
  void tick_to(JumpStage stage, int limit = 1000) {
    for (int i = 0; i < limit && jump_.stage() != stage; ++i) tick();
    ASSERT_EQ(jump_.stage(), stage);
  }
  void set_force(double force_N) {
    for (estimation::FootState& foot : state_.feet) foot.force_O_N[2] = force_N;
  }

  robot::RobotModel model_;
  Motion motion_;
  estimation::RobotState state_;
  JumpController jump_;
  bool follows_ = true;
};

TEST_F(Jump, RunsThroughItsStagesInTime) {
  jump_.begin(motion_, state_);
  std::vector<std::pair<JumpStage, int>> spans;
  for (int i = 0; i < 2000 && jump_.stage() != JumpStage::kDone; ++i) {
    tick();
    if (jump_.holds()) jump_.play();
    // On the ground again 0.02 s before the motion's end.
    set_force(jump_.stage() == JumpStage::kFlight && spans.back().second > 140 ? 60.0 : 0.0);
    if (spans.empty() || spans.back().first != jump_.stage()) spans.emplace_back(jump_.stage(), 0);
    ++spans.back().second;
  }
  const std::vector<std::pair<JumpStage, int>> expected = {
      {JumpStage::kCrouch, 100}, {JumpStage::kHold, 50},    {JumpStage::kPushFour, 100},
      {JumpStage::kPushTwo, 50}, {JumpStage::kFlight, 142}, {JumpStage::kLanding, 100},
      {JumpStage::kRise, 100},   {JumpStage::kDone, 1}};
  ASSERT_EQ(spans.size(), expected.size());
  for (std::size_t i = 0; i < spans.size(); ++i) {
    EXPECT_EQ(spans[i].first, expected[i].first) << i;
    EXPECT_NEAR(spans[i].second, expected[i].second, 2) << i;
  }
  EXPECT_TRUE(jump_.landed());
}

TEST_F(Jump, HoldsTheFirstPoseUntilItIsToldToGo) {
  jump_.begin(motion_, state_);
  tick_to(JumpStage::kHold);
  EXPECT_FALSE(jump_.holds());
  for (int i = 0; i < 2000; ++i) tick();
  EXPECT_EQ(jump_.stage(), JumpStage::kHold);
  EXPECT_TRUE(jump_.holds());
  EXPECT_LT(jump_.max_joint_error_rad(state_), 1e-3);
}

TEST_F(Jump, GoesNowhereBeforeTheHold) {
  jump_.begin(motion_, state_);
  tick();
  jump_.play();
  EXPECT_EQ(jump_.stage(), JumpStage::kCrouch);
}

TEST_F(Jump, StandsUpAgainWhenCancelled) {
  jump_.begin(motion_, state_);
  tick_to(JumpStage::kHold);
  jump_.cancel(state_);
  tick_to(JumpStage::kDone);
  EXPECT_FALSE(jump_.landed());
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    EXPECT_NEAR(state_.feet[leg].p_B_m[2], model_.foot_radius_m - 0.29, 1e-3);
  }
}

TEST_F(Jump, BreaksOffWhenTheJointsDoNotFollow) {
  jump_.begin(motion_, state_);
  tick_to(JumpStage::kHold);
  for (int i = 0; i < 60; ++i) tick();
  jump_.play();
  tick();
  EXPECT_EQ(jump_.stage(), JumpStage::kPushFour);
  follows_ = false;
  state_.joints[robot::joint_index(2, 2)].position_rad += 0.7;
  tick();
  EXPECT_EQ(jump_.stage(), JumpStage::kRise);
  EXPECT_TRUE(jump_.broken_off());
  EXPECT_FALSE(jump_.landed());
}

TEST_F(Jump, LandsWithoutFeelingTheGroundAtLast) {
  jump_.begin(motion_, state_);
  tick_to(JumpStage::kHold);
  for (int i = 0; i < 60; ++i) tick();
  jump_.play();
  tick_to(JumpStage::kFlight);
  int ticks = 0;
  for (; ticks < 1000 && jump_.stage() == JumpStage::kFlight; ++ticks) tick();
  EXPECT_NEAR(ticks * kStep_s, 0.3 + 0.2, 0.01);
  EXPECT_EQ(jump_.stage(), JumpStage::kLanding);
}

// A force early in flight is that of legs that swing.
TEST_F(Jump, TakesNoForceForATouchdownEarlyInFlight) {
  jump_.begin(motion_, state_);
  tick_to(JumpStage::kHold);
  for (int i = 0; i < 60; ++i) tick();
  jump_.play();
  tick_to(JumpStage::kFlight);
  set_force(200.0);
  for (int i = 0; i < 60; ++i) tick();
  EXPECT_EQ(jump_.stage(), JumpStage::kFlight);
}

TEST_F(Jump, TellsTheEstimatorNotToTrustFeetThatLeaveOrStrike) {
  jump_.begin(motion_, state_);
  tick_to(JumpStage::kHold);
  for (int i = 0; i < 60; ++i) tick();
  jump_.play();
  int strikes = 0;
  for (int i = 0; i < 2000 && jump_.stage() != JumpStage::kDone; ++i) {
    tick();
    const JumpStage stage = jump_.stage();
    const bool planned = jump_.gait_phases()[i % 4].stance_planned;
    const bool leaves = stage == JumpStage::kPushTwo || stage == JumpStage::kFlight;
    const bool stands = stage == JumpStage::kPushFour || stage == JumpStage::kRise;
    EXPECT_FALSE(leaves && planned);
    EXPECT_FALSE(stands && !planned);
    if (stage == JumpStage::kLanding && !planned) ++strikes;
  }
  EXPECT_NEAR(strikes * kStep_s, 0.04, 0.004);
}

// In flight the legs reach for level ground whatever the trunk's attitude.
TEST_F(Jump, ReachesForLevelGround) {
  jump_.begin(motion_, state_);
  tick_to(JumpStage::kHold);
  for (int i = 0; i < 60; ++i) tick();
  jump_.play();
  tick_to(JumpStage::kFlight);
  state_.R_OB = geometry::from_roll_pitch_yaw(0.05, -0.15, 0.3);
  state_.yaw_rad = 0.3;
  for (int i = 0; i < 200; ++i) tick();  // past the motion's end
  ASSERT_EQ(jump_.stage(), JumpStage::kFlight);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const Vector3 foot_O = state_.R_OB * state_.feet[leg].p_B_m;
    const Vector3 hip_O = state_.R_OB * robot::hip_joint_B_m(model_, leg);
    EXPECT_NEAR(foot_O[2], model_.foot_radius_m - 0.2, 1e-6) << leg;
    EXPECT_NEAR(foot_O[0] - hip_O[0], 0.06 * std::cos(0.3), 1e-6) << leg;
    EXPECT_NEAR(foot_O[1] - hip_O[1], 0.06 * std::sin(0.3), 1e-6) << leg;
  }
}

// The moment of the planned ground force about the abduction joint, by hand: the foot stands
// hip_offset outside of the joint.
TEST_F(Jump, AbductionJointsBearTheGroundForce) {
  jump_.begin(motion_, state_);
  tick_to(JumpStage::kHold);
  for (int i = 0; i < 60; ++i) tick();
  jump_.play();
  tick();
  const actuation::JointCommands& commands = jump_.update(state_, kStep_s);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const double outwards = state_.feet[leg].p_B_m[1] - robot::abduction_joint_B_m(model_, leg)[1];
    EXPECT_NEAR(commands[robot::joint_index(leg, 0)].torque_Nm, -40.0 * outwards, 0.05) << leg;
  }
}

}  // namespace
}  // namespace surefoot::motions
