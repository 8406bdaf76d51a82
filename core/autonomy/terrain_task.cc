#include "core/autonomy/terrain_task.h"

#include "core/terrain/table_index.h"

namespace surefoot::autonomy {

Status TerrainTask::reset(const TerrainConfig& config, double map_cell_m) {
  enabled_ = false;
  counters_ = TerrainCounters{};
  stage_ = Stage::kIdle;
  taken_digest_ = 0;
  map_digest_ = 0;
  map_.clear();
  if (!config.present) return Status::kOk;
  RangeCheck check;
  TerrainConfig::describe(config, check);
  if (!check.good || !terrain::same_cell_size(config.model.cell_m, map_cell_m))
    return Status::kInvalid;
  if (!ok(filler_.configure(config.synthesis)) || !ok(cost_.configure(config.cost)) ||
      !ok(terrain::make_library(config.model, config.synthesis.patch_cells, scratch_, library_))) {
    return Status::kInvalid;
  }
  prior_ = terrain::make_prior(config.model);
  config_ = config;
  enabled_ = true;
  touch();
  return Status::kOk;
}

// No page fault may happen in a tick.
void TerrainTask::touch() {
  grid_.value_m.fill(0);
  grid_.knowledge.fill(terrain::Knowledge::kUnknown);
  filler_.touch();
  bare_.state.fill(terrain::FilledState::kUnknown);
  bare_.height_m.fill(0);
  bare_.spread_m.fill(0);
  cost_.touch();
  working_.clear();
}

bool TerrainTask::release(const mapping::MapWindow& window, std::uint64_t window_digest,
                          double view_rad) {
  if (!enabled_) return false;
  if (stage_ == Stage::kIdle || stage_ == Stage::kDone) {
    if (window_digest == taken_digest_ || !(window.cell_size_m > 0)) return false;
    taken_digest_ = window_digest;
    view_rad_ = view_rad;
    working_.ground = window;
    stage_ = Stage::kLoad;
  }
  return true;
}

void TerrainTask::run() {
  switch (stage_) {
    case Stage::kLoad: load(); break;
    case Stage::kFill:
      if (filler_.advance(config_.fill_work)) start_cost();
      break;
    case Stage::kCost: rate(); break;
    case Stage::kIdle:
    case Stage::kDone: break;
  }
}

void TerrainTask::load() {
  const Status loaded = terrain::load(working_.ground, grid_);
  SUREFOOT_ASSERT(ok(loaded));
  working_counters_ = TerrainCounters{};
  if (fills()) {
    refused_ = !ok(filler_.start(grid_, library_, prior_, view_rad_));
    stage_ = refused_ ? Stage::kDone : Stage::kFill;
    return;
  }
  refused_ = false;
  terrain::keep_measured(grid_, bare_);
  start_cost();
}

void TerrainTask::start_cost() {
  SUREFOOT_ASSERT(ok(cost_.start()));
  draw_ = 0;
  SUREFOOT_ASSERT(ok(cost_.add(fills() ? filler_.draw(0) : terrain::view_of(bare_))));
  stage_ = Stage::kCost;
}

void TerrainTask::rate() {
  if (!cost_.advance(config_.cost_rows)) return;
  if (fills() && ++draw_ < filler_.draws()) {
    SUREFOOT_ASSERT(ok(cost_.add(filler_.draw(draw_))));
    return;
  }
  complete();
  stage_ = Stage::kDone;
}

void TerrainTask::complete() {
  const terrain::FilledTerrain& ground = fills() ? filler_.result() : bare_;
  for (std::size_t i = 0; i < terrain::TerrainMap::kCells; ++i) {
    mapping::WindowCell& cell = working_.ground.cells[i];
    working_.cost[i] = 0;
    working_.spread_m[i] = 0;
    if (ground.state[i] == terrain::FilledState::kUnknown) {
      ++working_counters_.unknown;
      continue;
    }
    working_.cost[i] = static_cast<float>(cost_.cost(i));
    if (ground.state[i] != terrain::FilledState::kFilled) continue;
    ++working_counters_.filled;
    cell.height_m = ground.height_m[i];
    cell.bridged = true;
    working_.spread_m[i] = ground.spread_m[i];
  }
  if (fills()) working_counters_.no_patch = static_cast<std::uint64_t>(filler_.counts().no_patch);
  working_.raise_crests();
  working_digest_ = working_.digest();
}

void TerrainTask::publish() {
  if (stage_ != Stage::kDone) return;
  if (refused_) {
    ++counters_.refused;
    return;
  }
  const std::uint64_t maps = counters_.maps + 1;
  const std::uint64_t refused = counters_.refused;
  counters_ = working_counters_;
  counters_.maps = maps;
  counters_.refused = refused;
  map_ = working_;
  map_digest_ = working_digest_;
}

}  // namespace surefoot::autonomy
