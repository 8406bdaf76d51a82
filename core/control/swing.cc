#include "core/control/swing.h"

#include "core/math/elementary.h"

namespace surefoot::control {
namespace {

struct Blend {
  double value;
  double slope;      // per unit of progress
  double curvature;  // per unit of progress squared
};

// Quintic from 0 at `begin` to 1 at `end`.
Blend quintic(double progress, double begin, double end) {
  const double width = end - begin;
  const double s = math::clamp((progress - begin) / width, 0.0, 1.0);
  const double value = s * s * s * (10.0 + s * (6.0 * s - 15.0));
  const double slope = 30.0 * s * s * (1.0 - s) * (1.0 - s) / width;
  const double curvature = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (width * width);
  return {value, slope, curvature};
}

}  // namespace

SwingPoint evaluate(const SwingPath& path, double progress, double duration_s) {
  const double s = math::clamp(progress, 0.0, 1.0);
  const Blend over = quintic(s, 0.15, 0.9);
  const Blend rise = quintic(s, 0.0, 0.4);
  const Blend fall = quintic(s, 0.5, 1.0);
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
