// expect: no match for .operator\+.|invalid operands
#include "core/geometry/frames.h"

using namespace surefoot::geometry;

#ifdef MUST_FAIL
Vector<Odometry> sum(const Vector<Odometry>& a, const Vector<Body>& b) { return a + b; }
#else
Vector<Odometry> sum(const Vector<Odometry>& a, const Vector<Odometry>& b) { return a + b; }
#endif
