#include "core/planning/footstep_cells.h"

#include "core/mapping/foothold.h"
#include "core/math/elementary.h"

namespace surefoot::planning {
namespace {

constexpr std::int32_t kMaxEdgeReach_cells = 4;

// Unlike %, never negative.
std::size_t wrapped(std::int32_t i, std::int32_t side) {
  return static_cast<std::size_t>(static_cast<std::uint32_t>(i) % static_cast<std::uint32_t>(side));
}

}  // namespace

void FootstepCells::reset(const FootstepConfig& config) {
  config_ = config;
  map_ = nullptr;
}

void FootstepCells::start(const terrain::TerrainMap& map) {
  map_ = &map;
  cells_.fill(FootstepCell{});
}

const FootstepCell& FootstepCells::at(mapping::CellIndex index) {
  FootstepCell& cell = cells_[wrapped(index.iy, kSide) * kSide + wrapped(index.ix, kSide)];
  if (!cell.rated || !(cell.index == index)) {
    cell = FootstepCell{};
    cell.index = index;
    cell.rated = true;
    rate(cell);
  }
  return cell;
}

void FootstepCells::rate(FootstepCell& cell) const {
  const mapping::MapWindow& ground = map_->ground;
  const mapping::WindowCell* middle = ground.find(cell.index);
  if (middle == nullptr || !middle->has_height()) return;
  const double terrain = static_cast<double>(map_->cost[ground.place(cell.index)]);
  if (!(terrain <= config_.max_cost)) return;
  double height_m = 0;
  double spread_m = 0;
  int known = 0;
  mapping::for_cells_under_foot(ground, cell.index,
                                [&](mapping::CellIndex at, const mapping::WindowCell& under) {
                                  height_m += static_cast<double>(under.height_m);
                                  spread_m += static_cast<double>(map_->spread_m[ground.place(at)]);
                                  ++known;
                                });
  cell.usable = true;
  cell.terrain = terrain;
  cell.height_m = height_m / known;  // the middle one has a height
  const Edges around = edges(cell.index, cell.height_m);
  cell.cost_m = config_.terrain_weight_m * terrain + config_.spread_weight * (spread_m / known) +
                config_.wall_weight * around.wall_m + config_.drop_weight * around.drop_m;
}

// The most that the ground around stands up over a height, and falls off below it: over the cells
// with height whose centres are within reach.
FootstepCells::Edges FootstepCells::edges(mapping::CellIndex index, double height_m) const {
  const mapping::MapWindow& ground = map_->ground;
  const double reach_cells = config_.edge_reach_m / ground.cell_size_m;
  const auto n = static_cast<std::int32_t>(
      math::clamp(reach_cells, 0.0, static_cast<double>(kMaxEdgeReach_cells)));
  Edges edges;
  for (std::int32_t dy = -n; dy <= n; ++dy) {
    for (std::int32_t dx = -n; dx <= n; ++dx) {
      if (static_cast<double>(dx * dx + dy * dy) > reach_cells * reach_cells) continue;
      const mapping::WindowCell* cell = ground.find(index + mapping::CellIndex{dx, dy});
      if (cell == nullptr || !cell->has_height()) continue;
      const double off_m = static_cast<double>(cell->height_m) - height_m;
      if (off_m > edges.wall_m) edges.wall_m = off_m;
      if (-off_m > edges.drop_m) edges.drop_m = -off_m;
    }
  }
  return edges;
}

}  // namespace surefoot::planning
