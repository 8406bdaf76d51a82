// Workloads of core/terrain: rough ground with shadows, completed in slices, and its cost; and of
// the terrain task, which does this to windows of the map.
#include <bit>
#include <memory>

#include "core/terrain/cost.h"
#include "core/terrain/fill.h"
#include "tests/rules/core_hash/workloads.h"
#include "tests/support/terrain_task_parts.h"

namespace surefoot::tests {
namespace {

terrain::CostConfig some_cost() {
  terrain::CostConfig config;
  config.radius_cells = {1, 2, 4};
  for (terrain::FeatureCost* feature :
       {&config.slope, &config.height_difference, &config.deviation, &config.roughness}) {
    feature->weight = {1, 2, 3};
  }
  config.slope.scale = {1.5, 1.2, 0.9};
  config.height_difference.scale = {0.03, 0.05, 0.07};
  config.deviation.scale = {0.01, 0.015, 0.02};
  config.roughness.scale = {300, 250, 200};
  return config;
}

}  // namespace

void hash_terrain(Fnv64& hash) {
  const auto grid = std::make_unique<terrain::TerrainGrid>();
  const auto library = std::make_unique<terrain::PatchLibrary>();
  const auto filler = std::make_unique<terrain::TerrainFiller>();
  const auto cost = std::make_unique<terrain::CostMap>();
  terrain::FillConfig config = some_fill();
  config.samples = 12;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    config.rule = static_cast<terrain::SightRule>(seed % 3);
    config.patch_cells = static_cast<std::uint8_t>(3 + 2 * seed);
    config.smoothing_sweeps = static_cast<std::uint8_t>(seed % 2 * 3);
    config.smoothing_hold = 2;
    make_scene(seed, 36, 30, 0.01, *grid);
    fill_library(2, 40, 40, 0.01, config.patch_cells, *library);
    hash.byte(static_cast<std::uint8_t>(filler->configure(config)));
    hash.byte(static_cast<std::uint8_t>(
        filler->start(*grid, *library, some_prior(0.01, 3), 0.7 * static_cast<double>(seed))));
    while (!filler->advance(500)) {
    }
    hash.byte(static_cast<std::uint8_t>(cost->configure(some_cost())));
    hash.byte(static_cast<std::uint8_t>(cost->start()));
    for (std::int32_t draw = 0; draw < filler->draws(); ++draw) {
      hash.byte(static_cast<std::uint8_t>(cost->add(filler->draw(draw))));
      while (!cost->advance(7)) {
      }
    }
    for (std::int32_t cell = 0; cell < grid->size(); ++cell) {
      const auto i = static_cast<std::size_t>(cell);
      hash.byte(static_cast<std::uint8_t>(filler->result().state[i]));
      hash.word(std::bit_cast<std::uint32_t>(filler->result().height_m[i]), 4);
      hash.word(std::bit_cast<std::uint32_t>(filler->result().spread_m[i]), 4);
      mix(hash, cost->cost(i));
      mix(hash, cost->spread(i));
    }
  }
}

void hash_terrain_task(Fnv64& hash) {
  const auto task = std::make_unique<autonomy::TerrainTask>();
  autonomy::TerrainConfig config = terrain_task_config();
  config.synthesis.samples = 6;
  config.synthesis.draws = 2;
  hash.byte(static_cast<std::uint8_t>(task->reset(config, kTerrainCell_m)));
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const auto window = terrain_window(seed);
    const std::uint64_t digest = window->digest();
    while (task->release(*window, digest, 0.3 * static_cast<double>(seed))) {
      task->run();
      task->publish();
    }
    hash.word(task->map_digest(), 8);
    hash.word(task->counters().filled, 8);
  }
}

}  // namespace surefoot::tests
