// summary.json, schema 1 (docs/running.md).
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/common/config_root.h"
#include "apps/common/jump_figures.h"
#include "apps/common/perceived_map.h"
#include "apps/common/referee.h"
#include "apps/common/run_measures.h"
#include "core/control/static_walk.h"
#include "core/runtime/executive.h"
#include "core/runtime/statistics.h"
#include "sim_hal/simulator.h"

namespace surefoot::apps {

struct RunFacts {
  RunRequest request;
  std::uint64_t config_hash = 0;
  Verdict verdict;
  int falls = 0;
  double sim_time_s = 0;
  double wall_time_s = 0;
  RunMeasures measures;
  JumpFigures jump;
  sim::TerrainFigures terrain;
  MapError map;
  std::string plant = "robot";  // what moved: legged or fast, where it was simulated
  std::uint64_t static_bytes = 0;
  std::uint64_t heap_calls = 0;
  std::uint64_t page_faults = 0;
  std::vector<runtime::TaskReport> tasks;
  std::uint64_t ticks = 0;
  std::uint64_t hash = 0;
  std::uint64_t samples_dropped = 0;
  runtime::ExecutiveCounters counters;
  std::uint64_t map_frames_bounded = 0;
  estimation::TrackingCounters tracking;
  control::StaticWalkCounters static_walk;
  autonomy::CameraMotionTelemetry visual_odometry;
  autonomy::LocalisationCounters localisation;
  autonomy::TerrainCounters fill;  // of the map that was published last
  autonomy::NavigationTelemetry navigation;
  double least_clearance_m = 0;      // mission navigate, by the truth
  autonomy::StereoTelemetry stereo;  // valid_share: the mean over all pairs
};

std::string hex16(std::uint64_t value);
nlohmann::ordered_json summary_json(const RunFacts& facts);

}  // namespace surefoot::apps
