// expect: no match for .operator\*.|invalid operands
#include "core/geometry/frames.h"

using namespace surefoot::geometry;

#ifdef MUST_FAIL
auto chain(const Pose<Odometry, Body>& X_OB, const Pose<Body, Imu>& X_BI) { return X_BI * X_OB; }
#else
auto chain(const Pose<Odometry, Body>& X_OB, const Pose<Body, Imu>& X_BI) { return X_OB * X_BI; }
#endif
