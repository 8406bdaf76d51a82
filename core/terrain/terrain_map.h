// What footsteps are planned on: the published window with its unseen cells filled, and for every
// cell how bad it is to stand on and how sure its height is. Plain data.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/time.h"
#include "core/mapping/map_window.h"

namespace surefoot::terrain {

struct TerrainMap {
  static constexpr std::size_t kCells =
      static_cast<std::size_t>(mapping::kWindowSide) * mapping::kWindowSide;

  // Measured cells as they were published; filled ones are `bridged`, with the mean of the draws.
  // cell_size_m 0: there was no map yet.
  mapping::MapWindow ground;
  std::array<float, kCells> cost{};      // 0 to 1, mean over the draws; without height: 0
  std::array<float, kCells> spread_m{};  // standard deviation of a filled height; measured: 0
  // Highest of the 3 x 3 around: what a leg beside it would touch. No height there: kNoCrest_m.
  static constexpr float kNoCrest_m = -1e3F;
  std::array<float, kCells> crest_m{};

  // As before the first one, and every page written.
  void clear();

  // crest_m from the heights of `ground`. Cost: 9 look-ups a cell.
  void raise_crests();

  // Hash of everything above.
  std::uint64_t digest() const;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("ground", self.ground);
    visit("cost", self.cost);
    visit("spread_m", self.spread_m);
    visit("crest_m", self.crest_m);
  }
};

}  // namespace surefoot::terrain
