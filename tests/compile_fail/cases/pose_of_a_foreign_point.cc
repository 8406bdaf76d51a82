// expect: no match for .operator\*.|invalid operands
#include "core/geometry/frames.h"

using namespace surefoot::geometry;

#ifdef MUST_FAIL
auto apply(const Pose<Odometry, Body>& X_OB, const Point<DepthCamera>& p) { return X_OB * p; }
#else
auto apply(const Pose<Odometry, Body>& X_OB, const Point<Body>& p) { return X_OB * p; }
#endif
