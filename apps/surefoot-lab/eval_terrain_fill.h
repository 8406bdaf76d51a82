// `surefoot-lab eval terrain-fill`: Table I of the terrain paper on rock fields.
#pragma once

#include <cstdint>
#include <filesystem>

#include "sim_hal/world/rock_field.h"

namespace surefoot::apps {

struct TerrainFillOptions {
  std::uint64_t first_library_seed = 1;
  std::uint64_t last_library_seed = 10;
  std::uint64_t first_test_seed = 11;
  std::uint64_t last_test_seed = 20;
  double resolution_m = 0.01;
  double noise_m = 0;
  int jobs = 2;
  int bodies = 200;  // of a rock field
  std::filesystem::path cache = sim::rock_cache_folder();
  // A recorded grid instead of rock fields: one half is the library for the other, and the other
  // way round; each is walked over in both directions.
  std::filesystem::path terrain;
  double scale = 0.25;        // of that grid
  bool bridge_gaps = true;    // false: they stay unknown, as the scanner left them
  std::filesystem::path out;  // default: out/eval-terrain-fill
};

// Writes terrain-fill.json, terrain.png (figure 4) and fills.png (figure 7). 0 done, 2 options or
// a terrain file that cannot be used, 3 the results cannot be written.
int eval_terrain_fill(const TerrainFillOptions& options);

}  // namespace surefoot::apps
