#include <gtest/gtest.h>

#include "core/control/gait.h"
#include "core/control/swing.h"

namespace surefoot::control {
namespace {

GaitConfig trot() {
  GaitConfig config;
  config.period_s = 0.4;
  config.stance_share = 0.6;
  config.offset = {0.0, 0.5, 0.5, 0.0};
  return config;
}

TEST(Gait, DiagonalPairsMoveTogetherAndAtLeastTwoFeetStand) {
  Gait gait;
  gait.reset(trot());
  int swings = 0;
  for (int tick = 0; tick < 2000; ++tick) {
    gait.advance(0.002);
    const auto& legs = gait.legs();
    EXPECT_EQ(legs[0].stance, legs[3].stance);
    EXPECT_EQ(legs[1].stance, legs[2].stance);
    EXPECT_TRUE(legs[0].stance || legs[1].stance);
    for (const LegPhase& leg : legs) {
      EXPECT_GE(leg.progress, 0.0);
      EXPECT_LE(leg.progress, 1.0);
      EXPECT_GE(leg.remaining_s, -1e-12);
      if (!leg.stance) ++swings;
    }
  }
  EXPECT_NEAR(static_cast<double>(swings) / (2000 * 4), 0.4, 0.01);
}

TEST(Swing, StartsAndEndsAtRestAndClearsTheApex) {
  SwingPath path;
  path.lift_off_O_m = {0.0, 0.1, 0.02};
  path.landing_O_m = {0.15, 0.12, 0.07};
  path.apex_O_m = 0.12;
  const SwingPoint first = evaluate(path, 0.0, 0.2);
  const SwingPoint last = evaluate(path, 1.0, 0.2);
  EXPECT_LT((first.position_O_m - path.lift_off_O_m).norm(), 1e-15);
  EXPECT_LT((last.position_O_m - path.landing_O_m).norm(), 1e-12);
  EXPECT_LT(first.velocity_O_m_s.norm(), 1e-12);
  EXPECT_LT(last.velocity_O_m_s.norm(), 1e-12);
  double highest = 0;
  for (int i = 0; i <= 100; ++i) {
    highest = std::max(highest, evaluate(path, i / 100.0, 0.2).position_O_m[2]);
  }
  EXPECT_NEAR(highest, path.apex_O_m, 1e-12);
}

TEST(Swing, VelocityIsTheDerivativeOfPosition) {
  SwingPath path;
  path.lift_off_O_m = {0.0, 0.0, 0.0};
  path.landing_O_m = {0.1, -0.05, -0.03};
  path.apex_O_m = 0.06;
  constexpr double kDuration_s = 0.17;
  constexpr double kStep = 1e-6;
  for (int i = 1; i < 200; ++i) {
    const double s = i / 200.0;
    const Vector3 difference = (evaluate(path, s + kStep, kDuration_s).position_O_m -
                                evaluate(path, s - kStep, kDuration_s).position_O_m) /
                               (2 * kStep * kDuration_s);
    EXPECT_LT((difference - evaluate(path, s, kDuration_s).velocity_O_m_s).norm(), 1e-4);
  }
}

}  // namespace
}  // namespace surefoot::control
