// What the robot takes along about ground it has not seen: a piece of known terrain to draw patches
// from and the learned prior. Made by `surefoot-lab learn terrain`, kept as a file of
// config/terrain, part of every record.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/fixed_vector.h"
#include "core/base/parameters.h"
#include "core/base/status.h"
#include "core/terrain/height_prior.h"
#include "core/terrain/patch_library.h"

namespace surefoot::terrain {

inline constexpr std::size_t kModelColumns = 100;
inline constexpr std::size_t kModelRows = 100;
// The prior of a model has a full lattice around the cell.
inline constexpr std::int32_t kModelPriorRadius = kMaxPriorRadius;
inline constexpr std::size_t kModelPriorPoints =
    (2 * kModelPriorRadius + 1) * (2 * kModelPriorRadius + 1);

struct ModelRow {
  std::array<double, kModelColumns> heights_m{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.reals("heights_m", self.heights_m, {-10.0, 10.0}, "along x");
  }
};

// Defaults are none on purpose (core/base/parameters.h).
struct TerrainModel {
  double cell_m = 0;
  std::uint64_t seed = 0;  // of the generated terrain
  FixedVector<ModelRow, kModelRows> rows;
  double prior_residual_m = 0;
  std::array<double, kModelPriorPoints> prior_heights{};   // weights, as HeightPrior lays them out
  std::array<double, kModelPriorPoints> prior_measured{};  // likewise
  double prior_constant = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("cell_m", self.cell_m, {0.001, 1.0}, "of terrain and prior");
    visit.integer("seed", self.seed, {0.0, 1e15}, "of the generated terrain");
    visit.list("rows", self.rows);
    visit.real("prior_residual_m", self.prior_residual_m, {0.0, 10.0}, "rms, where it was learned");
    visit.reals("prior_heights", self.prior_heights, {-10.0, 10.0}, "weights of what is around");
    visit.reals("prior_measured", self.prior_measured, {-10.0, 10.0}, "of whether it was measured");
    visit.real("prior_constant", self.prior_constant, {-10.0, 10.0}, "m");
  }
};

// The model's terrain as a library of patches of that size. kInvalid, kOutOfRange: see
// PatchLibrary::reset() and add(): no rows, or fewer than a patch has. `scratch` means nothing
// afterwards.
using ModelHeights = std::array<float, kModelColumns * kModelRows>;
Status make_library(const TerrainModel& model, std::int32_t patch_cells, ModelHeights& scratch,
                    PatchLibrary& out);
HeightPrior make_prior(const TerrainModel& model);

}  // namespace surefoot::terrain
