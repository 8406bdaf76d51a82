// expect: no match for .operator\*.|invalid operands
#include "core/geometry/frames.h"

using namespace surefoot::geometry;

#ifdef MUST_FAIL
auto turn(const Rotation<Odometry, Body>& R_OB, const Vector<Odometry>& v) { return R_OB * v; }
#else
auto turn(const Rotation<Odometry, Body>& R_OB, const Vector<Body>& v) { return R_OB * v; }
#endif
