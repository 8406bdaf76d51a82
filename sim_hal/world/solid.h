// What stands or lies on the ground and is no ground: trunks, boulders, logs, walls and people. A
// robot must not touch them. World frame W, metres.
#pragma once

#include "core/math/linear.h"
#include "sim_hal/sensors/capsule.h"
#include "sim_hal/world/cell_raster.h"
#include "sim_hal/world/solid_kind.h"
#include "sim_hal/world/terrain_box.h"

namespace surefoot::sim {

// A wall is a box, everything else a capsule: trunks and people upright, reaching into the ground;
// boulders a ball, partly sunk; logs lying.
struct Solid {
  SolidKind kind = SolidKind::kTrunk;
  Capsule capsule;
  TerrainBox box;  // kWall

  bool is_box() const { return kind == SolidKind::kWall; }
  double top_m() const;
};

// Thinner than 3 cm: bends aside. Scanners get an echo now and then; nothing else meets it.
struct Sapling {
  double x_m = 0;
  double y_m = 0;
  double radius_m = 0;
  double bottom_m = 0;
  double top_m = 0;
};

PlanBounds plan_bounds(const Solid& solid);

// Highest point above (x, y); -infinity beside it.
double top_at(const Solid& solid, double x_m, double y_m);

// Smallest t > 0 at which origin + t * direction is on its surface, from outside; kNoHit when none.
double cast_solid(const Solid& solid, const Vector3& origin, const Vector3& direction);

// Distance in plan between the segment a-b and the solid's outline; negative: the segment is this
// far inside. `away`: unit vector by which the segment would have to move off.
double plan_distance_m(const Solid& solid, const Vector2& a_m, const Vector2& b_m, Vector2& away);

}  // namespace surefoot::sim
