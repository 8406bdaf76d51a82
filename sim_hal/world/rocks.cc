// Boards of rocks. contract.md "The worlds".
#include <algorithm>

#include "sim_hal/world/boxes.h"
#include "sim_hal/world/rock_field.h"
#include "sim_hal/world/terrain.h"

namespace surefoot::sim {
namespace {

constexpr double kMinSide_m = 0.10;
constexpr double kMaxSide_m = 0.30;
constexpr double kMinThickness = 0.12;  // of the board's height
constexpr double kMaxThickness = 0.35;
constexpr double kFlatRange_m = 0.06;
constexpr double kJaggedRange_m = 0.12;
constexpr int kSlabs = 400;  // drawn; those that would come to lie too high are left out

// Each slab lies level on the highest one under it, filled down to the ground. Those that would
// come to lie too high are left out; the heights are then scaled to the range that is asked for.
void make_slabs(double height_m, Random& random, Terrain& terrain) {
  const BoxDraw draw{
      kMinSide_m,     kMaxSide_m,   kMinThickness * height_m, kMaxThickness * height_m,
      kBoardLength_m, kBoardWidth_m};
  double highest_m = 0;
  for (int i = 0; i < kSlabs; ++i) {
    TerrainBox slab = draw_box(draw, random);
    slab.top_m += support_m(terrain.boxes, slab);
    if (slab.top_m > height_m) continue;
    highest_m = std::max(highest_m, slab.top_m);
    terrain.boxes.push_back(slab);
  }
  for (TerrainBox& slab : terrain.boxes) slab.top_m *= height_m / highest_m;
}

// One field of bodies as large as the board, sampled every 5 mm.
void make_jagged(double height_m, std::uint64_t seed, Terrain& terrain) {
  constexpr std::size_t kSamples = 5;
  RockFieldOptions options;
  options.bodies = 240;  // as many to the square metre as in the paper
  options.length_m = kBoardLength_m;
  options.width_m = kBoardWidth_m;
  options.height_range_m = height_m;
  const RockField field = cached_rock_field(rock_cache_folder(), options, seed);
  HeightGrid& grid = terrain.grid;
  grid.cell_m = kSamples * RockField::kStep_m;
  grid.nx = field.columns / kSamples;
  grid.ny = field.rows / kSamples;
  grid.x0_m = kFieldBegin_m + 0.5 * grid.cell_m;
  grid.y0_m = 0.5 * (grid.cell_m - kBoardWidth_m);
  for (std::size_t j = 0; j < grid.ny; ++j) {
    for (std::size_t i = 0; i < grid.nx; ++i) {
      const std::size_t column = i * kSamples + kSamples / 2;
      const std::size_t row = j * kSamples + kSamples / 2;
      grid.z_m.push_back(static_cast<double>(field.at(column, row)));
    }
  }
}

}  // namespace

void make_rocks(const WorldSpec& spec, std::uint64_t seed, Random& random, Terrain& terrain) {
  switch (spec.style) {
    case RockStyle::kFlat:
      make_slabs(spec.height_m > 0 ? spec.height_m : kFlatRange_m, random, terrain);
      break;
    case RockStyle::kJagged:
      make_jagged(spec.height_m > 0 ? spec.height_m : kJaggedRange_m, seed, terrain);
      break;
  }
}

}  // namespace surefoot::sim
