// The walk with one leg in the air, in a world without forces.
#include "core/control/static_walk.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "tests/support/static_walk_world.h"

namespace surefoot::control {
namespace {

using tests::StaticWalkWorld;

VelocityCommand forward(double speed_m_s) { return {.forward_m_s = speed_m_s}; }

TEST(StaticWalk, KeepsTheCentreOfMassOverTheStandingFeetByTheMargin) {
  StaticWalkWorld world;
  double least_m = 1;
  for (int i = 0; i < 10000; ++i) {
    world.tick(forward(0.06), true);
    ASSERT_LE(world.in_the_air(), 1);
    if (world.in_the_air() == 0) continue;
    planning::Triangle triangle;
    std::size_t corners = 0;
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      if (world.walk->legs()[leg].mode != LegMode::kStance) continue;
      triangle.corners_O_m[corners++] = world.state.feet[leg].p_O_m.head<2>();
    }
    planning::SupportRegion region;
    ASSERT_EQ(region.add(triangle, 0.0), Status::kOk);
    ASSERT_TRUE(region.contains(world.centre_O_m())) << "tick " << i;
    for (double margin_m = 0.002; margin_m < 0.03; margin_m += 0.001) {
      planning::SupportRegion drawn_in;
      ASSERT_EQ(drawn_in.add(triangle, margin_m), Status::kOk);
      if (drawn_in.contains(world.centre_O_m())) continue;
      least_m = std::min(least_m, margin_m);
      break;
    }
  }
  EXPECT_GE(least_m, 0.018);
  EXPECT_GT(world.walk->counters().steps, 30U);
  EXPECT_EQ(world.walk->counters().narrow, 0U);
}

TEST(StaticWalk, StepsHindThenFrontOfEachSide) {
  StaticWalkWorld world;
  std::vector<std::size_t> order;
  std::array<bool, robot::kLegs> was{};
  for (int i = 0; i < 6000; ++i) {
    world.tick(forward(0.06), true);
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      const bool swings = world.walk->legs()[leg].mode == LegMode::kSwing;
      if (swings && !was[leg]) order.push_back(leg);
      was[leg] = swings;
    }
  }
  ASSERT_GE(order.size(), 12U);
  const std::array<std::size_t, 4> expected{robot::kHindRight, robot::kFrontRight, robot::kHindLeft,
                                            robot::kFrontLeft};
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], expected[i % 4]);
}

// Four steps carry the trunk by one stride, and a stride is what is commanded for a cycle, at most
// the longest.
TEST(StaticWalk, GoesAStrideInFourSteps) {
  StaticWalkWorld world;
  for (int i = 0; i < 10000; ++i) world.tick(forward(1.0), true);
  const double from_m = world.state.p_OB_m[0];
  const std::uint64_t steps = world.walk->counters().steps;
  for (int i = 0; i < 10000; ++i) world.tick(forward(1.0), true);
  const double made = static_cast<double>(world.walk->counters().steps - steps);
  EXPECT_NEAR((world.state.p_OB_m[0] - from_m) / (made / 4.0), 0.12, 0.006);
  EXPECT_NEAR(world.state.p_OB_m[1], 0.0, 0.04);
}

TEST(StaticWalk, FinishesItsStepAndStandsStillWhenAskedTo) {
  StaticWalkWorld world;
  for (int i = 0; i < 1500; ++i) world.tick(forward(0.06), true);
  int ticks = 0;
  for (; ticks < 1000 && !world.walk->at_rest(); ++ticks) world.tick({}, false);
  ASSERT_TRUE(world.walk->at_rest());
  const std::uint64_t steps = world.walk->counters().steps;
  for (int i = 0; i < 1000; ++i) world.tick({}, false);
  EXPECT_EQ(world.walk->counters().steps, steps);
  EXPECT_EQ(world.in_the_air(), 0);
}

// A hole under the foot that steps first: it comes back to where it stood, again and again.
TEST(StaticWalk, AFootThatFindsNoGroundGoesBack) {
  StaticWalkWorld world;
  const Vector3 home = world.state.feet[robot::kHindRight].p_O_m;
  world.ground_m[robot::kHindRight] = -1.0;
  for (int i = 0; i < 1000 && world.walk->counters().missed == 0; ++i) {
    world.tick(forward(0.06), true);
  }
  ASSERT_EQ(world.walk->counters().missed, 1U);
  world.ground_m[robot::kHindRight] = 0.0;
  for (int i = 0; i < 1000 && world.walk->counters().steps == 0; ++i) {
    world.tick(forward(0.06), true);
  }
  ASSERT_EQ(world.walk->counters().steps, 1U);
  EXPECT_LT((world.state.feet[robot::kHindRight].p_O_m - home).norm(), 0.005);
}

// A standing foot slides off its edge: the foot in the air comes down there, and the walk goes on
// from where the feet are.
TEST(StaticWalk, PutsTheFootDownWhenAnotherOneSlips) {
  StaticWalkWorld world;
  for (int i = 0; i < 1000 && world.in_the_air() == 0; ++i) world.tick(forward(0.06), true);
  for (int i = 0; i < 50; ++i) world.tick(forward(0.06), true);
  ASSERT_EQ(world.walk->legs()[robot::kHindRight].mode, LegMode::kSwing);
  world.state.feet[robot::kFrontLeft].p_O_m += Vector3(0.02, 0.0, -0.01);
  world.tick(forward(0.06), true);
  EXPECT_EQ(world.walk->legs()[robot::kHindRight].mode, LegMode::kSearch);
  EXPECT_EQ(world.walk->counters().slipped, 1U);
  const Vector2 above = world.state.feet[robot::kHindRight].p_O_m.head<2>();
  for (int i = 0; i < 1000 && world.in_the_air() > 0; ++i) world.tick({}, false);
  EXPECT_TRUE(world.walk->at_rest());
  EXPECT_LT((world.state.feet[robot::kHindRight].p_O_m.head<2>() - above).norm(), 0.01);
  for (int i = 0; i < 2000; ++i) world.tick(forward(0.06), true);
  EXPECT_GE(world.walk->counters().steps, 6U);
}

// The worst of both: another foot slips, and there is no ground under the one in the air.
TEST(StaticWalk, AfterASlipAFootThatFindsNoGroundStillGoesBack) {
  StaticWalkWorld world;
  for (int i = 0; i < 1000 && world.in_the_air() == 0; ++i) world.tick(forward(0.06), true);
  const Vector3 home = world.state.feet[robot::kHindRight].p_O_m;
  for (int i = 0; i < 80; ++i) world.tick(forward(0.06), true);
  world.state.feet[robot::kFrontLeft].p_O_m += Vector3(0.02, 0.0, -0.01);
  world.ground_m[robot::kHindRight] = -1.0;
  for (int i = 0; i < 1000 && world.walk->counters().missed == 0; ++i) world.tick({}, false);
  ASSERT_EQ(world.walk->counters().missed, 1U);
  world.ground_m[robot::kHindRight] = 0.0;
  for (int i = 0; i < 1000 && world.in_the_air() > 0; ++i) world.tick({}, false);
  EXPECT_EQ(world.walk->counters().slipped, 1U);
  EXPECT_EQ(world.walk->counters().missed, 1U);
  EXPECT_LT((world.state.feet[robot::kHindRight].p_O_m - home).head<2>().norm(), 0.02);
}

// What legs are told and where their feet are agree within `slack_m`.
TEST(StaticWalk, AStandingFootThatSlidesOffAnEdgeIsFollowed) {
  const Vector3 slide(0.008, 0.0, -0.006);
  for (const double slack_m : {0.003, 0.5}) {
    ControlConfig config = tests::static_walk_config();
    config.static_walk.slack_m = slack_m;
    StaticWalkWorld world(config);
    for (int i = 0; i < 500; ++i) world.tick({}, false);
    const Vector3 told = world.state.feet[robot::kFrontLeft].p_B_m;
    world.state.feet[robot::kFrontLeft].p_O_m += slide;
    for (int i = 0; i < 10; ++i) world.tick({}, false);
    const Vector3 followed = world.state.feet[robot::kFrontLeft].p_B_m - told;
    const double wanted_m = slack_m < slide.norm() ? slide.norm() - slack_m : 0.0;
    EXPECT_NEAR(followed.norm(), wanted_m, 1e-4);
    EXPECT_NEAR(followed.dot(slide), wanted_m * slide.norm(), 1e-6);
    EXPECT_EQ(world.walk->counters().slipped, 0U);  // no foot was in the air
  }
}

TEST(StaticWalk, AStandingFootWithoutGroundGoesDownUntilItFeelsSome) {
  StaticWalkWorld world;
  for (int i = 0; i < 500; ++i) world.tick({}, false);
  estimation::FootState& foot = world.state.feet[robot::kFrontLeft];
  const double told_m = foot.p_B_m[2];
  foot.in_contact = false;
  for (int i = 0; i < 10; ++i) world.tick({}, false);
  EXPECT_NEAR(foot.p_B_m[2], told_m, 1e-6);  // a touch that is missed for 20 ms is nothing
  for (int i = 0; i < 105; ++i) world.tick({}, false);
  EXPECT_NEAR(foot.p_B_m[2], told_m - 0.02, 0.001);
  for (int i = 0; i < 1000; ++i) world.tick({}, false);
  EXPECT_NEAR(foot.p_B_m[2], told_m - 0.04, 1e-4);  // search_depth_m
  EXPECT_TRUE(world.walk->at_rest());
}

// In the shift before the first step, told to `happen` at its half.
template <class Happen>
StaticWalkWorld halfway_shifted(const Happen& happen) {
  StaticWalkWorld world;
  for (int i = 0; i < 300; ++i) world.tick({}, false);
  for (int i = 0; i < 40; ++i) world.tick(forward(0.06), true);
  EXPECT_EQ(world.in_the_air(), 0);
  EXPECT_FALSE(world.walk->at_rest());
  happen(world);
  return world;
}

// A foot that slides while the trunk leans on it: back over all four.
TEST(StaticWalk, ASlipDuringAShiftBringsTheTrunkBackOverItsFeet) {
  StaticWalkWorld world = halfway_shifted([](StaticWalkWorld& w) {
    w.state.feet[robot::kFrontLeft].p_O_m += Vector3(0.014, 0.0, 0.0);
  });
  world.tick(forward(0.06), true);
  EXPECT_EQ(world.walk->counters().slipped, 1U);
  EXPECT_EQ(world.walk->counters().retreated, 1U);
  for (int i = 0; i < 1000 && !world.walk->at_rest(); ++i) world.tick({}, false);
  ASSERT_TRUE(world.walk->at_rest());
  EXPECT_EQ(world.walk->counters().steps, 0U);
  Vector2 middle = Vector2::Zero();
  for (const estimation::FootState& foot : world.state.feet) middle += 0.25 * foot.p_O_m.head<2>();
  EXPECT_LT((world.centre_O_m() - middle).norm(), 0.008);
  for (int i = 0; i < 3000; ++i) world.tick(forward(0.06), true);
  EXPECT_GE(world.walk->counters().steps, 4U);
}

// One that loses its ground is waited for, then the trunk goes back.
TEST(StaticWalk, AShiftWaitsForAFootThatLostItsGround) {
  StaticWalkWorld world = halfway_shifted(
      [](StaticWalkWorld& w) { w.state.feet[robot::kFrontLeft].in_contact = false; });
  for (int i = 0; i < 20; ++i) world.tick(forward(0.06), true);
  const Vector2 waits = world.centre_O_m();
  for (int i = 0; i < 20; ++i) world.tick(forward(0.06), true);
  EXPECT_LT((world.centre_O_m() - waits).norm(), 0.002);
  EXPECT_EQ(world.walk->counters().retreated, 0U);
  for (int i = 0; i < 150; ++i) world.tick(forward(0.06), true);
  EXPECT_EQ(world.walk->counters().retreated, 1U);
  EXPECT_EQ(world.in_the_air(), 0);
}

// Legs would lift off over a trunk that still runs towards the side that they leave.
TEST(StaticWalk, NoFootLiftsBeforeTheCapturePointIsOverTheOthers) {
  ControlConfig config = tests::static_walk_config();
  config.static_walk.lift_margin_m = 0.008;
  config.static_walk.patience_s = 0.5;
  StaticWalkWorld world(config);
  const auto run_sideways = [&world](double speed_m_s, int ticks) {
    for (int i = 0; i < ticks && world.in_the_air() == 0; ++i) {
      world.state.v_OB_m_s = Vector3(0.0, speed_m_s, 0.0);
      world.tick(forward(0.06), true);
    }
  };
  run_sideways(-0.5, 3000);  // the leg whose turn it is is a right one
  EXPECT_EQ(world.in_the_air(), 0);
  EXPECT_EQ(world.walk->counters().steps, 0U);
  EXPECT_GE(world.walk->counters().waited, 3U);
  run_sideways(0.0, 1000);
  EXPECT_EQ(world.walk->legs()[robot::kHindRight].mode, LegMode::kSwing);
}

TEST(StaticWalk, NoFootLiftsWhileAnotherFeelsNoGround) {
  ControlConfig config = tests::static_walk_config();
  config.static_walk.patience_s = 0.5;
  StaticWalkWorld world(config);
  world.state.feet[robot::kFrontRight].in_contact = false;
  for (int i = 0; i < 3000; ++i) world.tick(forward(0.06), true);
  EXPECT_EQ(world.walk->counters().steps, 0U);
  EXPECT_EQ(world.in_the_air(), 0);
  world.state.feet[robot::kFrontRight].in_contact = true;
  for (int i = 0; i < 1000 && world.in_the_air() == 0; ++i) world.tick(forward(0.06), true);
  EXPECT_EQ(world.in_the_air(), 1);
}

// The shift keeps to its mean speed with all of its way: sideways, up, and of the hips about the
// trunk's middle.
TEST(StaticWalk, TheShiftLastsLongerWhenTheTrunkMustRiseOrTurn) {
  const auto ticks_of_first_shift = [](double landing_m) {
    StaticWalkWorld world;
    for (int i = 0; i < 500; ++i) world.tick({}, false);
    const auto map = tests::terrain_of(
        [landing_m](mapping::CellIndex) { return tests::GroundCell{.height_m = landing_m}; });
    int ticks = 0;
    while (world.in_the_air() == 0 && ticks < 1000) {
      world.tick(forward(0.06), true, &map->ground);
      ++ticks;
    }
    return ticks;
  };
  const int level = ticks_of_first_shift(0.0);
  const int low = ticks_of_first_shift(0.02);
  const int high = ticks_of_first_shift(0.04);
  EXPECT_GT(level, 50);
  EXPECT_GE(low, level + 3);
  EXPECT_GE(high, low + 6);
}

TEST(StaticWalk, AfterAMishapTheTrunkShiftsSlowly) {
  const auto ticks_after_slip = [](double caution, int cautious_steps) {
    ControlConfig config = tests::static_walk_config();
    config.static_walk.caution = caution;
    config.static_walk.cautious_steps = cautious_steps;
    StaticWalkWorld world(config);
    for (int i = 0; i < 1000 && world.in_the_air() == 0; ++i) world.tick(forward(0.06), true);
    world.state.feet[robot::kFrontLeft].p_O_m += Vector3(0.013, 0.0, 0.0);
    const std::uint64_t steps = world.walk->counters().steps + 5;
    int ticks = 0;
    for (; ticks < 20000 && world.walk->counters().steps < steps; ++ticks) {
      world.tick(forward(0.06), true);
    }
    EXPECT_EQ(world.walk->counters().slipped, 1U);
    return ticks;
  };
  const int bold = ticks_after_slip(1.0, 4);
  EXPECT_EQ(ticks_after_slip(0.5, 0), bold);
  EXPECT_GT(ticks_after_slip(0.5, 4), bold + 100);
}

TEST(StaticWalk, StandsAndCountsWhereNoFootholdIs) {
  StaticWalkWorld world;
  auto window = std::make_unique<mapping::MapWindow>();
  window->stamp = milliseconds(1);
  window->cell_size_m = 0.01;
  window->first = {-50, -50};
  for (mapping::WindowCell& cell : window->cells) {
    cell.state = mapping::CellState::kMeasured;
    cell.traversability = mapping::Traversability::kUnsteppable;
  }
  for (int i = 0; i < 500; ++i) world.tick(forward(0.06), true, window.get());
  EXPECT_NEAR(world.walk->blocked_s(), 1.0, 0.01);
  EXPECT_EQ(world.walk->counters().steps, 0U);
  EXPECT_EQ(world.in_the_air(), 0);
  world.tick(forward(0.06), false, window.get());
  EXPECT_EQ(world.walk->blocked_s(), 0.0);
}

// Filled terrain with a costly band across the way: feet step before and behind it.
TEST(StaticWalk, OnFilledTerrainItsFeetAvoidACostlyBand) {
  constexpr double kBand_m[2] = {0.15, 0.19};
  const auto map = tests::terrain_of([](mapping::CellIndex i) {
    return tests::GroundCell{.cost = i.ix >= 15 && i.ix < 19 ? 0.6 : 0.0};
  });
  const auto touchdowns_in_band = [&](const terrain::TerrainMap* terrain) {
    StaticWalkWorld world;
    std::uint64_t steps = 0;
    int inside = 0;
    for (int i = 0; i < 20000 && world.state.p_OB_m[0] < 0.32; ++i) {
      world.tick(forward(0.06), true, &map->ground, terrain);
      if (world.walk->counters().steps == steps) continue;
      steps = world.walk->counters().steps;
      for (const estimation::FootState& foot : world.state.feet) {
        inside += foot.p_O_m[0] > kBand_m[0] && foot.p_O_m[0] < kBand_m[1] ? 1 : 0;
      }
    }
    EXPECT_GE(world.state.p_OB_m[0], 0.32);
    return inside;
  };
  EXPECT_GT(touchdowns_in_band(nullptr), 0);
  EXPECT_EQ(touchdowns_in_band(map.get()), 0);
}

TEST(StaticWalk, FilledTerrainTakesTheWindowsPlaceOnceItIsThere) {
  StaticWalkWorld world;
  const auto map = tests::flat_terrain();
  const auto unpublished = std::make_unique<terrain::TerrainMap>();
  world.tick(forward(0.06), true, &map->ground, unpublished.get());
  const LegStatus& first = world.walk->legs()[robot::kHindRight];
  EXPECT_EQ(first.foothold.reason, FootholdReason::kNominal);
  StaticWalkWorld filled;
  filled.tick(forward(0.06), true, nullptr, map.get());
  EXPECT_EQ(filled.walk->legs()[robot::kHindRight].foothold.reason, FootholdReason::kPlanned);
  EXPECT_EQ(filled.walk->legs()[robot::kHindRight].foothold.position_O_m,
            first.foothold.position_O_m);
}

TEST(StaticWalk, StandsAndCountsWhereNoFootstepIsFound) {
  StaticWalkWorld world;
  const auto unknown =
      tests::terrain_of([](mapping::CellIndex) { return tests::GroundCell{.known = false}; });
  for (int i = 0; i < 500; ++i) world.tick(forward(0.06), true, nullptr, unknown.get());
  EXPECT_NEAR(world.walk->blocked_s(), 1.0, 0.01);
  EXPECT_EQ(world.walk->counters().steps, 0U);
}

// The hind right leg has its turn, and all the ground around its place is bad.
TEST(StaticWalk, ALegWithoutAFootholdIsPassedOver) {
  StaticWalkWorld world;
  const auto map = tests::terrain_of([](mapping::CellIndex i) {
    return tests::GroundCell{.cost = i.ix < 0 && i.iy < 0 ? 0.9 : 0.0};
  });
  for (int i = 0; i < 1000 && world.in_the_air() == 0; ++i) {
    world.tick(forward(0.06), true, nullptr, map.get());
  }
  EXPECT_EQ(world.walk->legs()[robot::kFrontRight].mode, LegMode::kSwing);
  EXPECT_EQ(world.walk->counters().passed_over, 1U);
  EXPECT_EQ(world.walk->blocked_s(), 0.0);
  for (int i = 0; i < 1000 && world.walk->counters().steps < 2; ++i) {
    world.tick(forward(0.06), true, nullptr, map.get());
  }
  EXPECT_EQ(world.walk->counters().passed_over, 1U);  // the next two legs have their places
}

// The place that the hind right foot goes to when its turn comes again after it has missed the
// ground on a robot that steps on the spot, from that first place.
double second_try_m(double avoid_m) {
  ControlConfig config = tests::static_walk_config();
  config.footsteps.avoid_m = avoid_m;
  StaticWalkWorld world(config);
  const auto map = tests::flat_terrain();
  const auto tick = [&] { world.tick({}, true, nullptr, map.get()); };
  const LegStatus& leg = world.walk->legs()[robot::kHindRight];
  world.ground_m[robot::kHindRight] = -1.0;
  for (int i = 0; i < 1000 && leg.mode == LegMode::kStance; ++i) tick();
  const Vector2 first = leg.path.landing_O_m.head<2>();
  for (int i = 0; i < 1000 && world.walk->counters().missed == 0; ++i) tick();
  world.ground_m[robot::kHindRight] = 0.0;
  for (int i = 0; i < 4000 && leg.mode != LegMode::kStance; ++i) tick();
  for (int i = 0; i < 4000 && leg.mode == LegMode::kStance; ++i) tick();
  EXPECT_EQ(leg.mode, LegMode::kSwing);
  EXPECT_EQ(world.walk->counters().missed, 1U);
  return (leg.path.landing_O_m.head<2>() - first).norm();
}

TEST(StaticWalk, APlaceWithoutGroundIsAvoided) {
  EXPECT_LT(second_try_m(0.0), 0.005);
  EXPECT_GE(second_try_m(0.012), 0.012);
}

// Neither at the new place nor at the old one: the foot stays in the air as one that stands there,
// and looks for the ground further down.
TEST(StaticWalk, AFootThatMissesItsGroundTwiceHangsThere) {
  StaticWalkWorld world;
  world.ground_m[robot::kHindRight] = -1.0;
  for (int i = 0; i < 3000 && world.walk->counters().missed < 2; ++i) {
    world.tick(forward(0.06), true);
  }
  EXPECT_EQ(world.walk->counters().missed, 2U);
  EXPECT_EQ(world.walk->legs()[robot::kHindRight].mode, LegMode::kStance);
  EXPECT_EQ(world.in_the_air(), 0);
  // It keeps its turn: the others carry, and it looks for another place.
  for (int i = 0; i < 1000 && world.in_the_air() == 0; ++i) world.tick(forward(0.06), true);
  EXPECT_EQ(world.walk->legs()[robot::kHindRight].mode, LegMode::kSwing);
}

// What feet met before a start is not remembered after it.
TEST(StaticWalk, AStartForgetsAvoidedPlaces) {
  const auto map = tests::flat_terrain();
  const auto landing_m = [&](bool missed_before) {
    StaticWalkWorld world;
    const estimation::RobotState begin = world.state;
    if (missed_before) {
      world.ground_m[robot::kHindRight] = -1.0;
      for (int i = 0; i < 3000 && world.walk->counters().missed == 0; ++i) {
        world.tick({}, true, nullptr, map.get());
      }
      EXPECT_EQ(world.walk->counters().missed, 1U);
      world.ground_m[robot::kHindRight] = 0.0;
    }
    world.state = begin;
    world.walk->start(world.state);
    world.tick({}, true, nullptr, map.get());
    return world.walk->legs()[robot::kHindRight].foothold.position_O_m;
  };
  EXPECT_EQ(landing_m(true), landing_m(false));
}

// A search costs milliseconds at worst: one leg is asked in a tick, and when all four have been
// asked in vain a blocked robot waits for 0.1 s.
TEST(StaticWalk, ABlockedRobotSearchesAgainAfterATenthOfASecond) {
  StaticWalkWorld world;
  const auto unknown =
      tests::terrain_of([](mapping::CellIndex) { return tests::GroundCell{.known = false}; });
  const auto flat = tests::flat_terrain();
  for (int leg = 0; leg < 4; ++leg) world.tick(forward(0.06), true, nullptr, unknown.get());
  ASSERT_GT(world.walk->blocked_s(), 0.0);
  int ticks = 0;
  for (; ticks < 200 && world.walk->at_rest(); ++ticks) {
    world.tick(forward(0.06), true, nullptr, flat.get());
  }
  EXPECT_GE(ticks, 50);
  EXPECT_LE(ticks, 52);
  EXPECT_EQ(world.walk->blocked_s(), 0.0);
}

}  // namespace
}  // namespace surefoot::control
