// Learns core/terrain's height prior from library terrain: scanned with the experiment's sensor,
// its unseen cells show how far the ground lies below its ceiling in which surroundings.
#pragma once

#include <vector>

#include "core/terrain/height_prior.h"
#include "core/terrain/terrain_grid.h"

namespace surefoot::apps {

// What the sensor saw, and the truth. Cells of the truth that are merely bounded hold heights that
// were invented to bridge gaps of a recording: they shape costs and are never scored.
struct ScannedTerrain {
  terrain::TerrainGrid seen;
  terrain::TerrainGrid truth;
  // false: nothing is known in gaps, neither to the fills nor where true costs are computed; the
  // library's patches are bridged all the same, they must be whole.
  bool bridged = true;
};

struct PriorOptions {
  std::int32_t radius = 6;
  std::int32_t stride = 1;
  double ridge = 1e-3;         // times the number of samples, but of no fewer than:
  double least_samples = 5e4;  // a small library must not be trusted to the last weight
};

// Ridge regression over all bounded cells, mirrored across the view too. No cells: no prior.
terrain::HeightPrior train_prior(const std::vector<const ScannedTerrain*>& library,
                                 const PriorOptions& options);

}  // namespace surefoot::apps
