// How far some points reach, and their mean. O, m.
#pragma once

#include "core/math/linear.h"
#include "core/objects/object.h"

namespace surefoot::objects {

struct Outline {
  Vector2 low_O_m = Vector2::Zero();
  Vector2 high_O_m = Vector2::Zero();
  Vector2 mean_O_m = Vector2::Zero();
};

// Of one point at least.
inline Outline outline_of(const FixedVector<Vector2, kMaxObjectPoints>& points_O_m) {
  Outline outline{*points_O_m.begin(), *points_O_m.begin(), Vector2::Zero()};
  for (const Vector2& p : points_O_m) {
    outline.mean_O_m += p;
    outline.low_O_m = outline.low_O_m.cwiseMin(p);
    outline.high_O_m = outline.high_O_m.cwiseMax(p);
  }
  outline.mean_O_m /= static_cast<double>(points_O_m.size());
  return outline;
}

}  // namespace surefoot::objects
