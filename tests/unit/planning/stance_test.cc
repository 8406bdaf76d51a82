// The static walk's geometry, which the search for footsteps shares.
#include "core/planning/stance.h"

#include <gtest/gtest.h>

#include "tests/support/footstep_parts.h"

namespace surefoot::planning {
namespace {

TEST(Stance, LegsOfASideStepOneAfterTheOtherTheHindOneFirst) {
  for (std::size_t turn = 0; turn < 4; turn += 2) {
    EXPECT_FALSE(robot::is_front(step_leg(turn)));
    EXPECT_TRUE(robot::is_front(step_leg(turn + 1)));
    EXPECT_EQ(robot::is_left(step_leg(turn)), robot::is_left(step_leg(turn + 1)));
  }
  EXPECT_EQ(step_leg(4), step_leg(0));
}

// In the long run feet stand -1/2, -1/4, 0, 1/4 of a stride off their hips, and each goes to 1/2.
TEST(Stance, StepsToHalfAStrideAheadOfTheHip) {
  const robot::RobotModel model = robot::little_dog();
  const double yaw_rad = 0.4;
  const Hips hips = stance_hips_O_m(model, 0.01, yaw_rad);
  Feet feet = tests::standing_feet(model, 0.3, -0.2, yaw_rad);
  const Vector2 stride = from_heading(yaw_rad, 0.1, 0.02);
  for (std::size_t k = 0; k < 400; ++k) {
    const std::size_t leg = step_leg(k);
    feet[leg] = nominal_place_O_m(feet, hips, leg, stride);
  }
  const std::size_t leg = step_leg(0);
  Vector2 middle = Vector2::Zero();
  for (std::size_t i = 0; i < 4; ++i) middle += 0.25 * feet[i].head<2>();
  const Vector2 trunk = middle + stride / 8;
  EXPECT_LT((nominal_place_O_m(feet, hips, leg, stride).head<2>() - trunk - hips[leg] - stride / 2)
                .norm(),
            1e-9);
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector2 off = feet[step_leg(k)].head<2>() - hips[step_leg(k)] - trunk;
    EXPECT_LT((off - (static_cast<double>(k) - 2.0) / 4.0 * stride).norm(), 1e-6) << k;
  }
}

TEST(Stance, TrunkFollowsTheFeetsPlane) {
  const robot::RobotModel model = robot::little_dog();
  const StanceShape shape{0.13, 1.0, 0.0, 0.02};
  Feet feet = tests::standing_feet(model);
  const Vector3 hip_B = robot::hip_joint_B_m(model, robot::kFrontLeft);
  for (std::size_t i = 0; i < 4; ++i) {
    feet[i][2] = model.foot_radius_m + 0.5 + robot::front_sign(i) * 0.2 * hip_B[0] +
                 robot::left_sign(i) * 0.1 * hip_B[1];
  }
  const TrunkPose pose = trunk_over(model, shape, feet, 0.3);
  EXPECT_NEAR(pose.height_O_m, 0.63, 1e-12);
  EXPECT_NEAR(pose.roll_pitch_yaw_rad[0], std::atan(0.1), 1e-9);
  EXPECT_NEAR(pose.roll_pitch_yaw_rad[1], -std::atan(0.2), 1e-9);
  EXPECT_EQ(pose.roll_pitch_yaw_rad[2], 0.3);
}

TEST(Stance, CentreOfMassGoesWhereBothStepsHaveRoom) {
  const robot::RobotModel model = robot::little_dog();
  const Feet feet = tests::standing_feet(model);
  const Hips hips = stance_hips_O_m(model, 0.01, 0.0);
  for (std::size_t turn = 0; turn < 4; ++turn) {
    Feet landed = feet;
    landed[step_leg(turn)] = nominal_place_O_m(feet, hips, step_leg(turn), Vector2(0.08, 0));
    const Triangle now = standing_triangle(feet, turn).drawn_in(0.02);
    const Triangle next = standing_triangle(landed, turn + 1).drawn_in(0.02);
    const CentrePlace centre = place_centre(feet, landed, turn, 0.02, Vector2::Zero());
    EXPECT_FALSE(centre.narrow);
    SupportRegion region;
    ASSERT_TRUE(ok(region.add(now, 0.0)));
    if (distance_m(now, next) == 0.0) {
      ASSERT_TRUE(ok(region.add(next, 0.0)));
    }
    EXPECT_TRUE(region.contains(centre.place_O_m)) << turn;
  }
  EXPECT_TRUE(place_centre(feet, feet, 0, 0.06, Vector2::Zero()).narrow);
}

}  // namespace
}  // namespace surefoot::planning
