#include "core/autonomy/mission.h"

#include <gtest/gtest.h>

#include "core/geometry/rotations.h"
#include "core/math/elementary.h"

namespace surefoot::autonomy {
namespace {

constexpr double kStep_s = 0.002;

MissionConfig cross() {
  MissionConfig config;
  config.kind = MissionConfig::Kind::kCross;
  config.gait = control::GaitKind::kTrot;
  config.goal_x_m = 3.0;
  config.goal_tolerance_m = 0.05;
  config.speed_m_s = 0.5;
  config.line_gain_1_s = 0.8;
  config.heading_gain_1_s = 1.5;
  config.max_lateral_m_s = 0.1;
  config.max_yaw_rate_rad_s = 0.5;
  config.rest_s = 0.1;
  config.settle_s = 0.2;
  config.timeout_s = 20.0;
  return config;
}

MissionFacts healthy() {
  MissionFacts facts;
  facts.drives_ready = true;
  facts.stand_up_done = true;
  facts.at_rest = true;
  return facts;
}

// Ticks until the phase is reached; -1: not within the limit.
int ticks_until(Mission& mission, MissionPhase phase, const estimation::RobotState& state,
                const MissionFacts& facts, int limit) {
  for (int tick = 0; tick < limit; ++tick) {
    if (mission.phase() == phase) return tick;
    mission.update(state, facts, kStep_s);
  }
  return -1;
}

TEST(Mission, GoesFromRestToWalkingInOrder) {
  Mission mission;
  mission.reset(cross());
  const estimation::RobotState state;
  EXPECT_EQ(mission.phase(), MissionPhase::kEnableDrives);
  EXPECT_NEAR(ticks_until(mission, MissionPhase::kStandUp, state, healthy(), 1000), 50, 1);
  EXPECT_NEAR(ticks_until(mission, MissionPhase::kSettle, state, healthy(), 1000), 1, 1);
  EXPECT_EQ(mission.gait(), control::GaitKind::kStand);
  EXPECT_NEAR(ticks_until(mission, MissionPhase::kWalk, state, healthy(), 1000), 100, 1);
  EXPECT_EQ(mission.gait(), control::GaitKind::kTrot);
}

TEST(Mission, ArrivesByTheRobotsOwnEstimateAndHoldsBeforeItIsFinished) {
  Mission mission;
  mission.reset(cross());
  estimation::RobotState state;
  ASSERT_GE(ticks_until(mission, MissionPhase::kWalk, state, healthy(), 1000), 0);
  state.p_OB_m = Vector3(2.94, 0.0, 0.3);
  mission.update(state, healthy(), kStep_s);
  EXPECT_EQ(mission.phase(), MissionPhase::kWalk);
  state.p_OB_m[0] = 2.96;
  mission.update(state, healthy(), kStep_s);
  EXPECT_EQ(mission.phase(), MissionPhase::kArrived);
  EXPECT_FALSE(mission.finished());
  for (int tick = 0; tick < 300; ++tick) mission.update(state, healthy(), kStep_s);
  EXPECT_TRUE(mission.finished());
  EXPECT_EQ(mission.stop_reason(), StopReason::kNone);
}

TEST(Mission, IsFinishedWhenTheRobotHasComeToRestOrNeverDoes) {
  estimation::RobotState state;
  state.p_OB_m = Vector3(3.0, 0.0, 0.3);
  Mission mission;
  mission.reset(cross());
  ASSERT_GE(ticks_until(mission, MissionPhase::kArrived, state, healthy(), 1000), 0);
  MissionFacts stepping = healthy();
  stepping.at_rest = false;
  for (int tick = 0; tick < 500; ++tick) mission.update(state, stepping, kStep_s);
  EXPECT_FALSE(mission.finished());
  for (int tick = 0; tick < 200; ++tick) mission.update(state, healthy(), kStep_s);
  EXPECT_FALSE(mission.finished());
  mission.update(state, stepping, kStep_s);  // one more step: the hold begins anew
  for (int tick = 0; tick < 249; ++tick) mission.update(state, healthy(), kStep_s);
  EXPECT_FALSE(mission.finished());
  for (int tick = 0; tick < 2; ++tick) mission.update(state, healthy(), kStep_s);
  EXPECT_TRUE(mission.finished());

  Mission restless;
  restless.reset(cross());
  ASSERT_GE(ticks_until(restless, MissionPhase::kArrived, state, healthy(), 1000), 0);
  for (int tick = 0; tick < 2260; ++tick) restless.update(state, stepping, kStep_s);
  EXPECT_TRUE(restless.finished());
}

// Its speed is what stops it at the goal at the given deceleration: v dv/dx = -a.
TEST(Mission, BrakesAheadOfTheGoal) {
  constexpr double kBraking_m_s2 = 0.6;
  Mission mission;
  mission.reset(cross(), kBraking_m_s2);
  estimation::RobotState state;
  ASSERT_GE(ticks_until(mission, MissionPhase::kWalk, state, healthy(), 1000), 0);
  double last_m_s = 0.5;
  for (double x_m = 2.0; x_m < 2.949; x_m += 0.001) {
    state.p_OB_m = Vector3(x_m, 0.0, 0.3);
    mission.update(state, healthy(), kStep_s);
    const double v_m_s = mission.command().forward_m_s;
    const double braking_m_s2 = (last_m_s - v_m_s) * 0.5 * (last_m_s + v_m_s) / 0.001;
    EXPECT_GT(v_m_s, 0.2);
    EXPECT_GE(braking_m_s2, -1e-9);
    EXPECT_LE(braking_m_s2, kBraking_m_s2 * (1 + 1e-9));
    if (x_m < 2.79) {
      EXPECT_EQ(v_m_s, 0.5);
    }
    last_m_s = v_m_s;
  }
  EXPECT_LT(last_m_s, 0.25);
}

TEST(Mission, SteersBackToTheLineWhateverTheHeading) {
  Mission mission;
  mission.reset(cross());
  estimation::RobotState state;
  ASSERT_GE(ticks_until(mission, MissionPhase::kWalk, state, healthy(), 1000), 0);
  state.p_OB_m = Vector3(1.0, 0.1, 0.3);
  state.yaw_rad = 0.3;
  mission.update(state, healthy(), kStep_s);
  const control::VelocityCommand& command = mission.command();
  const Matrix3 R = geometry::rotation_z(0.3);
  const Vector3 velocity_O = R * Vector3(command.forward_m_s, command.left_m_s, 0.0);
  EXPECT_NEAR(velocity_O[0], 0.5, 1e-12);
  EXPECT_NEAR(velocity_O[1], -0.08, 1e-12);
  EXPECT_NEAR(command.yaw_rate_rad_s, -0.45, 1e-12);
}

TEST(Mission, AFaultStopsItOnceAndKeepsItsReason) {
  Mission mission;
  mission.reset(cross());
  const estimation::RobotState state;
  ASSERT_GE(ticks_until(mission, MissionPhase::kWalk, state, healthy(), 1000), 0);
  MissionFacts facts = healthy();
  facts.fault = StopReason::kDriveSilent;
  mission.update(state, facts, kStep_s);
  EXPECT_EQ(mission.phase(), MissionPhase::kStopped);
  EXPECT_TRUE(mission.finished());
  EXPECT_EQ(mission.gait(), control::GaitKind::kStand);
  facts.fault = StopReason::kTilt;
  mission.update(state, facts, kStep_s);
  EXPECT_EQ(mission.stop_reason(), StopReason::kDriveSilent);
}

TEST(Mission, SilentDrivesAndTimeEndItWithTheirReasons) {
  const estimation::RobotState state;
  Mission silent;
  silent.reset(cross());
  EXPECT_GE(ticks_until(silent, MissionPhase::kStopped, state, MissionFacts{}, 1000), 500);
  EXPECT_EQ(silent.stop_reason(), StopReason::kDriveSilent);
  Mission slow;
  slow.reset(cross());
  EXPECT_GE(ticks_until(slow, MissionPhase::kStopped, state, healthy(), 20000), 9000);
  EXPECT_EQ(slow.stop_reason(), StopReason::kMissionTimeout);
}

TEST(Mission, FollowsItsScriptLineByLineAndThenArrives) {
  MissionConfig config = cross();
  config.kind = MissionConfig::Kind::kScript;
  const ScriptStep run{0.1, control::GaitKind::kTrotRun, 1.5, 0.0, 0.0};
  const ScriptStep turn{0.2, control::GaitKind::kTrot, 0.0, 0.2, 0.4};
  ASSERT_TRUE(ok(config.script.push_back(run)));
  ASSERT_TRUE(ok(config.script.push_back(turn)));
  Mission mission;
  mission.reset(config);
  estimation::RobotState state;
  ASSERT_GE(ticks_until(mission, MissionPhase::kWalk, state, healthy(), 1000), 0);
  for (int tick = 0; tick < 50; ++tick) {
    mission.update(state, healthy(), kStep_s);
    EXPECT_EQ(mission.gait(), control::GaitKind::kTrotRun);
    EXPECT_EQ(mission.command().forward_m_s, 1.5);
  }
  mission.update(state, healthy(), kStep_s);
  EXPECT_EQ(mission.gait(), control::GaitKind::kTrot);
  EXPECT_EQ(mission.command().left_m_s, 0.2);
  // Who lags behind the commanded turn is turned faster.
  EXPECT_GT(mission.command().yaw_rate_rad_s, 0.4);
  EXPECT_EQ(ticks_until(mission, MissionPhase::kArrived, state, healthy(), 1000), 100);
  EXPECT_EQ(mission.gait(), control::GaitKind::kStand);
}

TEST(Mission, GetsUpAfterAFallAndWalksOn) {
  MissionConfig config = cross();
  config.recover = true;
  Mission mission;
  mission.reset(config);
  estimation::RobotState state;
  ASSERT_GE(ticks_until(mission, MissionPhase::kWalk, state, healthy(), 1000), 0);
  MissionFacts down = healthy();
  down.fallen = true;
  down.fault = StopReason::kTilt;
  mission.update(state, down, kStep_s);
  EXPECT_EQ(mission.phase(), MissionPhase::kRecover);
  EXPECT_TRUE(mission.phase_changed());
  EXPECT_EQ(mission.gait(), control::GaitKind::kStand);
  down.fault = StopReason::kNone;
  for (int tick = 0; tick < 500; ++tick) mission.update(state, down, kStep_s);
  EXPECT_EQ(mission.phase(), MissionPhase::kRecover);
  MissionFacts up = healthy();
  up.recovered = true;
  EXPECT_EQ(ticks_until(mission, MissionPhase::kStandUp, state, up, 10), 1);
  // It has rolled 1 m to the side: straight to the goal from there.
  state.p_OB_m = Vector3(1.0, 1.0, 0.3);
  ASSERT_GE(ticks_until(mission, MissionPhase::kWalk, state, healthy(), 1000), 0);
  EXPECT_EQ(mission.gait(), control::GaitKind::kTrot);
  EXPECT_LT((mission.path_O() - Vector2(2.0, -1.0).normalized()).norm(), 1e-12);
  EXPECT_NEAR(mission.off_path_m(state), 0.0, 1e-12);
  state.p_OB_m = Vector3(3.0, 0.0, 0.3);
  EXPECT_EQ(ticks_until(mission, MissionPhase::kArrived, state, healthy(), 10), 1);
}

TEST(Mission, WithoutRecoverAFallStopsIt) {
  Mission mission;
  mission.reset(cross());
  const estimation::RobotState state;
  ASSERT_GE(ticks_until(mission, MissionPhase::kWalk, state, healthy(), 1000), 0);
  MissionFacts down = healthy();
  down.fallen = true;
  down.fault = StopReason::kTilt;
  mission.update(state, down, kStep_s);
  EXPECT_EQ(mission.phase(), MissionPhase::kStopped);
  EXPECT_EQ(mission.stop_reason(), StopReason::kTilt);
}

TEST(Mission, ARecoveryThatFailsStopsIt) {
  MissionConfig config = cross();
  config.recover = true;
  Mission mission;
  mission.reset(config);
  const estimation::RobotState state;
  MissionFacts facts = healthy();
  facts.must_recover = true;
  ASSERT_GE(ticks_until(mission, MissionPhase::kRecover, state, facts, 1000), 0);
  facts.recovery_failed = true;
  mission.update(state, facts, kStep_s);
  EXPECT_EQ(mission.phase(), MissionPhase::kStopped);
  EXPECT_EQ(mission.stop_reason(), StopReason::kRecoveryFailed);
}

// Turned away by the fall, it turns before it walks: it sees only what lies ahead.
TEST(Mission, TurnsOnTheSpotWhenItLooksAway) {
  Mission mission;
  mission.reset(cross());
  estimation::RobotState state;
  ASSERT_GE(ticks_until(mission, MissionPhase::kWalk, state, healthy(), 1000), 0);
  state.yaw_rad = 2.5;
  mission.update(state, healthy(), kStep_s);
  EXPECT_EQ(mission.command().forward_m_s, 0.0);
  EXPECT_EQ(mission.command().left_m_s, 0.0);
  EXPECT_NEAR(mission.command().yaw_rate_rad_s, -0.5, 1e-12);
}

TEST(Mission, GoesFromWaypointToWaypointAndArrivesAtTheLast) {
  MissionConfig config = cross();
  config.goal_tolerance_m = 0.1;
  ASSERT_TRUE(ok(config.waypoints.push_back({2.0, 0.0})));
  ASSERT_TRUE(ok(config.waypoints.push_back({2.0, 1.5})));
  Mission mission;
  mission.reset(config);
  estimation::RobotState state;
  ASSERT_GE(ticks_until(mission, MissionPhase::kWalk, state, healthy(), 1000), 0);
  state.p_OB_m = Vector3(2.0, 0.2, 0.3);  // on the end's level, but beside it
  mission.update(state, healthy(), kStep_s);
  EXPECT_EQ(mission.path_O(), Vector2(1, 0));
  EXPECT_EQ(mission.off_path_m(state), 0.2);
  EXPECT_LT(mission.command().left_m_s, 0);
  EXPECT_NEAR(mission.command().forward_m_s, 0, 1e-12);
  state.p_OB_m = Vector3(1.95, 0.05, 0.3);
  mission.update(state, healthy(), kStep_s);
  EXPECT_NEAR(mission.path_O()[0], 0, 1e-12);
  EXPECT_NEAR(mission.path_O()[1], 1, 1e-12);
  EXPECT_NEAR(mission.off_path_m(state), 0.05, 1e-12);
  // It looks along the old line: first the turn, then the walk.
  EXPECT_EQ(mission.command().forward_m_s, 0);
  EXPECT_GT(mission.command().yaw_rate_rad_s, 0.4);
  state.yaw_rad = 0.5 * math::kPi;
  mission.update(state, healthy(), kStep_s);
  EXPECT_NEAR(mission.command().forward_m_s, 0.5, 1e-12);
  EXPECT_EQ(mission.phase(), MissionPhase::kWalk);
  state.p_OB_m = Vector3(2.0, 1.45, 0.3);
  mission.update(state, healthy(), kStep_s);
  EXPECT_EQ(mission.phase(), MissionPhase::kArrived);
}

TEST(Mission, NavigatesByTheNavigatorsCommandUntilItSaysSo) {
  MissionConfig config = cross();
  config.kind = MissionConfig::Kind::kNavigate;
  Mission mission;
  mission.reset(config);
  const estimation::RobotState state;
  MissionFacts facts = healthy();
  facts.navigation = {0.3, -0.1, 0.2};
  ASSERT_GE(ticks_until(mission, MissionPhase::kWalk, state, facts, 1000), 0);
  mission.update(state, facts, kStep_s);
  EXPECT_EQ(mission.command().forward_m_s, 0.3);
  EXPECT_EQ(mission.command().left_m_s, -0.1);
  EXPECT_EQ(mission.command().yaw_rate_rad_s, 0.2);
  facts.at_goal = true;
  mission.update(state, facts, kStep_s);
  EXPECT_EQ(mission.phase(), MissionPhase::kArrived);
  EXPECT_EQ(mission.command().forward_m_s, 0.0);
}

TEST(Mission, GivesUpWhenItGetsNoNearer) {
  MissionConfig config = cross();
  config.live_lock_s = 2.0;
  Mission mission;
  mission.reset(config);
  estimation::RobotState state;
  ASSERT_GE(ticks_until(mission, MissionPhase::kWalk, state, healthy(), 1000), 0);
  for (int tick = 0; tick < 900; ++tick) mission.update(state, healthy(), kStep_s);
  state.p_OB_m[0] = 0.06;  // progress starts the time anew
  for (int tick = 0; tick < 900; ++tick) mission.update(state, healthy(), kStep_s);
  EXPECT_EQ(mission.phase(), MissionPhase::kWalk);
  EXPECT_NEAR(mission.stuck_s(), 1.8, 0.01);
  state.p_OB_m[0] = 0.09;  // to and fro is none
  EXPECT_NEAR(ticks_until(mission, MissionPhase::kStopped, state, healthy(), 1000), 101, 2);
  EXPECT_EQ(mission.stop_reason(), StopReason::kLiveLock);
}

}  // namespace
}  // namespace surefoot::autonomy
