#include "apps/surefoot-lab/bench_terrain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <vector>

#include "apps/common/statistics.h"
#include "apps/surefoot-lab/stopwatch.h"
#include "apps/surefoot-lab/terrain/fill_methods.h"
#include "core/terrain/cost.h"
#include "core/terrain/fill.h"
#include "tests/support/terrain_parts.h"

namespace surefoot::apps {
namespace {

constexpr int kRounds = 15;
constexpr std::int32_t kSide = 100;
constexpr int kCell_mm = 10;
constexpr std::int64_t kSlice = 10'000;  // units of work per call
constexpr double kMaxTotal_ms = 50;
constexpr double kMaxSlice_ms = 2;

double processor_ms() { return 1e-3 * processor_us(); }

struct Times {
  std::vector<double> total_ms;
  std::vector<double> start_ms;
  std::vector<double> slice_ms;  // the longest of a round
  int slices = 0;
};

}  // namespace

int bench_terrain() {
  const auto grid = std::make_unique<terrain::TerrainGrid>();
  const auto library = std::make_unique<terrain::PatchLibrary>();
  const auto filler = std::make_unique<terrain::TerrainFiller>();
  const auto map = std::make_unique<terrain::CostMap>();
  tests::make_shadowed_window(1e-3 * kCell_mm, *grid);
  const terrain::FillConfig config = improved_config(kCell_mm);
  tests::fill_library(10, kSide, kSide, 1e-3 * kCell_mm, config.patch_cells, *library);
  const terrain::HeightPrior prior =
      tests::some_prior(1e-3 * kCell_mm, prior_options(kCell_mm).radius);
  if (!ok(filler->configure(config)) || !ok(map->configure(cost_config(kCell_mm)))) return 3;
  Times times;
  std::vector<double> cost_ms;
  for (int round = 0; round < kRounds; ++round) {
    const double begin = processor_ms();
    if (!ok(filler->start(*grid, *library, prior, 0))) return 3;
    times.start_ms.push_back(processor_ms() - begin);
    double longest = times.start_ms.back();
    times.slices = 0;
    for (bool done = false; !done; ++times.slices) {
      const double slice = processor_ms();
      done = filler->advance(kSlice);
      longest = std::max(longest, processor_ms() - slice);
    }
    times.total_ms.push_back(processor_ms() - begin);
    times.slice_ms.push_back(longest);
    const double cost_begin = processor_ms();
    (void)map->start();
    (void)map->add(terrain::view_of(filler->result()));
    (void)map->advance(kSide);
    cost_ms.push_back(processor_ms() - cost_begin);
  }
  std::fputs(
      fmt::format("terrain: {} unseen of {} cells, {} draws of {} patches of {} x {}: median "
                  "{:.1f} ms in all ({:.1f} us a cell), {} slices, the longest {:.2f} ms, start "
                  "{:.2f} ms; cost of one view {:.1f} ms\n",
                  filler->counts().unseen, grid->size(), config.draws, config.samples,
                  config.patch_cells, config.patch_cells, median(times.total_ms),
                  1e3 * median(times.total_ms) / filler->counts().unseen, times.slices,
                  median(times.slice_ms), median(times.start_ms), median(cost_ms))
          .c_str(),
      stdout);
  const bool good =
      median(times.total_ms) <= kMaxTotal_ms && median(times.slice_ms) <= kMaxSlice_ms;
  return good ? 0 : 3;
}

}  // namespace surefoot::apps
