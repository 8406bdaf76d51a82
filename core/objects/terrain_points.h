// What the height map shows to stand up: boulders and logs lower than the scanner's plane (paper
// 003, section III-A.1: "a spatial filter identifies regions of substantial height variation").
//
// A cell with height stands up if it is at least terrain_rise_m above the lowest cell with height
// within terrain_reach_m (a square). A slope of 11 degrees rises 0.04 m over 0.2 m.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/mapping/map_window.h"
#include "core/objects/config.h"
#include "core/objects/scan_points.h"

namespace surefoot::objects {

struct TerrainCounters {
  std::uint64_t cells = 0;    // that stand up
  std::uint64_t thinned = 0;  // of these, in the place of another
  std::uint64_t refused = 0;  // no room

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("cells", self.cells);
    visit("thinned", self.thinned);
    visit("refused", self.refused);
  }
};

class TerrainPoints {
 public:
  void reset(const ObjectsConfig& config);

  // One point, the highest, for each square of thin_m. Nothing for a window never published.
  // 10,000 cells, twice (2 reach / cell + 1) cells each: 0.2 m and 4 cm is 220,000.
  void find(const mapping::MapWindow& window, SurfacePoints& out);

  // Whether the window of the last find shows the square of thin_m around a place, all of its cells
  // known and none standing up.
  bool is_level(const mapping::MapWindow& window, const Vector2& p_O_m) const;

  const TerrainCounters& counters() const { return counters_; }

 private:
  static constexpr std::size_t kCells =
      static_cast<std::size_t>(mapping::kWindowSide) * mapping::kWindowSide;

  void find_lowest(const mapping::MapWindow& window, std::int32_t reach);

  ObjectsConfig config_;
  std::array<float, kCells> row_low_m_{};
  std::array<float, kCells> low_m_{};
  std::array<std::uint16_t, kCells> square_{};  // 1 + the index of the point of that square
  TerrainCounters counters_;
};

}  // namespace surefoot::objects
