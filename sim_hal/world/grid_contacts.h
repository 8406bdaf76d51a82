// Contacts of spheres with a grid of heights. ODE has a height field of its own, but it finds no
// contacts at edges of single cells, and its work buffers keep allocating: it re-sorts planes whose
// lists it grows one by one. This one touches faces, edges and corners alike and allocates nothing.
#pragma once

#include <cstddef>
#include <span>

#include "core/math/linear.h"
#include "sim_hal/world/terrain.h"

namespace surefoot::sim {

struct GridContact {
  Vector3 position_m = Vector3::Zero();  // on the surface
  Vector3 normal = Vector3::Zero();      // out of the ground
  double depth_m = 0;                    // of the sphere in the ground, > 0
};

// The point of the triangle a, b, c nearest to p.
Vector3 nearest_on_triangle(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c);

// Deepest contact first; others only where their normals differ from all kept ones by over 20
// degrees (a foot in a notch). Returns how many, at most out.size(). A centre under the surface is
// pushed out along the face above it, or through the grid's nearest side where that is nearer: its
// border is a wall down to height 0. Cost: about 40 ns per triangle under the sphere.
std::size_t sphere_on_grid(const HeightGrid& grid, const Vector3& centre_m, double radius_m,
                           std::span<GridContact> out);

}  // namespace surefoot::sim
