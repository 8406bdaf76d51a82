// Hilly, rough ground as a grid of heights.
#pragma once

#include <vector>

#include "core/base/random.h"
#include "sim_hal/world/solid.h"
#include "sim_hal/world/terrain.h"

namespace surefoot::sim {

struct LevelDisc {  // level around (x, y), blended into the rest beyond inner_m
  double x_m = 0;
  double y_m = 0;
  double inner_m = 0;
  double outer_m = 0;
};

struct ReliefConfig {
  PlanBounds area;
  double steepest_rad = 0;  // of the hills
  double roughness_rms_m = 0;
  LevelDisc start;  // z = 0 there
};

// Long waves, the steepest place of which is as steep as asked for, and value noise on rasters of
// 0.6 and 0.3 m with the root mean square asked for. Both fade to z = 0 at the area's border.
HeightGrid make_relief(const ReliefConfig& config, Random& random);

}  // namespace surefoot::sim
