// What can be tuned about completing and rating the ground that footsteps are planned on.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/parameters.h"
#include "core/terrain/cost.h"
#include "core/terrain/fill_config.h"
#include "core/terrain/terrain_model.h"

namespace surefoot::autonomy {

enum class FillUse : std::uint8_t { kOff = 0, kOn };
inline constexpr std::array<const char*, 2> kFillUseNames{"off", "on"};

// Defaults are none on purpose (core/base/parameters.h); recommended values: docs/robots.md.
struct TerrainConfig {
  bool present = false;
  FillUse fill = FillUse::kOff;  // off: cells that were not seen are left out
  std::uint32_t fill_work = 0;   // units a tick (core/terrain)
  std::uint8_t cost_rows = 0;    // of the map, a tick
  terrain::FillConfig synthesis;
  terrain::CostConfig cost;
  terrain::TerrainModel model;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("fill", self.fill, kFillUseNames, "of ground that was not seen");
    visit.integer("fill_work", self.fill_work, {100, 10'000'000}, "units of filling a tick");
    visit.integer("cost_rows", self.cost_rows, {1, 100}, "rows of the map rated a tick");
    visit.group("synthesis", self.synthesis);
    visit.group("cost", self.cost);
    visit.group("model", self.model);
  }
};

}  // namespace surefoot::autonomy
