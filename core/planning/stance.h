// How a robot stands and steps that walks with one leg in the air at a time: the order of legs, the
// place a foot should go to, the trunk over its feet. The static walk does so, the search for
// footsteps reckons with it.
//
// Frames: O, metres; feet are the centres of the foot spheres, legs FR FL HR HL (robot_model.h).
// Cost: nominal 20 flops, trunk two arc tangents, centre two calls of SupportRegion::nearest().
#pragma once

#include <array>
#include <cstddef>

#include "core/math/linear.h"
#include "core/planning/support_region.h"
#include "core/robot/robot_model.h"

namespace surefoot::planning {

// Legs of one side follow each other, the hind one first: its step brings the foot to where the
// front one leaves, and both steps have most of their triangles in common.
inline constexpr std::array<std::size_t, robot::kLegs> kStepOrder{
    robot::kHindRight, robot::kFrontRight, robot::kHindLeft, robot::kFrontLeft};
constexpr std::size_t step_leg(std::size_t turn) { return kStepOrder[turn % robot::kLegs]; }

using Feet = std::array<Vector3, robot::kLegs>;

struct StanceShape {
  double body_height_m = 0;     // B above the ground between the feet
  double slope_share = 0;       // of the slope of the feet's plane that the trunk follows
  double lateral_offset_m = 0;  // of a foot, outwards of its hip
  double margin_m = 0;          // of the centre of mass inside the triangle of standing feet
};

// Axes of the heading to axes of O.
Vector2 from_heading(double yaw_rad, double forward, double left);

// Hip joint and, outwards of it, where a leg stands.
Vector3 stance_hip_B_m(const robot::RobotModel& model, double lateral_offset_m, std::size_t leg);

// The same for all legs from the middle of the hips, seen from above, axes of O.
using Hips = std::array<Vector2, robot::kLegs>;
Hips stance_hips_O_m(const robot::RobotModel& model, double lateral_offset_m, double yaw_rad);

// Where the Raibert rule is for a trot, this is for a crawl: from where the feet stand to half a
// stride ahead of the hip; z is that of the foot. stride_O_m: way of the trunk per four steps.
Vector3 nominal_place_O_m(const Feet& feet_O_m, const Hips& hips_O_m, std::size_t leg,
                          const Vector2& stride_O_m);

// Of the trunk: the centre of mass, the height of B's origin, roll, pitch, yaw.
struct TrunkPose {
  Vector2 centre_O_m = Vector2::Zero();
  double height_O_m = 0;
  Vector3 roll_pitch_yaw_rad = Vector3::Zero();
};

// Over the mean of the feet, along the plane through them.
TrunkPose trunk_over(const robot::RobotModel& model, const StanceShape& shape, const Feet& feet_O_m,
                     double yaw_rad);

struct CentrePlace {
  Vector2 place_O_m = Vector2::Zero();
  bool narrow = false;  // the triangle has no room for the margin, which was cut
};

// The place of the centre of mass, nearest to `wanted`, for the step of `turn` from `feet` to
// `landed` (which differ in that step's foot): inside the triangle of this step and, where that
// leaves room, of the next as well. Feet in a line: `wanted`.
CentrePlace place_centre(const Feet& feet_O_m, const Feet& landed_O_m, std::size_t turn,
                         double margin_m, const Vector2& wanted_O_m);

// Of the feet that stand while the leg whose turn it is is in the air.
Triangle standing_triangle(const Feet& feet_O_m, std::size_t turn);

}  // namespace surefoot::planning
