#include "core/planning/stance.h"

#include "core/math/elementary.h"
#include "core/robot/kinematics.h"

namespace surefoot::planning {
namespace {

// The feet stand -1/2, -1/4, 0, 1/4 of a stride off their hips when a leg's turn comes: their mean
// lags by 1/8, and the foot goes to 1/2 of a stride ahead.
constexpr double kLandingStrides = 0.625;
constexpr double kShare = 1.0 / static_cast<double>(robot::kLegs);

}  // namespace

Vector2 from_heading(double yaw_rad, double forward, double left) {
  const math::SinCos yaw = math::sin_cos(yaw_rad);
  return {yaw.cos * forward - yaw.sin * left, yaw.sin * forward + yaw.cos * left};
}

Vector3 stance_hip_B_m(const robot::RobotModel& model, double lateral_offset_m, std::size_t leg) {
  Vector3 hip_B = robot::hip_joint_B_m(model, leg);
  hip_B[1] += robot::left_sign(leg) * lateral_offset_m;
  return hip_B;
}

Hips stance_hips_O_m(const robot::RobotModel& model, double lateral_offset_m, double yaw_rad) {
  Hips hips;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const Vector3 hip_B = stance_hip_B_m(model, lateral_offset_m, leg);
    hips[leg] = from_heading(yaw_rad, hip_B[0], hip_B[1]);
  }
  return hips;
}

Vector3 nominal_place_O_m(const Feet& feet_O_m, const Hips& hips_O_m, std::size_t leg,
                          const Vector2& stride_O_m) {
  Vector2 middle = Vector2::Zero();  // of the hips, by the feet
  for (std::size_t i = 0; i < robot::kLegs; ++i) {
    middle += (feet_O_m[i].head<2>() - hips_O_m[i]) * kShare;
  }
  const Vector2 place = middle + hips_O_m[leg] + kLandingStrides * stride_O_m;
  return {place[0], place[1], feet_O_m[leg][2]};
}

TrunkPose trunk_over(const robot::RobotModel& model, const StanceShape& shape, const Feet& feet_O_m,
                     double yaw_rad) {
  Vector3 mean = Vector3::Zero();
  double front_m = 0;  // higher than the hind ones
  double left_m = 0;
  for (std::size_t i = 0; i < robot::kLegs; ++i) {
    mean += feet_O_m[i] * kShare;
    front_m += 0.5 * robot::front_sign(i) * feet_O_m[i][2];
    left_m += 0.5 * robot::left_sign(i) * feet_O_m[i][2];
  }
  const Vector3 hip_B = robot::hip_joint_B_m(model, robot::kFrontLeft);
  TrunkPose pose;
  pose.roll_pitch_yaw_rad = {shape.slope_share * math::atan2(left_m, 2.0 * hip_B[1]),
                             -shape.slope_share * math::atan2(front_m, 2.0 * hip_B[0]), yaw_rad};
  pose.height_O_m = mean[2] - model.foot_radius_m + shape.body_height_m;
  pose.centre_O_m = mean.head<2>();
  return pose;
}

Triangle standing_triangle(const Feet& feet_O_m, std::size_t turn) {
  Triangle triangle;
  std::size_t corners = 0;
  for (std::size_t i = 0; i < robot::kLegs; ++i) {
    if (i != step_leg(turn)) triangle.corners_O_m[corners++] = feet_O_m[i].head<2>();
  }
  return triangle;
}

CentrePlace place_centre(const Feet& feet_O_m, const Feet& landed_O_m, std::size_t turn,
                         double margin_m, const Vector2& wanted_O_m) {
  const Triangle now = standing_triangle(feet_O_m, turn);
  const Triangle next = standing_triangle(landed_O_m, turn + 1);
  SupportRegion both;
  if (ok(both.add(now, margin_m)) && ok(both.add(next, margin_m))) {
    const Result<Vector2> place = both.nearest(wanted_O_m);
    if (place.ok()) return {place.value(), false};
  }
  SupportRegion one;
  const double kept_m = kept_margin_m(now.inradius_m(), margin_m);
  const CentrePlace anywhere{wanted_O_m, kept_m < margin_m};
  if (!ok(one.add(now, kept_m))) return anywhere;
  const Result<Vector2> place = one.nearest(wanted_O_m);
  return place.ok() ? CentrePlace{place.value(), anywhere.narrow} : anywhere;
}

}  // namespace surefoot::planning
