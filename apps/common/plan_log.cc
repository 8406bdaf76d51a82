#include "apps/common/plan_log.h"

#include <algorithm>
#include <cmath>

namespace surefoot::apps {
namespace {

PlanPoint point_of(const Vector2& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1])};
}

std::uint8_t shade_of(std::uint16_t cost) {
  if (cost == navigation::kLethalCost) return 255;
  const double over_free =
      std::max(0.0, std::log2(static_cast<double>(cost) / navigation::kFreeCost));
  return static_cast<std::uint8_t>(std::min(254.0, 60.0 * over_free));
}

void take_map(const navigation::CostMap& map, PlanSample& sample) {
  sample.side = map.side();
  sample.cell_m = map.cell_m();
  const Vector2 half_cell(0.5 * map.cell_m(), 0.5 * map.cell_m());
  sample.corner_O_m = point_of(map.centre_of_O_m({0, 0}) - half_cell);
  const auto cells = static_cast<std::uint32_t>(map.side() * map.side());
  sample.cost.reserve(cells);
  for (std::uint32_t i = 0; i < cells; ++i) sample.cost.push_back(shade_of(map.cost(i)));
}

}  // namespace

void PlanLog::observe(TimeNs stamp, const autonomy::Autonomy& autonomy) {
  const navigation::Navigator& navigator = autonomy.navigator();
  if (navigator.status().counters.plans == plans_) return;
  plans_ = navigator.status().counters.plans;
  PlanSample sample;
  sample.stamp = stamp;
  sample.robot_O_m = point_of(autonomy.estimator().state().p_OB_m.head<2>());
  for (const navigation::PathPoint& point : navigator.path()) {
    sample.path_O_m.push_back(point_of(point.p_O_m));
  }
  for (const objects::Object& object : autonomy.objects().objects()) {
    if (object.kind != objects::ObjectClass::kObstacle) continue;
    for (const Vector2& p : object.points_O_m) {
      sample.objects.push_back({point_of(p), object.moving});
    }
  }
  take_map(navigator.planner().map(), sample);
  samples_.push_back(std::move(sample));
}

}  // namespace surefoot::apps
