// Whether a disc gets from one place to another between solids: a flood over a raster of 0.1 m, on
// the ground truth.
#pragma once

#include <vector>

#include "core/math/linear.h"
#include "sim_hal/world/solid.h"

namespace surefoot::sim {

// Inside the area only.
bool passage_exists(const std::vector<Solid>& solids, const PlanBounds& area, const Vector2& from_m,
                    const Vector2& to_m, double width_m);

}  // namespace surefoot::sim
