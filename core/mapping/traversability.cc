#include "core/mapping/traversability.h"

#include <algorithm>

#include "core/math/elementary.h"

namespace surefoot::mapping {

double step_height_m(const robot::RobotModel& model, double body_height_m,
                     double swing_clearance_m) {
  const double thigh = model.thigh_length_m;
  const double shank = model.shank_length_m;
  const double knee = model.actuators[robot::kJointsPerLeg - 1].max_rad;
  const double folded2 = thigh * thigh + shank * shank + 2.0 * thigh * shank * math::cos(knee);
  const double folded_m = math::sqrt(std::max(folded2, 0.0));
  const double standing_m = body_height_m - model.foot_radius_m;
  const double lift_m = standing_m - folded_m - swing_clearance_m;
  const double belly_m = body_height_m - 0.5 * model.trunk_size_m[2];
  return std::max(std::min(lift_m, 0.5 * belly_m), 0.0);
}

TraversabilityLimits traversability_limits(const MappingConfig& config,
                                           const robot::RobotModel& model, double body_height_m,
                                           double swing_clearance_m) {
  const double step_m = step_height_m(model, body_height_m, swing_clearance_m);
  return {.max_slope = config.foothold_max_slope,
          .max_raise_m = config.foothold_max_raise_m,
          .max_drop_m = config.foothold_max_drop_m,
          .max_unknown = config.foothold_max_unknown,
          .max_step_m = step_m,
          // A robot that cannot jump as high as it steps never jumps.
          .max_jump_m = std::max(config.max_jump_m, step_m)};
}

Status validate(const TraversabilityLimits& limits) {
  constexpr double kHighest_m = 100.0;
  const auto in_range = [](double value) { return value >= 0 && value <= kHighest_m; };
  const bool valid = in_range(limits.max_slope) && in_range(limits.max_raise_m) &&
                     in_range(limits.max_drop_m) && in_range(limits.max_step_m) &&
                     limits.max_jump_m >= limits.max_step_m && limits.max_jump_m <= kHighest_m;
  return valid ? Status::kOk : Status::kInvalid;
}

}  // namespace surefoot::mapping
