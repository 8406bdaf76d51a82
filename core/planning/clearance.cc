#include "core/planning/clearance.h"

namespace surefoot::planning {
namespace {

double greater(double a, double b) { return a > b ? a : b; }

// How far a ball is below the ground under its middle; a side of a rock is felt too late, which the
// margin of the footstep's weights has to cover.
double depth_m(const PlanningGround& ground, const Vector3& p_O_m, double radius_m) {
  const mapping::MapWindow& window = ground.map->ground;
  const Result<double> height_m = window.height_at(p_O_m[0], p_O_m[1]);
  if (!height_m.ok()) return kClear_m;
  return height_m.value() + ground.offset_m - (p_O_m[2] - radius_m);
}

}  // namespace

double trunk_depth_m(const robot::RobotModel& model, const PlanningGround& ground,
                     const Matrix3& R_OB, const Vector3& p_OB_m) {
  double deepest_m = kClear_m;
  if (ground.map == nullptr) return deepest_m;
  const Vector3 corner_B =
      -0.5 * Vector3(model.trunk_size_m[0], model.trunk_size_m[1], model.trunk_size_m[2]);
  for (int i = 0; i < 9; ++i) {
    const int row = i / 3;
    const Vector3 p_B(corner_B[0] * (1 - i % 3), corner_B[1] * (1 - row), corner_B[2]);
    deepest_m = greater(deepest_m, depth_m(ground, R_OB * p_B + p_OB_m, 0.0));
  }
  return deepest_m;
}

double leg_depth_m(const robot::RobotModel& model, const PlanningGround& ground,
                   const Matrix3& R_OB, const Vector3& p_OB_m, std::size_t leg,
                   const robot::LegVector& q_rad) {
  if (ground.map == nullptr) return kClear_m;
  const auto at = [&](const Vector3& p_B, double radius_m) {
    return depth_m(ground, R_OB * p_B + p_OB_m, radius_m);
  };
  // Abduction joint, hip, knee, foot.
  const auto p_B = robot::leg_points_B(model, leg, q_rad).p_B_m;
  const double thigh_m =
      greater(at(p_B[2], model.thigh_radius_m), at(0.5 * (p_B[1] + p_B[2]), model.thigh_radius_m));
  return greater(thigh_m, at(0.5 * (p_B[2] + p_B[3]), model.shank_radius_m));
}

}  // namespace surefoot::planning
