#include "core/planning/step_pose.h"

#include <array>

#include "core/geometry/rotations.h"
#include "core/math/elementary.h"
#include "core/robot/kinematics.h"

namespace surefoot::planning {
namespace {

constexpr double kHeightStep_m = 0.006;
constexpr int kMaxHeightSteps = 33;
constexpr double kRounding_m = 1e-9;  // three steps of height are 18 mm

// All of one step, in one pose after the other.
class PoseTrial {
 public:
  PoseTrial(const robot::RobotModel& model, const StepLimits& limits, const PlanningGround& ground,
            const Step& step)
      : model_(model), limits_(limits), ground_(ground), step_(step) {}

  // Keeps the angles of the legs that will stand.
  bool reaches(const Matrix3& R_OB, const Vector3& p_OB_m) {
    const Matrix3 R_BO = R_OB.transpose();
    const std::size_t moving = step_leg(step_.turn);
    const Vector3 lift_B = R_BO * (step_.feet_O_m[moving] - p_OB_m);
    std::array<Vector3, robot::kLegs> landed_B;
    // First what is cheap.
    if (!robot::can_reach(model_, moving, lift_B, limits_.reach_margin_m)) return false;
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      landed_B[leg] = R_BO * (step_.landed_O_m[leg] - p_OB_m);
      if (!robot::can_reach(model_, leg, landed_B[leg], limits_.reach_margin_m)) return false;
    }
    if (!stops_allow(moving, robot::solve_leg(model_, moving, lift_B).q_rad)) return false;
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      q_rad_[leg] = robot::solve_leg(model_, leg, landed_B[leg]).q_rad;
      if (!stops_allow(leg, q_rad_[leg])) return false;
    }
    return true;
  }

  // In the pose that reaches() has looked at: `deepest_m` or, where a leg is deeper, that; given up
  // where it is no less than `best_m`.
  double with_legs_m(const Matrix3& R_OB, const Vector3& p_OB_m, double deepest_m,
                     double best_m) const {
    for (std::size_t leg = 0; leg < robot::kLegs && deepest_m < best_m; ++leg) {
      const double depth_m = leg_depth_m(model_, ground_, R_OB, p_OB_m, leg, q_rad_[leg]);
      if (depth_m > deepest_m) deepest_m = depth_m;
    }
    return deepest_m;
  }

 private:
  bool stops_allow(std::size_t leg, const robot::LegVector& q_rad) const {
    return robot::within_stops(model_, leg, q_rad, limits_.stop_margin_rad);
  }

  const robot::RobotModel& model_;
  const StepLimits& limits_;
  const PlanningGround& ground_;
  const Step& step_;
  std::array<robot::LegVector, robot::kLegs> q_rad_;
};

// 0, 1 lower, 1 higher, 2 lower, ... steps of height.
int height_step(int i) { return i % 2 == 0 ? i / 2 : -(i + 1) / 2; }

}  // namespace

StepPose step_pose(const robot::RobotModel& model, const StanceShape& shape,
                   const StepLimits& limits, const PlanningGround& ground, const Step& step) {
  PoseTrial trial(model, limits, ground, step);
  StepPose best;
  best.deepest_m = -kClear_m;
  int poses = 0;
  StanceShape inclined = shape;
  for (const double slope_share : {shape.slope_share, 1.0}) {
    inclined.slope_share = slope_share;
    StepPose tried;
    tried.pose = trunk_over(model, inclined, step.landed_O_m, step.yaw_rad);
    const CentrePlace centre = place_centre(step.feet_O_m, step.landed_O_m, step.turn,
                                            shape.margin_m, tried.pose.centre_O_m);
    tried.pose.centre_O_m = centre.place_O_m;
    tried.narrow = centre.narrow;
    const Vector3& rpy = tried.pose.roll_pitch_yaw_rad;
    const Matrix3 R_OB = geometry::from_roll_pitch_yaw(rpy[0], rpy[1], rpy[2]);
    const Vector2 origin = centre.place_O_m - step.centre_offset_O_m;
    Vector3 p_OB_m(origin[0], origin[1], tried.pose.height_O_m);
    const double usual_m = tried.pose.height_O_m;
    const double trunk_m = trunk_depth_m(model, ground, R_OB, p_OB_m);
    for (int i = 0; i <= 2 * kMaxHeightSteps; ++i) {
      const double off_m = height_step(i) * kHeightStep_m;
      if (off_m > limits.max_raising_m + kRounding_m) continue;
      if (-off_m > limits.max_lowering_m + kRounding_m) continue;
      const double least_m = trunk_m - off_m > 0 ? trunk_m - off_m : 0.0;
      if (least_m >= best.deepest_m) continue;  // whatever the legs do
      ++poses;
      tried.pose.height_O_m = usual_m + off_m;
      tried.lowered = off_m < 0;
      p_OB_m[2] = tried.pose.height_O_m;
      tried.reaches = trial.reaches(R_OB, p_OB_m);
      tried.deepest_m =
          tried.reaches ? trial.with_legs_m(R_OB, p_OB_m, least_m, best.deepest_m) : -kClear_m;
      if (tried.reaches ? tried.deepest_m < best.deepest_m : !best.reaches) best = tried;
      best.tried = poses;
      if (!(best.deepest_m > 0)) return best;
    }
  }
  best.tried = poses;
  if (!best.reaches) best.deepest_m = 0;
  return best;
}

}  // namespace surefoot::planning
