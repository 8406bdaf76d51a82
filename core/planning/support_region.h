// Where the centre of mass may be, seen from above: inside the triangles of the feet that stand,
// each drawn in by a margin. Static stability after McGhee and Frank, 1968.
//
// O's axes, metres. At most two triangles: of a step and of the one after it.
// Cost of nearest(): 6 projections and 15 corners, each checked against 6 lines. No allocation.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/fixed_vector.h"
#include "core/base/status.h"
#include "core/math/linear.h"

namespace surefoot::planning {

struct Triangle {
  std::array<Vector2, 3> corners_O_m{Vector2::Zero(), Vector2::Zero(), Vector2::Zero()};

  // Of the largest circle inside; 0: the corners lie in a line.
  double inradius_m() const;
  // Similar, about the centre of that circle: less kept_margin_m() along each edge. Corners in a
  // line: itself.
  Triangle drawn_in(double margin_m) const;
};

// The margin, or where the triangle has no room for it most of its inradius: what is left is a
// small triangle, not a point.
double kept_margin_m(double inradius_m, double margin_m);

// Between the nearest points of both; 0 where they overlap. Cost: at most 6 tests for a separating
// edge and 18 distances from a corner to an edge.
double distance_m(const Triangle& a, const Triangle& b);

class SupportRegion {
 public:
  static constexpr std::size_t kMaxTriangles = 2;

  // Its inside less `margin_m` along each edge. kExhausted: there are two already. kInvalid: the
  // corners lie in a line.
  Status add(const Triangle& triangle, double margin_m);

  bool contains(const Vector2& point_O_m) const;
  // The point of the region that is nearest to `wanted`. kNotFound: the region is empty.
  Result<Vector2> nearest(const Vector2& wanted_O_m) const;

 private:
  struct Line {
    Vector2 inward = Vector2::Zero();  // unit normal
    double offset_m = 0;               // inside: inward . p >= offset
  };

  FixedVector<Line, 3 * kMaxTriangles> lines_;
};

}  // namespace surefoot::planning
