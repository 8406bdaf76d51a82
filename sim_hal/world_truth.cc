#include "sim_hal/world_truth.h"

#include <algorithm>
#include <cmath>

namespace surefoot::sim {

namespace {

SolidTruth outline_of(const Solid& solid) {
  SolidTruth outline;
  outline.kind = solid.kind;
  outline.top_m = solid.top_m();
  if (solid.is_box()) {
    const TerrainBox& box = solid.box;
    outline.x_m = box.x_m;
    outline.y_m = box.y_m;
    outline.half_length_m = box.half_length_m;
    outline.half_width_m = box.half_width_m;
    outline.yaw_rad = std::atan2(box.sin_yaw, box.cos_yaw);
    return outline;
  }
  const Capsule& capsule = solid.capsule;
  const Vector3 middle = 0.5 * (capsule.a_m + capsule.b_m);
  const Vector3 axis = capsule.b_m - capsule.a_m;
  const double length_m = std::hypot(axis.x(), axis.y());
  outline.x_m = middle.x();
  outline.y_m = middle.y();
  outline.half_length_m = 0.5 * length_m + capsule.radius_m;
  outline.half_width_m = capsule.radius_m;
  if (length_m > 0) outline.yaw_rad = std::atan2(axis.y(), axis.x());
  return outline;
}

void tell_solids(const Terrain& terrain, TerrainFigures& figures) {
  for (const Solid& solid : terrain.solids) {
    switch (solid.kind) {
      case SolidKind::kTrunk: ++figures.trunks; break;
      case SolidKind::kBoulder: ++figures.boulders; break;
      case SolidKind::kLog: ++figures.logs; break;
      case SolidKind::kWall: ++figures.walls; break;
      case SolidKind::kWalker: break;
    }
  }
  figures.saplings = static_cast<std::uint32_t>(terrain.saplings.size());
  figures.walkers = static_cast<std::uint32_t>(terrain.walkers.size());
  figures.area_m2 = terrain.spread.area_m2;
  figures.steepest_rad = terrain.spread.steepest_rad;
  figures.roughness_rms_m = terrain.spread.roughness_rms_m;
  figures.passage_width_m = terrain.spread.passage_width_m;
  figures.layouts = terrain.spread.layouts;
}

}  // namespace

std::vector<SolidTruth> outlines_of(const std::vector<Solid>& solids) {
  std::vector<SolidTruth> outlines;
  for (const Solid& solid : solids) outlines.push_back(outline_of(solid));
  return outlines;
}

TerrainFigures figures_of(const Terrain& terrain, const TerrainIndex& index, double goal_x_m) {
  constexpr double kCell_m = 0.01;
  const auto nx = static_cast<std::size_t>(std::llround(kGoalX_m / kCell_m)) + 1;
  const auto ny = static_cast<std::size_t>(std::llround(kLaneWidth_m / kCell_m)) + 1;
  std::vector<double> z(nx * ny);
  TerrainFigures figures;
  double sum = 0;
  double squares = 0;
  for (std::size_t j = 0; j < ny; ++j) {
    for (std::size_t i = 0; i < nx; ++i) {
      const double x = kCell_m * static_cast<double>(i);
      const double y = kCell_m * static_cast<double>(j) - kLaneWidth_m / 2;
      const double height = index.height_m(x, y);
      z[j * nx + i] = height;
      sum += height;
      squares += height * height;
      figures.max_height_m = std::max(figures.max_height_m, height);
      if (i > 0)
        figures.max_step_m = std::max(figures.max_step_m, std::fabs(height - z[j * nx + i - 1]));
      if (j > 0)
        figures.max_step_m = std::max(figures.max_step_m, std::fabs(height - z[(j - 1) * nx + i]));
    }
  }
  const auto count = static_cast<double>(nx * ny);
  const double mean = sum / count;
  figures.rms_m = std::sqrt(std::max(0.0, squares / count - mean * mean));
  figures.boxes = static_cast<std::uint32_t>(terrain.boxes.size());
  figures.cover = clutter_cover(terrain);
  figures.bridged_cells = terrain.bridged_cells;
  figures.tiles = terrain.tiles;
  figures.goal_x_m = goal_x_m;
  tell_solids(terrain, figures);
  return figures;
}

}  // namespace surefoot::sim
