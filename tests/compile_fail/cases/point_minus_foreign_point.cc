// expect: no match for .operator-.|invalid operands
#include "core/geometry/frames.h"

using namespace surefoot::geometry;

#ifdef MUST_FAIL
auto offset(const Point<Odometry>& p, const Point<DepthCamera>& q) { return p - q; }
#else
auto offset(const Point<Odometry>& p, const Point<Odometry>& q) { return p - q; }
#endif
