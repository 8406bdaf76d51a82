#include "core/control/swing.h"

#include <algorithm>

#include "core/control/quintic.h"
#include "core/math/elementary.h"

namespace surefoot::control {

double apex_O_m(const SwingPath& path, const mapping::MapWindow* window,
                const robot::RobotModel& model, double clearance_m, double map_offset_m) {
  double highest_m = std::max(path.lift_off_O_m[2], path.landing_O_m[2]);
  if (window == nullptr) return highest_m + clearance_m;
  const Result<double> ground =
      window->max_height_along(path.lift_off_O_m[0], path.lift_off_O_m[1], path.landing_O_m[0],
                               path.landing_O_m[1], 2.0 * model.foot_radius_m);
  if (ground.ok()) {
    highest_m = std::max(highest_m, ground.value() + map_offset_m + model.foot_radius_m);
  }
  return highest_m + clearance_m;
}

SwingPoint evaluate(const SwingPath& path, double progress, double duration_s) {
  const double s = math::clamp(progress, 0.0, 1.0);
  const Quintic over = quintic(s, 0.15, 0.9);
  const Quintic rise = quintic(s, 0.0, 0.4);
  const Quintic fall = quintic(s, 0.5, 1.0);
  const Vector3 way = path.landing_O_m - path.lift_off_O_m;
  const double rise_m = path.apex_O_m - path.lift_off_O_m[2];
  const double fall_m = path.landing_O_m[2] - path.apex_O_m;
  SwingPoint point;
  point.position_O_m = path.lift_off_O_m + way * over.value;
  point.velocity_O_m_s = way * (over.slope / duration_s);
  point.acceleration_O_m_s2 = way * (over.curvature / math::square(duration_s));
  point.position_O_m[2] = path.lift_off_O_m[2] + rise_m * rise.value + fall_m * fall.value;
  point.velocity_O_m_s[2] = (rise_m * rise.slope + fall_m * fall.slope) / duration_s;
  point.acceleration_O_m_s2[2] =
      (rise_m * rise.curvature + fall_m * fall.curvature) / math::square(duration_s);
  return point;
}

}  // namespace surefoot::control
