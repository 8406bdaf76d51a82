// expect: could not convert|no viable conversion
#include "core/geometry/frames.h"

using namespace surefoot::geometry;

Pose<Body, Odometry> invert(const Pose<Odometry, Body>& X_OB) {
#ifdef MUST_FAIL
  return X_OB;
#else
  return X_OB.inverse();
#endif
}
