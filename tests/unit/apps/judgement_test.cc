// Referee, figures of a run, campaign statistics.
#include <gtest/gtest.h>

#include <cmath>

#include "apps/common/campaign_result.h"
#include "apps/common/referee.h"
#include "apps/common/run_measures.h"
#include "apps/common/statistics.h"

namespace surefoot::apps {
namespace {

using autonomy::MissionPhase;
using autonomy::StopReason;

TimeNs at(double seconds) { return TimeNs{static_cast<std::int64_t>(seconds * 1e9)}; }

autonomy::Telemetry in_phase(MissionPhase phase, StopReason reason = StopReason::kNone) {
  autonomy::Telemetry telemetry;
  telemetry.phase = phase;
  telemetry.stop_reason = reason;
  return telemetry;
}

sim::Truth body_at(double x, double y = 0, double tilt_rad = 0) {
  sim::Truth truth;
  truth.p_WB_m = {x, y, 0.28};
  truth.q_WB_wxyz = {std::cos(tilt_rad / 2), std::sin(tilt_rad / 2), 0, 0};
  return truth;
}

Verdict judge(const autonomy::Telemetry& telemetry, const sim::Truth& truth,
              RefereeRules rules = {}) {
  Referee referee(rules);
  referee.observe(at(1), telemetry, truth);
  return referee.verdict();
}

TEST(Referee, GoalNeedsTheTruthToAgree) {
  EXPECT_EQ(judge(in_phase(MissionPhase::kArrived), body_at(2.85)).outcome, Outcome::kGoal);
  EXPECT_EQ(judge(in_phase(MissionPhase::kArrived), body_at(3.0, 0.19)).outcome, Outcome::kGoal);
  const Verdict off = judge(in_phase(MissionPhase::kArrived), body_at(2.75));
  EXPECT_EQ(off.outcome, Outcome::kAborted);
  EXPECT_EQ(off.reason, "believes it arrived, stands 0.25 m from the goal (allowed: 0.20 m)");
  EXPECT_EQ(judge(in_phase(MissionPhase::kWalk), body_at(3.0)).outcome, Outcome::kAborted);
}

TEST(Referee, StandingIsTheGoalOfAMissionWithoutOne) {
  RefereeRules rules;
  rules.has_goal = false;
  EXPECT_EQ(judge(in_phase(MissionPhase::kArrived), body_at(0), rules).outcome, Outcome::kGoal);
}

TEST(Referee, TiltIsAFallAndEndsTheRun) {
  Referee referee({});
  referee.observe(at(1), in_phase(MissionPhase::kWalk), body_at(1, 0, 1.04));
  EXPECT_FALSE(referee.over());
  referee.observe(at(2), in_phase(MissionPhase::kWalk), body_at(1, 0, 1.06));
  EXPECT_TRUE(referee.over());
  EXPECT_EQ(referee.falls(), 1);
  EXPECT_EQ(referee.verdict().outcome, Outcome::kFall);
}

TEST(Referee, TrunkOnTheGroundIsAFallOnlyAfterStandingUpAndForLongEnough) {
  sim::Truth down = body_at(0);
  down.trunk_contact = true;
  Referee lying({});
  for (double t = 0; t < 2; t += 0.008) {
    lying.observe(at(t), in_phase(MissionPhase::kStandUp), down);
  }
  EXPECT_FALSE(lying.over());

  Referee walking({});
  walking.observe(at(0), in_phase(MissionPhase::kWalk), body_at(0));
  walking.observe(at(1.0), in_phase(MissionPhase::kWalk), down);
  walking.observe(at(1.19), in_phase(MissionPhase::kWalk), body_at(0));  // touched and came up
  walking.observe(at(1.3), in_phase(MissionPhase::kWalk), down);
  walking.observe(at(1.49), in_phase(MissionPhase::kWalk), down);
  EXPECT_FALSE(walking.over());
  walking.observe(at(1.51), in_phase(MissionPhase::kWalk), down);
  EXPECT_TRUE(walking.over());
  EXPECT_EQ(walking.verdict().outcome, Outcome::kFall);
}

TEST(Referee, LeavingTheLaneAborts) {
  RefereeRules rules;
  rules.lane_half_width_m = 0.6;
  const Verdict verdict = judge(in_phase(MissionPhase::kWalk), body_at(1.25, -0.61), rules);
  EXPECT_EQ(verdict.outcome, Outcome::kAborted);
  EXPECT_EQ(verdict.reason, "left the lane at x = 1.25 m");
  EXPECT_EQ(judge(in_phase(MissionPhase::kArrived), body_at(3, 0.1), rules).outcome,
            Outcome::kGoal);
}

TEST(Referee, StopReasonsHaveTheirOutcomesAndExitCodes) {
  const std::pair<StopReason, Outcome> expected[] = {
      {StopReason::kNoFoothold, Outcome::kNoPath},
      {StopReason::kDriveSilent, Outcome::kFault},
      {StopReason::kImuSilent, Outcome::kFault},
      {StopReason::kDriveFault, Outcome::kFault},
      {StopReason::kMissionTimeout, Outcome::kTimeout},
      {StopReason::kOperator, Outcome::kAborted},
      {StopReason::kTilt, Outcome::kFall},
      {StopReason::kRecoveryFailed, Outcome::kFall}};
  for (const auto& [reason, outcome] : expected) {
    const Verdict verdict = judge(in_phase(MissionPhase::kStopped, reason), body_at(1));
    EXPECT_EQ(verdict.outcome, outcome) << describe(reason);
    EXPECT_EQ(verdict.reason, describe(reason));
  }
  EXPECT_EQ(exit_code(Outcome::kGoal), 0);
  EXPECT_EQ(exit_code(Outcome::kFall), 1);
  EXPECT_EQ(exit_code(Outcome::kFault), 3);
}

TEST(Referee, WhereItMayGetUpEachFallCountsOnceAndTheRunGoesOn) {
  RefereeRules rules;
  rules.may_recover = true;
  Referee referee(rules);
  double t = 0;
  const auto observe = [&](MissionPhase phase, double tilt_rad) {
    for (int i = 0; i < 50; ++i) {
      referee.observe(at(t += 0.008), in_phase(phase), body_at(3.0, 0, tilt_rad));
    }
  };
  observe(MissionPhase::kEnableDrives, 3.0);  // thrown on its back: no fall
  observe(MissionPhase::kRecover, 2.0);
  observe(MissionPhase::kStandUp, 0.0);
  EXPECT_EQ(referee.falls(), 0);
  for (int fall = 1; fall <= 2; ++fall) {
    observe(MissionPhase::kWalk, 0.0);
    observe(MissionPhase::kWalk, 1.5);
    EXPECT_EQ(referee.verdict().outcome, Outcome::kFall);
    EXPECT_NE(referee.verdict().reason.find("did not notice"), std::string::npos);
    observe(MissionPhase::kRecover, 1.5);
    observe(MissionPhase::kStandUp, 0.0);
    EXPECT_EQ(referee.falls(), fall);
    EXPECT_FALSE(referee.over());
  }
  observe(MissionPhase::kWalk, 0.9);  // noticed before it is one by the truth
  observe(MissionPhase::kRecover, 1.5);
  EXPECT_EQ(referee.falls(), 3);
  observe(MissionPhase::kStandUp, 0.0);
  observe(MissionPhase::kWalk, 0.0);
  observe(MissionPhase::kArrived, 0.0);
  EXPECT_EQ(referee.verdict().outcome, Outcome::kGoal);
  EXPECT_EQ(referee.falls(), 3);
}

// Walks 3 m in 6 s with a sway of 1 cm, the estimate 1 % long.
RunLog walk() {
  RunLog log(2000, true);
  for (int i = 0; i <= 1000; ++i) {
    const double t = i * 0.008;
    const double x = std::clamp((t - 1) * 0.5, 0.0, 3.0);
    sim::Truth truth = body_at(x, 0.01 * std::sin(20 * t));
    autonomy::Telemetry telemetry = in_phase(t < 1   ? MissionPhase::kSettle
                                             : t < 7 ? MissionPhase::kWalk
                                                     : MissionPhase::kArrived);
    telemetry.p_OB_m = {1.01 * x, truth.p_WB_m[1], 0.28};
    truth.feet[0].contact = i % 100 < 60;
    truth.feet[0].slip_m = i < 500 ? 0.0 : 0.025 + (i >= 510 ? 0.01 : 0.0);  // 25 mm, then 10 mm
    truth.leg_contact[2] = i == 300 || i == 302 || i == 400;
    log.add(at(t), telemetry, &truth);
  }
  return log;
}

TEST(RunMeasures, SpeedPathAndErrors) {
  const RunMeasures m = measure(walk(), 3.0);
  EXPECT_NEAR(m.start_to_goal_m, 3.0, 0.01);
  EXPECT_NEAR(m.walk_s, 6.0, 0.02);
  EXPECT_NEAR(m.mean_speed_m_s, 0.5, 0.01);
  EXPECT_GT(m.path_length_m, 2.95);
  EXPECT_LT(m.path_length_m, 3.2);
  EXPECT_NEAR(m.estimate.end_error_m, 0.03, 0.001);
  EXPECT_NEAR(m.estimate.rms_error_m, 0.03 / std::sqrt(3.0), 0.001);
  EXPECT_NEAR(m.estimate.drift_percent, 1.0, 0.07);
}

TEST(RunMeasures, CountsSlipsAndTouches) {
  RunLog log = walk();
  const RunMeasures m = measure(log, 3.0);
  EXPECT_EQ(m.foot_slips, 0u);  // the 25 mm came while the foot was in the air at i = 500
  EXPECT_EQ(m.collisions, 2u);  // 300 and 302 are one touch
}

TEST(RunMeasures, ASlipIsCountedOncePerContact) {
  RunLog log(100, true);
  for (int i = 0; i < 40; ++i) {
    sim::Truth truth = body_at(0);
    truth.feet[1].contact = i != 20;                  // two contacts
    truth.feet[1].slip_m = i < 20 ? 0.004 * i : 0.1;  // 76 mm in the first, none in the second
    log.add(at(i * 0.008), in_phase(MissionPhase::kWalk), &truth);
  }
  EXPECT_EQ(measure(log, 3.0).foot_slips, 1u);
}

TEST(RunMeasures, RecoveryIsTimedByTheTruth) {
  RunLog log(2000, true);
  std::array<double, robot::kJoints> limit_Nm{};
  limit_Nm.fill(20.0);
  double t = 0;
  const auto add = [&](double seconds, MissionPhase phase, double tilt_rad, double height_m) {
    for (int i = 0; i < static_cast<int>(seconds * 125 + 0.5); ++i) {
      sim::Truth truth = body_at(0, 0, tilt_rad);
      truth.p_WB_m[2] = height_m;
      truth.joints[4].motor_torque_Nm = phase == MissionPhase::kRecover ? -15.0 : 19.0;
      log.add(at(t += 0.008), in_phase(phase), &truth);
    }
  };
  add(1.0, MissionPhase::kEnableDrives, 3.0, 0.05);
  add(2.0, MissionPhase::kRecover, 3.0, 0.05);
  add(0.4, MissionPhase::kStandUp, 0.0, 0.1);
  add(0.3, MissionPhase::kStandUp, 0.0, 0.28);  // up, but it sinks again
  add(0.3, MissionPhase::kSettle, 0.0, 0.1);
  add(1.0, MissionPhase::kSettle, 0.0, 0.28);
  const RecoveryFigures once = measure_recovery(log, 0.28, limit_Nm);
  EXPECT_EQ(once.count, 1);
  EXPECT_EQ(once.stood, 1);
  EXPECT_NEAR(once.time_to_stand_s, 3.0, 0.02);
  EXPECT_NEAR(once.max_torque_share, 0.95, 1e-12);
  add(1.0, MissionPhase::kRecover, 3.0, 0.05);
  const RecoveryFigures twice = measure_recovery(log, 0.28, limit_Nm);
  EXPECT_EQ(twice.count, 2);
  EXPECT_EQ(twice.stood, 1);
}

TEST(Referee, ATouchOfTheObstacleEndsTheRunAsACollision) {
  Referee referee({});
  sim::Truth truth = body_at(1, 0.5);
  referee.observe(at(1), in_phase(MissionPhase::kWalk), truth);
  EXPECT_FALSE(referee.over());
  truth.obstacle_steps = 1;
  referee.observe(at(2), in_phase(MissionPhase::kWalk), truth);
  EXPECT_TRUE(referee.over());
  EXPECT_EQ(referee.verdict().outcome, Outcome::kCollision);
  EXPECT_EQ(referee.verdict().reason, "touched the obstacle at x = 1.00 m, y = 0.50 m");
}

TEST(Referee, AMissionThatGivesUpIsALiveLock) {
  EXPECT_EQ(judge(in_phase(MissionPhase::kStopped, StopReason::kLiveLock), body_at(1)).outcome,
            Outcome::kLiveLock);
}

// There and back: the goal is where it started.
TEST(RunMeasures, ACourseOfWaypointsIsMeasuredAlongTheWay) {
  RunLog log(1000, true);
  for (int i = 0; i <= 400; ++i) {
    sim::Truth truth = body_at(i <= 200 ? 0.01 * i : 4.0 - 0.01 * i);
    truth.obstacle_steps = i < 100 ? 0 : i < 110 ? static_cast<std::uint64_t>(i - 99) : 10;
    log.add(at(0.02 * i), in_phase(MissionPhase::kWalk), &truth);
  }
  const RunMeasures m = measure(log, 0.0, 4.0);
  EXPECT_EQ(m.start_to_goal_m, 4.0);
  EXPECT_NEAR(m.mean_speed_m_s, 0.5, 0.01);
  EXPECT_EQ(m.collisions, 1U);
}

TEST(RunMeasures, ARunThatNeverWalked) {
  RunLog log(10, true);
  const sim::Truth truth = body_at(0);
  log.add(at(0), in_phase(MissionPhase::kStandUp), &truth);
  const RunMeasures m = measure(log, 3.0);
  EXPECT_EQ(m.mean_speed_m_s, 0.0);
  EXPECT_NEAR(m.start_to_goal_m, 3.0, 1e-12);
  EXPECT_EQ(measure(RunLog(1, true), 3.0).path_length_m, 0.0);
}

// Reference values: Newcombe 1998, table I (method 3), and the closed forms z^2 / (n + z^2).
TEST(Statistics, WilsonKnownValues) {
  EXPECT_NEAR(wilson95(81, 263)[0], 0.2553, 5e-5);
  EXPECT_NEAR(wilson95(81, 263)[1], 0.3662, 5e-5);
  EXPECT_NEAR(wilson95(15, 148)[0], 0.0624, 5e-5);
  EXPECT_NEAR(wilson95(15, 148)[1], 0.1605, 5e-5);
  EXPECT_EQ(wilson95(0, 20)[0], 0.0);
  EXPECT_NEAR(wilson95(0, 20)[1], 0.1611, 5e-5);
  EXPECT_NEAR(wilson95(1, 29)[0], 0.0061, 5e-5);
  EXPECT_NEAR(wilson95(1, 29)[1], 0.1718, 5e-5);
  EXPECT_EQ(wilson95(29, 29)[1], 1.0);
  EXPECT_EQ(wilson95(0, 0), (std::array<double, 2>{0.0, 1.0}));
}

TEST(Statistics, Median) {
  EXPECT_EQ(median({}), 0.0);
  EXPECT_EQ(median({3, 1, 2}), 2.0);
  EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
}

TEST(CampaignResult, Seeds) {
  EXPECT_EQ(parse_seeds("1..20")->count(), 20u);
  EXPECT_EQ(parse_seeds("7")->first, 7u);
  EXPECT_EQ(parse_seeds("7")->count(), 1u);
  for (const char* wrong : {"", "a..b", "5..4", "1..", "..3", "1...3", "-1..2", "1..2000001"}) {
    EXPECT_FALSE(parse_seeds(wrong).has_value()) << wrong;
  }
}

TEST(CampaignResult, CountsOutcomes) {
  const auto run = [](const char* outcome, double speed) {
    return nlohmann::ordered_json{{"outcome", outcome}, {"mean_speed_m_s", speed}};
  };
  const auto json = campaign_json({run("goal", 0.3), run("fall", 0.9), run("goal", 0.5)});
  EXPECT_EQ(json["outcomes"]["goal"], 2);
  EXPECT_EQ(json["outcomes"]["fall"], 1);
  EXPECT_EQ(json["outcomes"]["timeout"], 0);
  EXPECT_NEAR(json["success_rate"].get<double>(), 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(json["median_speed_m_s"].get<double>(), 0.4, 1e-12);
  EXPECT_EQ(json["runs"].size(), 3u);
  EXPECT_NEAR(json["wilson95"][0].get<double>(), wilson95(2, 3)[0], 1e-12);
}

// Six seconds at 2 m/s with a stumble: what is kept up is what the stumble leaves.
TEST(Measures, SustainedSpeedIsTheSlowestHalfSecondOfTheBestFive) {
  RunLog log(2000, true);
  const auto walk = [&](double seconds, double forward_m_s) {
    for (int i = 0; i < static_cast<int>(seconds / 0.008); ++i) {
      sim::Truth truth = body_at(0);
      truth.q_WB_wxyz = {std::cos(0.5), 0, 0, std::sin(0.5)};  // heading 1 rad
      truth.v_WB_m_s = {forward_m_s * std::cos(1.0), forward_m_s * std::sin(1.0), 0};
      truth.angular_velocity_B_rad_s = {0, 0, -0.5};
      log.add(at(0.008 * static_cast<double>(log.samples().size())), in_phase(MissionPhase::kWalk),
              &truth);
    }
  };
  walk(4.0, 2.0);
  EXPECT_EQ(measure(log, -1).sustained.forward_m_s, 0.0);  // too short
  walk(0.5, 1.0);
  walk(4.5, 1.8);
  const SustainedSpeeds speeds = measure(log, -1).sustained;
  EXPECT_NEAR(speeds.forward_m_s, 1.0, 0.02);
  EXPECT_NEAR(speeds.lateral_m_s, 0.0, 1e-9);
  EXPECT_NEAR(speeds.yaw_rate_rad_s, 0.5, 1e-9);
  walk(1.0, 1.8);
  EXPECT_NEAR(measure(log, -1).sustained.forward_m_s, 1.8, 0.02);
}

}  // namespace
}  // namespace surefoot::apps
