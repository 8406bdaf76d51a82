// Places cannot be added, only moved by a vector.
// expect: no match for .operator\+.|invalid operands
#include "core/geometry/frames.h"

using namespace surefoot::geometry;

#ifdef MUST_FAIL
auto move(const Point<Body>& p, const Point<Body>& q) { return p + q; }
#else
auto move(const Point<Body>& p, const Vector<Body>& q) { return p + q; }
#endif
