#include "core/planning/clearance.h"

namespace surefoot::planning {
namespace {

double greater(double a, double b) { return a > b ? a : b; }

// How far a point is below the ground under it.
double depth_m(const PlanningGround& ground, const Vector3& p_O_m) {
  const Result<double> height_m = ground.map->ground.height_at(p_O_m[0], p_O_m[1]);
  if (!height_m.ok()) return kClear_m;
  return height_m.value() + ground.offset_m - p_O_m[2];
}

// How far the underside of a ball is below the highest ground around.
double ball_depth_m(const PlanningGround& ground, const Vector3& p_O_m, double radius_m) {
  const mapping::MapWindow& window = ground.map->ground;
  const Result<mapping::CellIndex> at = window.locate(p_O_m[0], p_O_m[1]);
  if (!at.ok()) return kClear_m;
  const float crest_m = ground.map->crest_m[window.place(at.value())];
  if (crest_m == terrain::TerrainMap::kNoCrest_m) return kClear_m;
  return static_cast<double>(crest_m) + ground.offset_m - (p_O_m[2] - radius_m - kLegMargin_m);
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
    deepest_m = greater(deepest_m, depth_m(ground, R_OB * p_B + p_OB_m));
  }
  return deepest_m;
}

double leg_depth_m(const robot::RobotModel& model, const PlanningGround& ground,
                   const Matrix3& R_OB, const Vector3& p_OB_m, std::size_t leg,
                   const robot::LegVector& q_rad) {
  if (ground.map == nullptr) return kClear_m;
  // Abduction joint, hip, knee, foot.
  const auto p_B = robot::leg_points_B(model, leg, q_rad).p_B_m;
  const auto thigh_m = [&](double share) {
    const Vector3 p = p_B[1] + share * (p_B[2] - p_B[1]);
    return ball_depth_m(ground, R_OB * p + p_OB_m, model.thigh_radius_m);
  };
  const auto shank_m = [&](double share) {
    const Vector3 p = p_B[2] + share * (p_B[3] - p_B[2]);
    return ball_depth_m(ground, R_OB * p + p_OB_m, model.shank_radius_m);
  };
  return greater(greater(thigh_m(0.5), thigh_m(1.0)), greater(shank_m(0.3), shank_m(0.6)));
}

}  // namespace surefoot::planning
