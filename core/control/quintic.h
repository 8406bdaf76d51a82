// A blend from 0 to 1 that begins and ends at rest: no speed, no acceleration at its ends.
#pragma once

#include "core/math/elementary.h"

namespace surefoot::control {

struct Quintic {
  double value;
  double slope;      // per unit of progress
  double curvature;  // per unit of progress squared
};

// 0 up to progress = begin, 1 from progress = end on.
inline Quintic quintic(double progress, double begin = 0.0, double end = 1.0) {
  const double width = end - begin;
  const double s = math::clamp((progress - begin) / width, 0.0, 1.0);
  const double value = s * s * s * (10.0 + s * (6.0 * s - 15.0));
  const double slope = 30.0 * s * s * (1.0 - s) * (1.0 - s) / width;
  const double curvature = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (width * width);
  return {value, slope, curvature};
}

}  // namespace surefoot::control
