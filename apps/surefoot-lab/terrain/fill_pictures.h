// Pictures of a completed terrain, after the paper's figures 4 and 7.
#pragma once

#include "apps/common/drawing.h"
#include "apps/surefoot-lab/terrain/fill_methods.h"

namespace surefoot::apps {

struct FillPictures {
  Drawing terrain{1, 1};  // shaded ground, heights, what the sensor saw
  Drawing fills{1, 1};    // truth, ceilings, fills, spread, costs; unseen areas outlined
};

FillPictures draw_fills(FillWorker& worker, const ScannedTerrain& scene);

}  // namespace surefoot::apps
