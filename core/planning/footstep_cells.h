// What stepping on a cell costs, whoever steps and from wherever: rated when first asked for and
// kept while one plan is made.
//
// A direct-mapped cache of 32 x 32 cells: the candidates of one step lie in a square of at most 28
// cells, so that none of them drives another out. Frames: O, metres. Memory: 32 kB. Cost: a miss
// reads 9 cells and at most 49 for the edge; start() clears.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/planning/footstep_config.h"
#include "core/terrain/terrain_map.h"

namespace surefoot::planning {

struct FootstepCell {
  mapping::CellIndex index;
  bool rated = false;
  bool usable = false;  // it has a height and its terrain cost is within the limit
  double height_m = 0;  // in O as the map has it: mean of the known cells of the 3 x 3
  double terrain = 0;   // its cost, 0 to 1
  double cost_m = 0;    // of terrain, spread and edge
};

class FootstepCells {
 public:
  void reset(const FootstepConfig& config);
  // Forgets all ratings. The map must stay while at() is called.
  void start(const terrain::TerrainMap& map);
  const terrain::TerrainMap* map() const { return map_; }
  // Outside the window: not usable.
  const FootstepCell& at(mapping::CellIndex index);

 private:
  static constexpr std::int32_t kSide = 32;

  struct Edges {
    double wall_m = 0;
    double drop_m = 0;
  };

  void rate(FootstepCell& cell) const;
  Edges edges(mapping::CellIndex index, double height_m) const;

  FootstepConfig config_;
  const terrain::TerrainMap* map_ = nullptr;
  std::array<FootstepCell, static_cast<std::size_t>(kSide) * kSide> cells_{};
};

}  // namespace surefoot::planning
