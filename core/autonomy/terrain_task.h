// The terrain task: completes every published window of the map with the ground that was not seen
// and rates each cell for a foot (core/terrain). Works in slices, one a tick, so that no tick takes
// more than `fill_work` units or `cost_rows` rows; a window that is published meanwhile waits, and
// of several the youngest is taken. The result does not depend on the slices, only its tick does.
//
// Memory: sizeof(TerrainTask) 7.2 MB. Nothing allocates.
#pragma once

#include <cstdint>

#include "core/autonomy/terrain_config.h"
#include "core/autonomy/terrain_counters.h"
#include "core/base/status.h"
#include "core/mapping/map_window.h"
#include "core/terrain/cost.h"
#include "core/terrain/fill.h"
#include "core/terrain/terrain_map.h"

namespace surefoot::autonomy {

class TerrainTask {
 public:
  // kInvalid: the configuration is out of its domain, or its model does not fit the map's cells.
  Status reset(const TerrainConfig& config, double map_cell_m);
  bool enabled() const { return enabled_; }

  // Every tick. window: the one that is published now. view_rad: heading of the camera in O.
  // false: nothing to do.
  bool release(const mapping::MapWindow& window, std::uint64_t window_digest, double view_rad);
  // A slice of the work. May run anywhere between release and publish.
  void run();
  void publish();

  // ground.cell_size_m is 0 until the first one is ready.
  const terrain::TerrainMap& map() const { return map_; }
  std::uint64_t map_digest() const { return map_digest_; }
  const TerrainCounters& counters() const { return counters_; }

 private:
  enum class Stage : std::uint8_t { kIdle, kLoad, kFill, kCost, kDone };

  bool fills() const { return config_.fill == FillUse::kOn; }
  void touch();
  void load();
  void start_cost();
  void rate();
  void complete();

  bool enabled_ = false;
  TerrainConfig config_;
  terrain::PatchLibrary library_;
  terrain::HeightPrior prior_;
  terrain::ModelHeights scratch_{};
  Stage stage_ = Stage::kIdle;
  bool refused_ = false;
  std::uint64_t taken_digest_ = 0;  // of the window in hand, or the last one
  double view_rad_ = 0;
  terrain::TerrainGrid grid_;
  terrain::TerrainFiller filler_;
  terrain::FilledTerrain bare_;  // fill off: the measured cells alone
  terrain::CostMap cost_;
  std::int32_t draw_ = 0;  // whose costs are added up
  TerrainCounters working_counters_;
  terrain::TerrainMap working_;  // written by run()
  std::uint64_t working_digest_ = 0;
  terrain::TerrainMap map_;  // what control sees
  std::uint64_t map_digest_ = 0;
  TerrainCounters counters_;
};

}  // namespace surefoot::autonomy
