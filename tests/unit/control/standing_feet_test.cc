// Feet that slide, and feet that lose their ground.
#include "core/control/standing_feet.h"

#include <gtest/gtest.h>

#include "tests/support/static_walk_world.h"

namespace surefoot::control {
namespace {

constexpr LoadShares kAll{1, 1, 1, 1};

class StandingFeetTest : public ::testing::Test {
 protected:
  StandingFeetTest() {
    const ControlConfig config = tests::static_walk_config();
    feet_.reset(config.swing, config.static_walk);
    for (std::size_t i = 0; i < robot::kLegs; ++i) {
      state_.feet[i].p_O_m = Vector3(0.1 * robot::front_sign(i), 0.07 * robot::left_sign(i), 0.01);
      state_.feet[i].in_contact = true;
    }
    feet_.take(state_);
  }

  void follow(int ticks, const LoadShares& shares = kAll) {
    for (int i = 0; i < ticks; ++i) {
      feet_.follow(state_, legs_, shares, tests::kStaticWalkTick_s);
    }
  }

  estimation::RobotState state_;
  LegStatuses legs_;
  StandingFeet feet_;
};

TEST_F(StandingFeetTest, AnyButTheSteppingFootMaySlip) {
  state_.feet[robot::kHindLeft].p_O_m[0] += 0.013;  // slip_m and a little
  EXPECT_TRUE(feet_.have_slipped(state_, robot::kFrontLeft));
  EXPECT_FALSE(feet_.have_slipped(state_, robot::kHindLeft));
  feet_.take(state_);
  EXPECT_FALSE(feet_.have_slipped(state_, robot::kFrontLeft));
}

TEST_F(StandingFeetTest, ALowerFootHasSlippedAsWell) {
  state_.feet[robot::kHindLeft].p_O_m[2] -= 0.013;
  EXPECT_TRUE(feet_.have_slipped(state_, robot::kFrontLeft));
}

TEST_F(StandingFeetTest, GroundIsLostAfterThirtyMilliseconds) {
  state_.feet[robot::kFrontRight].in_contact = false;
  follow(14);
  EXPECT_FALSE(feet_.have_lost_ground(robot::kHindLeft));
  follow(3);
  EXPECT_TRUE(feet_.have_lost_ground(robot::kHindLeft));
  EXPECT_FALSE(feet_.have_lost_ground(robot::kFrontRight));  // it is the one that steps
  state_.feet[robot::kFrontRight].in_contact = true;
  follow(1);
  EXPECT_FALSE(feet_.have_lost_ground(robot::kHindLeft));
}

TEST_F(StandingFeetTest, AFootThatIsBeingUnloadedLosesNothing) {
  state_.feet[robot::kFrontRight].in_contact = false;
  follow(100, {0.9, 1, 1, 1});
  EXPECT_FALSE(feet_.have_lost_ground(robot::kHindLeft));
}

TEST_F(StandingFeetTest, AFootInTheAirIsNotFollowed) {
  legs_[robot::kFrontRight].mode = LegMode::kSwing;
  const Vector3 stood = feet_.places_O_m()[robot::kFrontRight];
  state_.feet[robot::kFrontRight].p_O_m += Vector3(0.05, 0.0, 0.05);
  follow(10);
  EXPECT_EQ(feet_.places_O_m()[robot::kFrontRight], stood);
  feet_.put(robot::kFrontRight, state_.feet[robot::kFrontRight].p_O_m);
  EXPECT_FALSE(feet_.have_slipped(state_, robot::kHindLeft));
}

}  // namespace
}  // namespace surefoot::control
