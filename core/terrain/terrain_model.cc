#include "core/terrain/terrain_model.h"

#include <algorithm>

namespace surefoot::terrain {

Status make_library(const TerrainModel& model, std::int32_t patch_cells, ModelHeights& scratch,
                    PatchLibrary& out) {
  const Status status = out.reset(model.cell_m, patch_cells);
  if (!ok(status)) return status;
  std::size_t count = 0;
  for (const ModelRow& row : model.rows) {
    for (const double height_m : row.heights_m) scratch[count++] = static_cast<float>(height_m);
  }
  Provenance provenance;
  constexpr char kSource[] = "terrain model";
  std::copy_n(kSource, sizeof kSource, provenance.source.begin());
  provenance.seed = model.seed;
  return out.add(provenance, static_cast<std::int32_t>(kModelColumns),
                 static_cast<std::int32_t>(model.rows.size()), model.cell_m, scratch);
}

HeightPrior make_prior(const TerrainModel& model) {
  HeightPrior prior;
  prior.radius = kModelPriorRadius;
  prior.stride = 1;
  prior.cell_m = model.cell_m;
  prior.residual_m = model.prior_residual_m;
  for (std::size_t k = 0; k < kModelPriorPoints; ++k) {
    prior.weights[k] = static_cast<float>(model.prior_heights[k]);
    prior.weights[kModelPriorPoints + k] = static_cast<float>(model.prior_measured[k]);
  }
  prior.weights[2 * kModelPriorPoints] = static_cast<float>(model.prior_constant);
  return prior;
}

}  // namespace surefoot::terrain
