// The simple ways to give unseen cells a height that Fill-Terrain is compared with. Each fills the
// bounded cells; measured cells stay, unknown ones stay unknown.
#pragma once

#include <vector>

#include "core/terrain/terrain_grid.h"

namespace surefoot::apps {

// One height per cell of the grid; meaningless where nothing is known.
using Heights = std::vector<float>;

Heights fill_with_ceilings(const terrain::TerrainGrid& grid);
Heights fill_with_constant(const terrain::TerrainGrid& grid, float height_m);
// OpenCV's Navier-Stokes inpainting on 8 bits, 3 cells around, then cut at the ceilings.
Heights fill_by_inpainting(const terrain::TerrainGrid& grid);
// The lowest known of the eight neighbours, ring by ring, then cut at the ceilings.
Heights fill_with_minimum(const terrain::TerrainGrid& grid);
// The same, then ten sweeps towards the mean of the four neighbours, under the ceilings.
Heights fill_with_smoothed_minimum(const terrain::TerrainGrid& grid);

}  // namespace surefoot::apps
