#include "core/control/foothold.h"

#include "core/mapping/foothold.h"
#include "core/math/elementary.h"
#include "core/planning/stance.h"

namespace surefoot::control {
namespace {

// Whether the map knows enough around the place to say what it is.
bool classed(const mapping::MapWindow& window, const Vector3& place_O_m) {
  const Result<mapping::CellIndex> index = window.locate(place_O_m[0], place_O_m[1]);
  return index.ok() && window.at(index.value()).traversability != mapping::Traversability::kUnknown;
}

}  // namespace

Vector3 stance_hip_B_m(const robot::RobotModel& model, const FootholdConfig& config,
                       std::size_t leg) {
  return planning::stance_hip_B_m(model, config.lateral_offset_m, leg);
}

void FootholdPlanner::reset(const FootholdConfig& config, const robot::RobotModel& model) {
  config_ = config;
  model_ = model;
}

Vector3 FootholdPlanner::nominal_O_m(std::size_t leg, const estimation::RobotState& state,
                                     const VelocityCommand& command, double until_touchdown_s,
                                     double stance_s, double ground_z_m) const {
  const double yaw_at_touchdown = state.yaw_rad + command.yaw_rate_rad_s * until_touchdown_s;
  const math::SinCos yaw = math::sin_cos(yaw_at_touchdown);
  const Vector2 wanted(yaw.cos * command.forward_m_s - yaw.sin * command.left_m_s,
                       yaw.sin * command.forward_m_s + yaw.cos * command.left_m_s);
  const Vector2 velocity = state.v_OB_m_s.head<2>();
  const double limit = config_.max_offset_m;
  Vector2 symmetry =
      velocity * (0.5 * stance_s) + (velocity - wanted) * config_.velocity_feedback_s;
  symmetry[0] = math::clamp(symmetry[0], -limit, limit);
  symmetry[1] = math::clamp(symmetry[1], -limit, limit);

  const Vector3 hip_B = stance_hip_B_m(model_, config_, leg);
  const Vector2 shoulder(yaw.cos * hip_B[0] - yaw.sin * hip_B[1],
                         yaw.sin * hip_B[0] + yaw.cos * hip_B[1]);
  const Vector2 point = state.p_OB_m.head<2>() + velocity * until_touchdown_s + shoulder + symmetry;
  return {point[0], point[1], ground_z_m + model_.foot_radius_m};
}

Foothold FootholdPlanner::choose(const Vector3& nominal_O_m, const mapping::MapWindow* window,
                                 GroundRule ground, double map_offset_m) const {
  Foothold foothold;
  foothold.nominal_O_m = nominal_O_m;
  foothold.position_O_m = nominal_O_m;
  if (window == nullptr) {
    foothold.reason = FootholdReason::kMapOff;
    return foothold;
  }
  // Ground that may be trusted unseen is no worse than what was seen beside it. A foot that is
  // drawn in to the edge of the seen ground makes the stance too narrow for a shove.
  if (ground != GroundRule::kGood && !classed(*window, nominal_O_m)) {
    foothold.reason = FootholdReason::kUnseen;
    return foothold;
  }
  mapping::FootholdQuery query;
  query.x_O_m = nominal_O_m[0];
  query.y_O_m = nominal_O_m[1];
  query.max_radius_m = config_.search_radius_m;
  query.margin_weight_m = config_.margin_weight_m;
  const Result<mapping::Foothold> found = mapping::find_foothold(*window, query);
  if (!found.ok()) {
    const bool forced = ground == GroundRule::kAny;
    foothold.reason = forced ? FootholdReason::kForced : FootholdReason::kNone;
    return foothold;
  }
  const mapping::Foothold& place = found.value();
  foothold.position_O_m = {place.x_O_m, place.y_O_m, place.z_O_m + model_.foot_radius_m};
  foothold.position_O_m[2] += map_offset_m;
  foothold.reason = place.moved ? FootholdReason::kMoved : FootholdReason::kNominal;
  return foothold;
}

}  // namespace surefoot::control
