#include "core/robot/kinematics.h"

#include "core/math/elementary.h"

namespace surefoot::robot {
namespace {

constexpr double kReachMargin_m = 1e-3;  // keeps the knee off its singularity

// Distance from the abduction axis to the leg's plane, signed outwards.
double lateral_offset_m(const RobotModel& model, std::size_t leg) {
  return left_sign(leg) * (model.hip_offset_m + model.knee_offset_m);
}

// Turns the leg's plane about the abduction axis (+x).
Vector3 rotate_x(const math::SinCos& angle, double x, double y, double z) {
  return {x, y * angle.cos - z * angle.sin, y * angle.sin + z * angle.cos};
}

}  // namespace

Vector3 abduction_joint_B_m(const RobotModel& model, std::size_t leg) {
  return {front_sign(leg) * model.abad_x_m, left_sign(leg) * model.abad_y_m, 0.0};
}

Vector3 hip_joint_B_m(const RobotModel& model, std::size_t leg) {
  return abduction_joint_B_m(model, leg) + Vector3(0.0, lateral_offset_m(model, leg), 0.0);
}

Vector3 foot_position_B_m(const RobotModel& model, std::size_t leg, const LegVector& q_rad) {
  return leg_points_B(model, leg, q_rad).p_B_m[3];
}

LegPoints leg_points_B(const RobotModel& model, std::size_t leg, const LegVector& q_rad) {
  const math::SinCos abad = math::sin_cos(q_rad[0]);
  const math::SinCos hip = math::sin_cos(q_rad[1]);
  const math::SinCos shank = math::sin_cos(q_rad[1] + q_rad[2]);
  const Vector3 origin = abduction_joint_B_m(model, leg);
  const double hip_y = left_sign(leg) * model.hip_offset_m;
  const double knee_y = lateral_offset_m(model, leg);
  const double knee_x = model.thigh_length_m * hip.sin;
  const double knee_z = -model.thigh_length_m * hip.cos;
  LegPoints points;
  points.p_B_m[0] = origin;
  points.p_B_m[1] = origin + rotate_x(abad, 0.0, hip_y, 0.0);
  points.p_B_m[2] = origin + rotate_x(abad, knee_x, knee_y, knee_z);
  points.p_B_m[3] = origin + rotate_x(abad, knee_x + model.shank_length_m * shank.sin, knee_y,
                                      knee_z - model.shank_length_m * shank.cos);
  return points;
}

Matrix3 foot_jacobian_B(const RobotModel& model, std::size_t leg, const LegVector& q_rad) {
  const math::SinCos abad = math::sin_cos(q_rad[0]);
  const math::SinCos hip = math::sin_cos(q_rad[1]);
  const math::SinCos shank = math::sin_cos(q_rad[1] + q_rad[2]);
  const double y = lateral_offset_m(model, leg);
  const double shank_x = model.shank_length_m * shank.cos;  // d x / d knee
  const double shank_z = model.shank_length_m * shank.sin;  // d z / d knee
  const double hip_x = model.thigh_length_m * hip.cos + shank_x;
  const double hip_z = model.thigh_length_m * hip.sin + shank_z;
  const double depth = -hip_x;  // z of the foot in the leg's plane
  Matrix3 jacobian;
  jacobian.col(0) = Vector3(0.0, -y * abad.sin - depth * abad.cos, y * abad.cos - depth * abad.sin);
  jacobian.col(1) = rotate_x(abad, hip_x, 0.0, hip_z);
  jacobian.col(2) = rotate_x(abad, shank_x, 0.0, shank_z);
  return jacobian;
}

Vector3 shank_angular_velocity_B(const LegVector& q_rad, const LegVector& qd_rad_s) {
  const math::SinCos abad = math::sin_cos(q_rad[0]);
  return rotate_x(abad, qd_rad_s[0], -(qd_rad_s[1] + qd_rad_s[2]), 0.0);
}

LegSolution solve_leg(const RobotModel& model, std::size_t leg, const Vector3& p_B_m) {
  Status status = Status::kOk;
  const Vector3 p = p_B_m - abduction_joint_B_m(model, leg);
  const double offset = lateral_offset_m(model, leg);

  // The foot's distance from the abduction axis fixes the depth of the leg's plane.
  double radial_sq = p[1] * p[1] + p[2] * p[2];
  if (radial_sq < offset * offset) {
    radial_sq = offset * offset;
    status = Status::kOutOfRange;
  }
  const double depth = math::sqrt(radial_sq - offset * offset);  // below the hip
  const double abad = math::atan2(p[2], p[1]) - math::atan2(-depth, offset);

  const double thigh = model.thigh_length_m;
  const double shank = model.shank_length_m;
  const double max_reach = thigh + shank - kReachMargin_m;
  const double min_reach = math::magnitude(thigh - shank) + kReachMargin_m;
  const double distance = math::sqrt(p[0] * p[0] + depth * depth);
  const double reach = math::clamp(distance, min_reach, max_reach);
  if (reach != distance) status = Status::kOutOfRange;

  const double cos_knee = (reach * reach - thigh * thigh - shank * shank) / (2.0 * thigh * shank);
  const double knee = model.bend_sign(leg) * math::acos(cos_knee);
  const math::SinCos bend = math::sin_cos(knee);
  const double hip =
      math::atan2(p[0], depth) - math::atan2(shank * bend.sin, thigh + shank * bend.cos);
  return {{math::wrap_angle(abad), hip, knee}, status};
}

bool can_reach(const RobotModel& model, std::size_t leg, const Vector3& p_B_m, double margin_m) {
  const Vector3 p = p_B_m - abduction_joint_B_m(model, leg);
  const double offset_m2 = math::square(lateral_offset_m(model, leg));
  if (p[1] * p[1] + p[2] * p[2] < offset_m2) return false;
  const double inset_m = kReachMargin_m + margin_m;
  const double longest_m = model.thigh_length_m + model.shank_length_m - inset_m;
  const double shortest_m = math::magnitude(model.thigh_length_m - model.shank_length_m) + inset_m;
  const double reach_m2 = p.squaredNorm() - offset_m2;
  return longest_m > 0 && reach_m2 >= shortest_m * shortest_m && reach_m2 <= longest_m * longest_m;
}

bool within_stops(const RobotModel& model, std::size_t leg, const LegVector& q_rad,
                  double margin_rad) {
  for (std::size_t i = 0; i < kJointsPerLeg; ++i) {
    const JointRange range = model.joint_range(joint_index(leg, i));
    const double q = q_rad[static_cast<Eigen::Index>(i)];
    if (q < range.min_rad + margin_rad || q > range.max_rad - margin_rad) return false;
  }
  return true;
}

}  // namespace surefoot::robot
