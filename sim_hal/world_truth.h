// What the simulator tells of its world, for summaries and pictures.
#pragma once

#include <vector>

#include "sim_hal/simulator.h"
#include "sim_hal/world/terrain.h"
#include "sim_hal/world/terrain_index.h"

namespace surefoot::sim {

TerrainFigures figures_of(const Terrain& terrain, const TerrainIndex& index, double goal_x_m);
std::vector<SolidTruth> outlines_of(const std::vector<Solid>& solids);

}  // namespace surefoot::sim
