// Small rough terrain for the tests of core/terrain: waves and blocks, and shadows cut into it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/random.h"
#include "core/math/elementary.h"
#include "core/terrain/fill.h"

namespace surefoot::tests {

// Blocks of random height on gentle waves, about 8 cm from lowest to highest.
inline std::vector<float> rough_heights(std::uint64_t seed, std::int32_t columns,
                                        std::int32_t rows) {
  Random random(seed, 3);
  std::vector<float> heights(static_cast<std::size_t>(columns * rows));
  const double phase = random.uniform(0.0, 6.0);
  for (std::int32_t row = 0; row < rows; ++row) {
    for (std::int32_t column = 0; column < columns; ++column) {
      heights[static_cast<std::size_t>(row * columns + column)] = static_cast<float>(
          0.01 * math::sin(0.4 * column + phase) * math::cos(0.3 * row) + 0.001 * random.normal());
    }
  }
  for (int block = 0; block < columns * rows / 60; ++block) {
    const auto c = static_cast<std::int32_t>(random.below(static_cast<std::uint32_t>(columns)));
    const auto r = static_cast<std::int32_t>(random.below(static_cast<std::uint32_t>(rows)));
    const auto raise = static_cast<float>(random.uniform(0.01, 0.06));
    for (std::int32_t row = r; row < r + 5 && row < rows; ++row) {
      for (std::int32_t column = c; column < c + 4 && column < columns; ++column) {
        heights[static_cast<std::size_t>(row * columns + column)] = raise;
      }
    }
  }
  return heights;
}

// Some rectangles unseen under ceilings, some corners unknown, the rest measured.
inline void make_scene(std::uint64_t seed, std::int32_t columns, std::int32_t rows, double cell_m,
                       terrain::TerrainGrid& grid) {
  const std::vector<float> heights = rough_heights(seed, columns, rows);
  Random random(seed, 4);
  (void)grid.reset(
      columns, rows, cell_m,
      {static_cast<std::int32_t>(seed) * 7 - 20, 30 - static_cast<std::int32_t>(seed)});
  for (std::size_t i = 0; i < heights.size(); ++i) grid.measure(i, heights[i]);
  const auto cut = [&](std::int32_t width, std::int32_t height, terrain::Knowledge knowledge) {
    const auto c = static_cast<std::int32_t>(random.below(static_cast<std::uint32_t>(columns)));
    const auto r = static_cast<std::int32_t>(random.below(static_cast<std::uint32_t>(rows)));
    for (std::int32_t row = r; row < r + height && row < rows; ++row) {
      for (std::int32_t column = c; column < c + width && column < columns; ++column) {
        const std::size_t i = grid.index(column, row);
        grid.knowledge[i] = terrain::Knowledge::kUnknown;
        grid.value_m[i] = 0;
        if (knowledge == terrain::Knowledge::kBounded) {
          grid.bound(i, heights[i] + static_cast<float>(random.uniform(0.0, 0.03)));
        }
      }
    }
  };
  for (int k = 0; k < columns * rows / 100 + 1; ++k) cut(5, 6, terrain::Knowledge::kBounded);
  for (int k = 0; k < columns * rows / 400 + 1; ++k) cut(3, 2, terrain::Knowledge::kUnknown);
}

inline constexpr std::int32_t kWindowUnseen = 3000;

// A window of 100 x 100 cells, all seen but kWindowUnseen in shadows six cells long.
inline void make_shadowed_window(double cell_m, terrain::TerrainGrid& grid) {
  constexpr std::int32_t kSide = 100;
  const std::vector<float> heights = rough_heights(1, kSide, kSide);
  (void)grid.reset(kSide, kSide, cell_m);
  std::int32_t unseen = 0;
  for (std::int32_t row = 0; row < kSide; ++row) {
    for (std::int32_t column = 0; column < kSide; ++column) {
      const std::size_t i = grid.index(column, row);
      if (column % 20 < 6 && unseen < kWindowUnseen) {
        grid.bound(i, heights[i] + 0.02f);
        ++unseen;
      } else {
        grid.measure(i, heights[i]);
      }
    }
  }
}

inline void fill_library(std::int32_t pieces, std::int32_t columns, std::int32_t rows,
                         double cell_m, std::int32_t patch_cells, terrain::PatchLibrary& library) {
  (void)library.reset(cell_m, patch_cells);
  for (std::int32_t k = 0; k < pieces; ++k) {
    const auto seed = static_cast<std::uint64_t>(100 + k);
    terrain::Provenance provenance;
    provenance.source = {'w', 'a', 'v', 'e', 's'};
    provenance.seed = seed;
    (void)library.add(provenance, columns, rows, cell_m, rough_heights(seed, columns, rows));
  }
}

// Plausible: the ground lies below the ceiling and leans on its neighbours.
inline terrain::HeightPrior some_prior(double cell_m, std::int32_t radius = 2) {
  terrain::HeightPrior prior;
  prior.radius = radius;
  prior.stride = 1;
  prior.cell_m = cell_m;
  prior.residual_m = 0.01;
  Random random(9);
  for (std::size_t k = 0; k < prior.inputs(); ++k) {
    prior.weights[k] = static_cast<float>(random.uniform(-0.002, 0.002));
  }
  prior.weights[2 * prior.points()] = -0.01f;
  return prior;
}

inline terrain::FillConfig some_fill() {
  terrain::FillConfig config;
  config.rule = terrain::SightRule::kPenalty;
  config.order = terrain::FillOrder::kFarFirst;
  config.patch_cells = 7;
  config.samples = 30;
  config.draws = 4;
  config.weight_deviation = 0.25;
  config.penalty = 1;
  config.guide = 1;
  config.seed = 1;
  return config;
}

}  // namespace surefoot::tests
