// Kinematics of one three-joint leg. Frames, angles and leg numbering: robot_model.h.
// Every function is closed form; none allocates; cost is a few dozen flops plus at most three
// sin_cos.
#pragma once

#include <array>

#include "core/base/status.h"
#include "core/geometry/frames.h"
#include "core/math/linear.h"
#include "core/robot/robot_model.h"

namespace surefoot::robot {

// Joint values of one leg in the order abad, hip, knee.
using LegVector = Vector3;

// Centre of the foot sphere in B [m].
Vector3 foot_position_B_m(const RobotModel& model, std::size_t leg, const LegVector& q_rad);

// d(foot centre)/dq in B [m/rad]. Singular with a straight knee.
Matrix3 foot_jacobian_B(const RobotModel& model, std::size_t leg, const LegVector& q_rad);

// Angular velocity of the shank relative to the trunk, in B [rad/s].
Vector3 shank_angular_velocity_B(const LegVector& q_rad, const LegVector& qd_rad_s);

// The places that span the leg's capsules, in B [m]: abduction joint, hip, knee, foot centre.
struct LegPoints {
  std::array<Vector3, 4> p_B_m;
};
LegPoints leg_points_B(const RobotModel& model, std::size_t leg, const LegVector& q_rad);

// Joint angles that put the foot centre at p_B_m, the knee bent as the robot's knees are (angle
// times bend_sign > 0), the foot below the hip in the leg's plane. Out of reach, the target is
// pulled onto the reachable shell, min_reach .. max_reach from the hip, and the status says
// kOutOfRange; the angles are valid all the same.
struct LegSolution {
  LegVector q_rad;
  Status status;
};
LegSolution solve_leg(const RobotModel& model, std::size_t leg, const Vector3& p_B_m);
// Whether solve_leg() would reach p_B_m with `margin_m` left to either end of the shell: some 20
// flops, no angle.
bool can_reach(const RobotModel& model, std::size_t leg, const Vector3& p_B_m, double margin_m);

// Whether these angles lie between the mechanical stops, with `margin_rad` left to each.
bool within_stops(const RobotModel& model, std::size_t leg, const LegVector& q_rad,
                  double margin_rad);

// Abduction joint and, outwards from it, the hip joint with the abduction angle at zero, in B [m].
Vector3 abduction_joint_B_m(const RobotModel& model, std::size_t leg);
Vector3 hip_joint_B_m(const RobotModel& model, std::size_t leg);

}  // namespace surefoot::robot
