// Which settings the improved fill takes for a library, found out on the library itself.
#pragma once

#include <vector>

#include "apps/surefoot-lab/terrain/fill_methods.h"

namespace surefoot::apps {

struct ImprovedChoice {
  terrain::FillConfig settings;
  // Errors with the prior to those without, log of their geometric mean over the three errors of
  // Table I and all that was filled, and its standard error; 0 where nothing could be compared.
  double log_ratio = 0;
  double error = 0;
};

// Small patches that the learned prior guides, or the paper's patches in several draws without a
// prior: where the library is small, or its rocks are unlike each other, the prior has learned
// too little, and what it says of other ground is worse than the texture.
// Of ten pieces and more, every two are filled with what the others teach. Of fewer, one side of
// the sensor's path is filled with what the other side teaches, and the other way round; sides
// change places from piece to piece, so that ground that was also walked over backwards, as the
// next piece, does not teach about itself. The prior is taken where it is better by more than the
// standard error; otherwise the simpler settings are.
// A library without unseen cells in a group cannot decide: no prior. Throws as make_material().
ImprovedChoice choose_improved(const std::vector<const ScannedTerrain*>& library, int cell_mm);

}  // namespace surefoot::apps
