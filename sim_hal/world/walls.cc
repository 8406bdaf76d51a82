// Obstacles that are to be gone around: a wall, a dead end. contract.md "The worlds".
#include <cmath>

#include "sim_hal/world/terrain.h"

namespace surefoot::sim {

namespace {

constexpr double kThickness_m = 0.4;

// From one end of its middle line to the other; walls that meet overlap at the corner.
void add_wall(const Vector2& from_m, const Vector2& to_m, double height_m, Terrain& terrain) {
  const Vector2 along = to_m - from_m;
  const double length_m = along.norm();
  Solid wall;
  wall.kind = SolidKind::kWall;
  TerrainBox& box = wall.box;
  box.x_m = 0.5 * (from_m.x() + to_m.x());
  box.y_m = 0.5 * (from_m.y() + to_m.y());
  box.half_length_m = 0.5 * (length_m + kThickness_m);
  box.half_width_m = 0.5 * kThickness_m;
  box.bottom_m = -0.1;
  box.top_m = height_m;
  box.cos_yaw = along.x() / length_m;
  box.sin_yaw = along.y() / length_m;
  terrain.solids.push_back(wall);
}

}  // namespace

// Across the way, 5 to 7 m ahead, 25 to 60 m wide as it is seen from the start. One end is open. At
// the other it turns back towards the start's side and goes on for 20 m.
void make_wall(bool enclosed, Random& random, Terrain& terrain) {
  const double height_m = random.uniform(1.2, 2.0);
  const double x = random.uniform(5.0, 7.0);
  if (enclosed) {
    const double behind = -random.uniform(3.0, 5.0);
    const double left = random.uniform(3.0, 5.0);
    const double right = -random.uniform(3.0, 5.0);
    add_wall({x, right}, {x, left}, height_m, terrain);
    add_wall({behind, right}, {behind, left}, height_m, terrain);
    add_wall({behind, left}, {x, left}, height_m, terrain);
    add_wall({behind, right}, {x, right}, height_m, terrain);
    return;
  }
  const double width_m = random.uniform(25.0, 60.0);
  const double open_part = random.uniform(0.3, 0.7);  // of it, on the open end's side of the way
  const double side = random.below(2) == 0 ? -1.0 : 1.0;
  const double open_y = side * open_part * width_m;
  const double closed_y = open_y - side * width_m;
  add_wall({x, open_y - side * 0.5 * kThickness_m}, {x, closed_y + side * 0.5 * kThickness_m},
           height_m, terrain);
  const double corner_y = closed_y + side * 0.5 * kThickness_m;
  add_wall({x - 20.0, corner_y}, {x, corner_y}, height_m, terrain);
}

// Widths and depths are those of the room inside.
void make_culdesac(Random& random, Terrain& terrain) {
  const double height_m = random.uniform(1.2, 2.0);
  const double half_m = 0.5 * random.uniform(4.0, 10.0) + 0.5 * kThickness_m;
  const double depth_m = random.uniform(5.0, 15.0);
  const double mouth = random.uniform(2.0, 3.0);
  const double aside = random.uniform(-0.5, 0.5);
  const double bottom = mouth + depth_m + 0.5 * kThickness_m;
  const double begin = mouth + 0.5 * kThickness_m;
  add_wall({bottom, aside - half_m}, {bottom, aside + half_m}, height_m, terrain);
  add_wall({begin, aside + half_m}, {bottom, aside + half_m}, height_m, terrain);
  add_wall({begin, aside - half_m}, {bottom, aside - half_m}, height_m, terrain);
}

}  // namespace surefoot::sim
