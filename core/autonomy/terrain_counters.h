// What became of the windows that were completed and rated.
#pragma once

#include <cstdint>

namespace surefoot::autonomy {

struct TerrainCounters {
  std::uint64_t maps = 0;      // published
  std::uint64_t refused = 0;   // windows without a measured cell
  std::uint64_t filled = 0;    // cells, of the map published last
  std::uint64_t unknown = 0;   // cells that no line of sight bounded, likewise
  std::uint64_t no_patch = 0;  // of the filled ones: nothing was known around

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("maps", self.maps);
    visit("refused", self.refused);
    visit("filled", self.filled);
    visit("unknown", self.unknown);
    visit("no_patch", self.no_patch);
  }
};

}  // namespace surefoot::autonomy
