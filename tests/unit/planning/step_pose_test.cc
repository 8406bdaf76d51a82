// The trunk's pose for a step on ground that was made for it.
#include "core/planning/step_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/base/random.h"
#include "core/geometry/rotations.h"
#include "tests/support/footstep_parts.h"

namespace surefoot::planning {
namespace {

using tests::GroundCell;

// Stands with its feet below its hips; the hind right leg steps forward by 2 cm.
struct Stance {
  Stance() : feet(tests::standing_feet(model)), landed(feet) {
    landed[robot::kHindRight][0] += 0.02;
  }

  Step step() const { return {feet, landed, 0, 0.0, Vector2::Zero()}; }
  StepPose pose(const terrain::TerrainMap* map = nullptr) const {
    return step_pose(model, shape, limits, {map, 0.0}, step());
  }
  TrunkPose usual() const {
    TrunkPose pose = trunk_over(model, shape, landed, 0.0);
    pose.centre_O_m = place_centre(feet, landed, 0, shape.margin_m, pose.centre_O_m).place_O_m;
    return pose;
  }
  // In a pose with B's origin at its centre: whether every leg gets there between its stops.
  bool serves(const TrunkPose& pose) const {
    return serves(pose, limits.reach_margin_m, limits.stop_margin_rad);
  }
  bool serves(const TrunkPose& pose, double reach_margin_m, double stop_margin_rad) const {
    const Vector3& rpy = pose.roll_pitch_yaw_rad;
    const Matrix3 R_OB = geometry::from_roll_pitch_yaw(rpy[0], rpy[1], rpy[2]);
    const Vector3 p_OB_m(pose.centre_O_m[0], pose.centre_O_m[1], pose.height_O_m);
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      for (const Vector3& foot : {feet[leg], landed[leg]}) {
        const Vector3 foot_B = R_OB.transpose() * (foot - p_OB_m);
        if (!robot::can_reach(model, leg, foot_B, reach_margin_m)) return false;
        const robot::LegVector q = robot::solve_leg(model, leg, foot_B).q_rad;
        if (!robot::within_stops(model, leg, q, stop_margin_rad)) return false;
      }
    }
    return true;
  }

  robot::RobotModel model = robot::little_dog();
  StanceShape shape = tests::footstep_shape();
  StepLimits limits = step_limits(tests::footstep_config());
  Feet feet;
  Feet landed;
};

std::unique_ptr<terrain::TerrainMap> rock_under_the_belly(double height_m) {
  return tests::terrain_of([height_m](mapping::CellIndex i) {
    return GroundCell{.height_m = std::abs(i.ix) < 4 && std::abs(i.iy) < 3 ? height_m : 0.0};
  });
}

TEST(StepPose, OnLevelGroundItIsTheUsualOne) {
  const auto map = tests::flat_terrain();
  const Stance stance;
  for (const terrain::TerrainMap* ground :
       {map.get(), static_cast<terrain::TerrainMap*>(nullptr)}) {
    const StepPose pose = stance.pose(ground);
    EXPECT_TRUE(pose.reaches);
    EXPECT_FALSE(pose.lowered);
    EXPECT_FALSE(pose.narrow);
    EXPECT_EQ(pose.deepest_m, 0.0);
    EXPECT_EQ(pose.pose.height_O_m, stance.usual().height_O_m);
    EXPECT_EQ(pose.pose.centre_O_m, stance.usual().centre_O_m);
    EXPECT_EQ(pose.pose.roll_pitch_yaw_rad, stance.usual().roll_pitch_yaw_rad);
  }
}

// The underside of the trunk is 10 cm above the ground.
TEST(StepPose, RisesOverARockUnderTheBellyByNoMoreThanNeeded) {
  const Stance stance;
  for (int steps = 0; steps <= 3; ++steps) {
    const auto map = rock_under_the_belly(0.099 + 0.006 * steps);
    const StepPose pose = stance.pose(map.get());
    EXPECT_TRUE(pose.reaches);
    EXPECT_FALSE(pose.lowered);
    EXPECT_EQ(pose.deepest_m, 0.0) << steps;
    EXPECT_NEAR(pose.pose.height_O_m, stance.usual().height_O_m + 0.006 * steps, 1e-12);
    EXPECT_TRUE(stance.serves(pose.pose));
  }
}

TEST(StepPose, IsLeastDeepWhereItCannotBeClear) {
  Stance stance;
  const auto map = rock_under_the_belly(0.15);
  StepPose pose = stance.pose(map.get());
  EXPECT_TRUE(pose.reaches);
  EXPECT_NEAR(pose.pose.height_O_m, stance.usual().height_O_m + 0.018, 1e-12);
  EXPECT_NEAR(pose.deepest_m, 0.15 - 0.118, 1e-6);
  stance.limits.max_raising_m = 0.0;
  pose = stance.pose(map.get());
  EXPECT_NEAR(pose.pose.height_O_m, stance.usual().height_O_m, 1e-12);
  EXPECT_NEAR(pose.deepest_m, 0.05, 1e-6);
}

TEST(StepPose, TheMapsOffsetCounts) {
  const Stance stance;
  const auto map = rock_under_the_belly(0.099);
  const StepPose pose =
      step_pose(stance.model, stance.shape, stance.limits, {map.get(), 0.006}, stance.step());
  EXPECT_NEAR(pose.pose.height_O_m, stance.usual().height_O_m + 0.006, 1e-12);
}

// The rock is where the belly is once the centre of mass lies off B's origin.
TEST(StepPose, TheTrunkStandsBesideItsCentreOfMass) {
  const Stance stance;
  const TrunkPose usual = stance.usual();
  const Vector2 off(0.06, 0.0);
  const Vector2 origin = usual.centre_O_m - off;
  const mapping::CellIndex under = mapping::cell_index(origin[0], origin[1], 0.01);
  const auto map = tests::terrain_of(
      [under](mapping::CellIndex i) { return GroundCell{.height_m = i == under ? 0.12 : 0.0}; });
  EXPECT_EQ(stance.pose(map.get()).deepest_m, 0.0);
  StepLimits fixed = stance.limits;
  fixed.max_lowering_m = 0.0;
  fixed.max_raising_m = 0.0;
  fixed.reach_margin_m = 0.0;
  const StepPose pose = step_pose(stance.model, stance.shape, fixed, {map.get(), 0.0},
                                  {stance.feet, stance.landed, 0, 0.0, off});
  ASSERT_TRUE(pose.reaches);
  EXPECT_NEAR(pose.deepest_m, 0.02, 1e-6);
}

// Feet anywhere: the usual pose where it serves, else one that is lower, higher or along all of the
// slope; none only where none of them serves.
TEST(StepPose, LegsOfVeryDifferentHeightAreReachedLowerOrAlongTheSlope) {
  Random random(4);
  int lower = 0;
  int along = 0;
  int never = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    Stance stance;
    for (Vector3& foot : stance.feet) {
      foot += Vector3{random.uniform(-0.05, 0.05), random.uniform(-0.02, 0.02),
                      random.uniform(-0.06, 0.06)};
    }
    stance.landed = stance.feet;
    stance.landed[robot::kHindRight] += Vector3(random.uniform(0.0, 0.08), 0.0, 0.0);
    const StepPose pose = stance.pose();
    const TrunkPose usual = stance.usual();
    if (stance.serves(usual)) {
      EXPECT_TRUE(pose.reaches);
      EXPECT_EQ(pose.pose.height_O_m, usual.height_O_m);
      continue;
    }
    if (pose.reaches) {
      EXPECT_TRUE(stance.serves(pose.pose)) << trial;
      lower += pose.lowered ? 1 : 0;
      along += pose.pose.roll_pitch_yaw_rad != usual.roll_pitch_yaw_rad ? 1 : 0;
      continue;
    }
    ++never;
    for (const double share : {stance.shape.slope_share, 1.0}) {
      Stance inclined = stance;
      inclined.shape.slope_share = share;
      for (int i = -5; i <= 3; ++i) {
        TrunkPose tried = inclined.usual();
        tried.height_O_m += 0.006 * i;
        EXPECT_FALSE(inclined.serves(tried, 1e-9 + stance.limits.reach_margin_m,
                                     1e-9 + stance.limits.stop_margin_rad))
            << trial;
      }
    }
  }
  EXPECT_GT(lower, 20);
  EXPECT_GE(along, 3);
  EXPECT_GT(never, 20);
}

// Knees that cannot be as straight, or as bent, as the usual pose wants them.
TEST(StepPose, AJointStopInTheWayMakesItLowerOrHigher) {
  const Stance usual;
  const auto knee_rad = [&](std::size_t leg, const Vector3& foot) {
    const TrunkPose pose = usual.usual();
    const Vector3 p_OB_m(pose.centre_O_m[0], pose.centre_O_m[1], pose.height_O_m);
    return std::abs(robot::solve_leg(usual.model, leg, foot - p_OB_m).q_rad[2]);
  };
  double straightest = 10;
  double most_bent = 0;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    for (const Vector3& foot : {usual.feet[leg], usual.landed[leg]}) {
      straightest = std::min(straightest, knee_rad(leg, foot));
      most_bent = std::max(most_bent, knee_rad(leg, foot));
    }
  }
  Stance bent;
  bent.model.actuators[2].min_rad = straightest - 0.02;  // the margin is 0.03
  const StepPose low = bent.pose();
  EXPECT_TRUE(low.reaches);
  EXPECT_TRUE(low.lowered);
  EXPECT_LT(low.pose.height_O_m, usual.usual().height_O_m);
  EXPECT_TRUE(bent.serves(low.pose));
  Stance straight;
  straight.model.actuators[2].max_rad = most_bent + 0.02;
  const StepPose high = straight.pose();
  EXPECT_TRUE(high.reaches);
  EXPECT_FALSE(high.lowered);
  EXPECT_GT(high.pose.height_O_m, usual.usual().height_O_m);
  EXPECT_TRUE(straight.serves(high.pose));
}

TEST(StepPose, WhereNothingReachesItSaysSoAndIsFinite) {
  Stance far;
  for (Vector3& foot : far.landed) foot *= 4.0;
  Stance stopped;
  for (robot::Actuator& actuator : stopped.model.actuators) actuator.min_rad = actuator.max_rad;
  const auto map = tests::flat_terrain();
  for (const Stance* stance : {&far, &stopped}) {
    const StepPose pose = stance->pose(map.get());
    EXPECT_FALSE(pose.reaches);
    EXPECT_TRUE(std::isfinite(pose.pose.height_O_m));
    EXPECT_TRUE(pose.pose.centre_O_m.allFinite());
    EXPECT_TRUE(pose.pose.roll_pitch_yaw_rad.allFinite());
    EXPECT_NEAR(pose.pose.height_O_m, stance->usual().height_O_m, 0.0301);
  }
}

}  // namespace
}  // namespace surefoot::planning
