// The pilot that walks up to an edge, jumps or refuses.
#include "core/autonomy/jump_pilot.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/jump_parts.h"
#include "tests/support/ledge_map.h"

namespace surefoot::autonomy {
namespace {

using motions::JumpRefusal;
using motions::JumpStage;

constexpr double kStep_s = 0.002;

JumpPilotConfig pilot_config() {
  JumpPilotConfig config;
  config.look_from_m = 0.24;
  config.half_width_m = 0.18;
  config.min_rise_m = 0.11;
  config.min_drop_m = 0.10;
  config.engage_m = 0.70;
  config.refuse_m = 0.40;
  config.speed_m_s = 0.25;
  config.distance_gain_1_s = 1.5;
  config.heading_gain_1_s = 1.5;
  config.max_yaw_rate_rad_s = 0.3;
  config.distance_tolerance_m = 0.015;
  config.heading_tolerance_rad = 0.04;
  config.square_s = 0.1;
  config.patience_s = 8.0;
  config.lost_s = 0.5;
  config.max_attempts = 2;
  config.landing_from_m = 0.04;
  config.landing_length_m = 0.3;
  config.landing_half_width_m = 0.18;
  config.landing_error_m = 0.035;
  config.landing_known = 0.6;
  return config;
}

// A robot that moves as commanded, before an edge at x = 0.8 m that faces along the x axis.
class Pilot : public testing::Test {
 protected:
  Pilot() : model_(robot::full_mini_cheetah()), state_(tests::robot_at(model_, -0.8, 1.6)) {
    SUREFOOT_ASSERT(ok(motions_.push_back(tests::small_motion())));
    reset();
  }
  void reset() { pilot_.reset(pilot_config(), tests::jump_config(), model_, 0.29, motions_); }
  double ground(double x, double y) const {
    if (x <= 0.8 || x >= platform_end_m_ || std::fabs(y) > half_width_m_) return 0.0;
    return rise_m_;
  }
  void tick() {
    if (ticks_ % 15 == 0) {
      const std::uint64_t frames = window_ == nullptr ? 1 : window_->frames + 1;
      window_ = tests::window_of(state_.p_OB_m[0], state_.p_OB_m[1], [this](double x, double y) {
        return blind_ ? std::nan("") : ground(x, y);
      });
      window_->frames = frames;
    }
    ++ticks_;
    pilot_.update(state_, window_.get(), ground(state_.p_OB_m[0], state_.p_OB_m[1]), true, kStep_s);
    if (pilot_.jumps()) return tests::follow(model_, pilot_.joints(), state_);
    const double forward = pilot_.steers() ? pilot_.command().forward_m_s : 0.4;
    const double turn = pilot_.steers() ? pilot_.command().yaw_rate_rad_s : 0.0;
    state_.yaw_rad += turn * kStep_s;
    state_.p_OB_m[0] += forward * std::cos(state_.yaw_rad) * kStep_s;
    state_.p_OB_m[1] += forward * std::sin(state_.yaw_rad) * kStep_s;
  }
  bool run_to(JumpStage stage, int limit = 8000) {
    for (int i = 0; i < limit && pilot_.jump().stage() != stage; ++i) tick();
    return pilot_.jump().stage() == stage;
  }
  bool run_to(PilotStage stage, int limit = 8000) {
    for (int i = 0; i < limit && pilot_.stage() != stage; ++i) tick();
    return pilot_.stage() == stage;
  }

  robot::RobotModel model_;
  motions::MotionLibrary motions_;
  estimation::RobotState state_;
  JumpPilot pilot_;
  std::unique_ptr<mapping::MapWindow> window_;
  double rise_m_ = 0.13;
  double platform_end_m_ = 3.0;
  double half_width_m_ = 1.0;
  bool blind_ = false;
  int ticks_ = 0;
};

TEST_F(Pilot, LeavesTheMissionAloneUntilAnEdgeIsNear) {
  for (int i = 0; i < 100; ++i) {
    tick();
    EXPECT_FALSE(pilot_.steers()) << state_.p_OB_m[0];
  }
  ASSERT_TRUE(run_to(PilotStage::kApproach));
  EXPECT_NEAR(0.8 - state_.p_OB_m[0], 0.70, 0.03);
}

TEST_F(Pilot, JumpsFromTheMotionsStartSquareToTheEdge) {
  state_.yaw_rad = 0.2;
  state_.p_OB_m[1] = -0.1;
  ASSERT_TRUE(run_to(JumpStage::kPushFour));
  EXPECT_NEAR(0.8 - state_.p_OB_m[0], 0.34, 0.03);
  EXPECT_NEAR(state_.yaw_rad, 0.0, 0.06);
  EXPECT_EQ(pilot_.counters().attempts, 1U);
  EXPECT_EQ(pilot_.counters().jumps, 1U);
  EXPECT_EQ(pilot_.counters().refusals, 0U);
  EXPECT_NEAR(pilot_.rise_m(), 0.13, 0.005);
}

TEST_F(Pilot, GivesTheLegsBackOnce) {
  ASSERT_TRUE(run_to(JumpStage::kPushFour));
  int ends = 0;
  for (int i = 0; i < 1000; ++i) {
    if (pilot_.jump().stage() == JumpStage::kLanding) state_.p_OB_m[0] = 1.2;
    tick();
    if (pilot_.ended()) ++ends;
  }
  EXPECT_EQ(ends, 1);
  EXPECT_EQ(pilot_.stage(), PilotStage::kWatch);
  EXPECT_FALSE(pilot_.jumps());
}

TEST_F(Pilot, RefusesWhatNoMotionReachesAndStopsBeforeIt) {
  rise_m_ = 0.2;
  ASSERT_TRUE(run_to(PilotStage::kGivenUp));
  EXPECT_EQ(pilot_.counters().last_refusal, JumpRefusal::kNoMotion);
  EXPECT_EQ(pilot_.counters().refusals, 1U);
  EXPECT_EQ(pilot_.counters().attempts, 0U);
  EXPECT_NEAR(0.8 - state_.p_OB_m[0], 0.40, 0.02);
  EXPECT_EQ(pilot_.gait(control::GaitKind::kTrot), control::GaitKind::kStand);
}

TEST_F(Pilot, WalksOnTowardsSomethingNarrow) {
  half_width_m_ = 0.1;
  for (int i = 0; i < 500; ++i) tick();
  EXPECT_FALSE(pilot_.steers());
  EXPECT_EQ(pilot_.counters().refusals, 0U);
}

TEST_F(Pilot, RefusesALandingTooShortAndTriesNoMoreThanAllowed) {
  platform_end_m_ = 0.95;
  ASSERT_TRUE(run_to(PilotStage::kGivenUp, 40000));
  EXPECT_EQ(pilot_.counters().last_refusal, JumpRefusal::kLanding);
  EXPECT_EQ(pilot_.counters().attempts, 2U);
  EXPECT_EQ(pilot_.counters().refusals, 2U);
  EXPECT_EQ(pilot_.counters().jumps, 0U);
}

TEST_F(Pilot, RefusesWhenAFootIsOffTheGround) {
  ASSERT_TRUE(run_to(JumpStage::kHold));
  state_.feet[2].in_contact = false;
  ASSERT_TRUE(run_to(JumpStage::kRise));
  EXPECT_EQ(pilot_.counters().last_refusal, JumpRefusal::kFoot);
}

TEST_F(Pilot, ForgetsAnEdgeThatIsGone) {
  ASSERT_TRUE(run_to(PilotStage::kApproach));
  blind_ = true;
  ASSERT_TRUE(run_to(PilotStage::kWatch, 500));
  EXPECT_EQ(pilot_.counters().last_refusal, JumpRefusal::kEdgeLost);
}

TEST_F(Pilot, GivesUpAnApproachThatDoesNotArrive) {
  ASSERT_TRUE(run_to(PilotStage::kApproach));
  const Vector3 stuck = state_.p_OB_m;
  for (int i = 0; i < 5000 && !pilot_.given_up(); ++i) {
    tick();
    state_.p_OB_m = stuck;
  }
  EXPECT_TRUE(pilot_.given_up());
  EXPECT_EQ(pilot_.counters().last_refusal, JumpRefusal::kDistance);
}

TEST_F(Pilot, AbandonsEverythingWhenTheRobotFell) {
  ASSERT_TRUE(run_to(JumpStage::kHold));
  pilot_.abandon();
  EXPECT_FALSE(pilot_.steers());
  EXPECT_FALSE(pilot_.jump().active());
}

TEST_F(Pilot, PicksTheMotionWhoseRangeCoversTheRise) {
  motions::Motion high = tests::small_motion();
  high.rise_m = 0.25;
  high.edge_m = 0.36;
  high.start.rise_min_m = 0.15;
  high.start.rise_max_m = 0.27;
  ASSERT_TRUE(ok(motions_.push_back(high)));
  for (const auto& [rise_m, edge_m] : {std::pair{0.13, 0.34}, {0.24, 0.36}, {0.155, 0.34}}) {
    reset();
    rise_m_ = rise_m;
    state_ = tests::robot_at(model_, -0.8, 1.6);
    ASSERT_TRUE(run_to(JumpStage::kPushFour)) << rise_m;
    EXPECT_NEAR(0.8 - state_.p_OB_m[0], edge_m, 0.018) << rise_m;
  }
}

TEST_F(Pilot, DoesNothingWithoutAMap) {
  for (int i = 0; i < 100; ++i) pilot_.update(state_, nullptr, 0.0, true, kStep_s);
  EXPECT_FALSE(pilot_.steers());
}

}  // namespace
}  // namespace surefoot::autonomy
