// What can be told to the fill. Recommended values: README.md.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/parameters.h"
#include "core/base/status.h"

namespace surefoot::terrain {

inline constexpr std::int32_t kMaxDraws = 8;

// What a candidate patch that rises above a ceiling is worth.
enum class SightRule : std::uint8_t {
  kNone = 0,  // ceilings are ignored: plain texture synthesis
  kReject,    // refused, as the paper's text says; where none is left the least offender wins
  kPenalty,   // its violation counts against it; the height is cut at the ceiling
};
inline constexpr std::array<const char*, 3> kSightRuleNames{"none", "reject", "penalty"};

enum class FillOrder : std::uint8_t {
  kRaster = 0,  // column by column, as the paper's figure 6
  kFarFirst,    // from the far rim of a shadow, whose ground was seen, back to what casts it
};
inline constexpr std::array<const char*, 2> kFillOrderNames{"raster", "far_first"};

// Defaults are none on purpose (core/base/parameters.h).
struct FillConfig {
  SightRule rule = SightRule::kNone;
  FillOrder order = FillOrder::kRaster;
  std::uint8_t patch_cells = 0;
  std::uint16_t samples = 0;
  std::uint8_t draws = 0;
  double weight_deviation = 0;
  double penalty = 0;
  double guide = 0;
  std::uint8_t smoothing_sweeps = 0;
  double smoothing_hold = 0;
  std::uint32_t seed = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("rule", self.rule, kSightRuleNames, "for patches above a ceiling");
    visit.choice("order", self.order, kFillOrderNames, "in which cells are filled");
    visit.integer("patch_cells", self.patch_cells, {3, 15}, "side of a patch, odd");
    visit.integer("samples", self.samples, {1, 10000}, "patches compared for a cell, per draw");
    visit.integer("draws", self.draws, {1, kMaxDraws}, "fills that are made and averaged");
    visit.real("weight_deviation", self.weight_deviation, {0.05, 10.0},
               "of the Gaussian weights of a patch, in sides");
    visit.real("penalty", self.penalty, {0.0, 1000.0},
               "weight of squared heights above ceilings against squared differences");
    visit.real("guide", self.guide, {0.0, 1000.0},
               "weight of the squared distance to the learned height; 0: not used");
    visit.integer("smoothing_sweeps", self.smoothing_sweeps, {0, 50}, "over filled cells");
    visit.real("smoothing_hold", self.smoothing_hold, {0.0, 100.0},
               "weight of the drawn height against the four neighbours");
    visit.integer("seed", self.seed, {0, 4294967295.0}, "of the draws");
  }
};

// kInvalid: a value outside describe()'s range, or an even patch_cells.
Status validate(const FillConfig& config);

}  // namespace surefoot::terrain
