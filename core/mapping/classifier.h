// From the map to the classes of the published window.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/mapping/integration.h"
#include "core/mapping/map_window.h"
#include "core/mapping/mapping_config.h"
#include "core/mapping/traversability_filter.h"

namespace surefoot::mapping {

// Holds the window plus a rim, so that a class never depends on where the window ends. Its grid
// lies on a lattice of eight cells, so that it mostly stays while the window moves: then only what
// differs from the last time is recomputed.
class WindowClassifier {
 public:
  // Forgets everything. Touches every page of the object.
  void reset(const MappingConfig& config, const TraversabilityLimits& limits);

  // Fills out.first and out.cells from `map`; nothing else of `out`. The result depends on the map
  // and the centre alone, not on earlier calls.
  void run(const ControlMap& map, CellIndex centre, MapWindow& out);

  // Cells that were recomputed in the last run, with what they reach.
  std::int32_t recomputed_cells() const { return recomputed_cells_; }

 private:
  static constexpr std::int32_t kLattice = 8;
  static constexpr std::int32_t kBridge = 1;
  static constexpr std::int32_t kRim = kFilterReach_cells + kBridge;
  static constexpr std::int32_t kSide =
      (kWindowSide + 2 * kRim + kLattice - 1 + kLattice - 1) / kLattice * kLattice;

  struct Source {
    float height_m = 0;  // as in the map
    float bridge_m = 0;  // bridged: what stands for it
    CellState state = CellState::kUnknown;
    bool bridged = false;
  };
  static std::size_t at(std::int32_t x, std::int32_t y) {
    return static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x);
  }
  // Copies the map's cells; what differs from the last copy.
  CellRect load(const ControlMap& map);
  void bridge(std::int32_t x, std::int32_t y);
  void fill_filter(const CellRect& rect);
  void copy_to(MapWindow& out) const;

  bool bridge_holes_ = false;
  CellIndex origin_;
  bool placed_ = false;
  std::int32_t recomputed_cells_ = 0;
  std::array<Source, static_cast<std::size_t>(kSide) * kSide> cells_{};
  TraversabilityFilter<kSide> filter_;
};

}  // namespace surefoot::mapping
