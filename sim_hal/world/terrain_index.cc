#include "sim_hal/world/terrain_index.h"

#include <algorithm>
#include <cmath>

#include "sim_hal/world/ray.h"

namespace surefoot::sim {

namespace {

PlanBounds bounds_of(const TerrainBox& box) {
  const double c = std::fabs(box.cos_yaw);
  const double s = std::fabs(box.sin_yaw);
  const double reach_x = c * box.half_length_m + s * box.half_width_m;
  const double reach_y = s * box.half_length_m + c * box.half_width_m;
  return {box.x_m - reach_x, box.y_m - reach_y, box.x_m + reach_x, box.y_m + reach_y};
}

}  // namespace

TerrainIndex::TerrainIndex(const Terrain& terrain) : terrain_(terrain) {
  std::vector<PlanBounds> parts;
  for (const TerrainBox& box : terrain.boxes) parts.push_back(bounds_of(box));
  const HeightGrid& grid = terrain.grid;
  if (!grid.empty()) parts.push_back({grid.x0_m, grid.y0_m, grid.end_x_m(), grid.end_y_m()});
  if (parts.empty()) return;
  PlanBounds all = parts.front();
  for (const PlanBounds& part : parts) all.include(part);
  raster_ = CellRaster(all, kCell_m);
  cell_max_m_.resize(raster_.cells());
  add_boxes();
  add_grid();
  for (const double cell_m : cell_max_m_) max_m_ = std::max(max_m_, cell_m);
}

void TerrainIndex::raise(const PlanBounds& bounds, double top_m) {
  CellRange range;
  if (!raster_.range(bounds, range)) return;
  for (std::size_t j = range.j0; j <= range.j1; ++j) {
    for (std::size_t i = range.i0; i <= range.i1; ++i) {
      double& highest_m = cell_max_m_[raster_.index(i, j)];
      highest_m = std::max(highest_m, top_m);
    }
  }
}

void TerrainIndex::add_boxes() {
  std::vector<PlanBounds> bounds;
  for (const TerrainBox& box : terrain_.boxes) {
    bounds.push_back(bounds_of(box));
    raise(bounds.back(), box.top_m);
  }
  boxes_.fill(raster_, bounds);
}

void TerrainIndex::add_grid() {
  const HeightGrid& grid = terrain_.grid;
  if (grid.empty()) return;
  for (std::size_t j = 0; j + 1 < grid.ny; ++j) {
    for (std::size_t i = 0; i + 1 < grid.nx; ++i) {
      const double top = std::max(std::max(grid.at(i, j), grid.at(i + 1, j)),
                                  std::max(grid.at(i, j + 1), grid.at(i + 1, j + 1)));
      const double x = grid.x0_m + grid.cell_m * static_cast<double>(i);
      const double y = grid.y0_m + grid.cell_m * static_cast<double>(j);
      raise({x, y, x + grid.cell_m, y + grid.cell_m}, top);
    }
  }
}

double TerrainIndex::height_m(double x, double y) const {
  double height = terrain_.grid.contains(x, y) ? terrain_.grid.height_m(x, y) : 0.0;
  CellRange range;
  if (!raster_.range({x, y, x, y}, range)) return height;
  for (const std::uint32_t k : boxes_.in(raster_.index(range.i0, range.j0))) {
    const TerrainBox& box = terrain_.boxes[k];
    if (box.top_m > height && box.covers(x, y)) height = box.top_m;
  }
  return height;
}

double TerrainIndex::max_height_m(double x0, double y0, double x1, double y1) const {
  double height = 0;
  CellRange range;
  if (!raster_.range({x0, y0, x1, y1}, range)) return height;
  for (std::size_t j = range.j0; j <= range.j1; ++j) {
    for (std::size_t i = range.i0; i <= range.i1; ++i) {
      height = std::max(height, cell_max_m_[raster_.index(i, j)]);
    }
  }
  return height;
}

std::size_t TerrainIndex::boxes_near(double x0, double y0, double x1, double y1,
                                     std::span<std::uint32_t> out) const {
  return boxes_.near(raster_, {x0, y0, x1, y1}, out);
}

double TerrainIndex::cast_boxes(std::size_t cell, const Vector3& origin,
                                const Vector3& direction) const {
  double nearest = kNoHit;
  for (const std::uint32_t k : boxes_.in(cell)) {
    nearest = std::min(nearest, cast_box(terrain_.boxes[k], origin, direction));
  }
  return nearest;
}

// Follows the ray over the grid's cells between t0 and t1. Over one triangle the ray's height above
// the ground is linear in t, so a change of sign between a triangle's borders gives the hit
// exactly.
double TerrainIndex::cast_grid(const Vector3& origin, const Vector3& direction, double t0,
                               double t1) const {
  const HeightGrid& grid = terrain_.grid;
  if (!clip(origin.x(), direction.x(), grid.x0_m, grid.end_x_m(), t0, t1)) return kNoHit;
  if (!clip(origin.y(), direction.y(), grid.y0_m, grid.end_y_m(), t0, t1)) return kNoHit;
  const Vector3 offset(origin.x() - grid.x0_m, origin.y() - grid.y0_m, origin.z());
  RasterWalk walk(offset, direction, t0, grid.cell_m, grid.nx - 1, grid.ny - 1);
  const double skew_rate = (direction.x() - direction.y()) / grid.cell_m;
  double from = t0;
  while (walk.inside(grid.nx - 1, grid.ny - 1)) {
    const double until = std::min(walk.leave(), t1);
    const auto i = static_cast<std::size_t>(walk.i);
    const auto j = static_cast<std::size_t>(walk.j);
    const double z00 = grid.at(i, j);
    const double z10 = grid.at(i + 1, j);
    const double z01 = grid.at(i, j + 1);
    const double z11 = grid.at(i + 1, j + 1);
    const double lowest = origin.z() + direction.z() * (direction.z() < 0 ? until : from);
    if (lowest <= std::max(std::max(z00, z10), std::max(z01, z11))) {
      const auto above = [&](double t) {
        const double u = (offset.x() + t * direction.x()) / grid.cell_m - static_cast<double>(i);
        const double v = (offset.y() + t * direction.y()) / grid.cell_m - static_cast<double>(j);
        const double ground = u >= v ? z00 + (z10 - z00) * u + (z11 - z10) * v
                                     : z00 + (z11 - z01) * u + (z01 - z00) * v;
        return offset.z() + t * direction.z() - ground;
      };
      const double skew = (offset.x() - offset.y()) / grid.cell_m -
                          (static_cast<double>(i) - static_cast<double>(j));
      const double diagonal = skew_rate == 0 ? until : std::clamp(-skew / skew_rate, from, until);
      double a = from;
      double above_a = above(a);
      for (const double b : {diagonal, until}) {
        const double above_b = above(b);
        if (above_b <= 0) {
          if (above_a <= 0) return a;
          return a + (b - a) * above_a / (above_a - above_b);
        }
        a = b;
        above_a = above_b;
      }
    }
    if (until >= t1) return kNoHit;
    from = until;
    walk.advance();
  }
  return kNoHit;
}

// Worlds with solids are wide, and scanners look far: blocks of cells are passed over at once.
void TerrainIndex::show(const SolidIndex* solids) {
  solids_ = solids;
  if (solids == nullptr || raster_.empty() || !block_max_m_.empty()) return;
  blocks_x_ = (raster_.nx() + kBlock - 1) / kBlock;
  blocks_y_ = (raster_.ny() + kBlock - 1) / kBlock;
  block_max_m_.assign(blocks_x_ * blocks_y_, 0.0);
  for (std::size_t j = 0; j < raster_.ny(); ++j) {
    for (std::size_t i = 0; i < raster_.nx(); ++i) {
      double& highest = block_max_m_[j / kBlock * blocks_x_ + i / kBlock];
      highest = std::max(highest, cell_max_m_[raster_.index(i, j)]);
    }
  }
}

double TerrainIndex::cast(const Vector3& origin, const Vector3& direction, double t_max) const {
  double nearest = cast_fixed(origin, direction, t_max);
  if (obstacle_ != nullptr) {
    const double box = cast_box(*obstacle_, origin, direction);
    if (box <= t_max) nearest = std::min(nearest, box);
  }
  for (const Solid& solid : moving_) {
    const double hit = cast_solid(solid, origin, direction);
    if (hit <= t_max) nearest = std::min(nearest, hit);
  }
  return nearest;
}

double TerrainIndex::cast_fixed(const Vector3& origin, const Vector3& direction,
                                double t_max) const {
  if (solids_ == nullptr) return cast_ground(origin, direction, t_max);
  const double solid = solids_->cast(origin, direction, t_max);
  return std::min(solid, cast_ground(origin, direction, std::min(solid, t_max)));
}

double TerrainIndex::cast_ground(const Vector3& origin, const Vector3& direction,
                                 double t_max) const {
  double plane = kNoHit;
  if (direction.z() < 0 && origin.z() > 0) {
    plane = -origin.z() / direction.z();
    if (!terrain_.grid.empty() && terrain_.grid.contains(origin.x() + plane * direction.x(),
                                                         origin.y() + plane * direction.y())) {
      plane = kNoHit;
    }
  }
  double end = std::min(plane, t_max);
  const double miss = plane <= t_max ? plane : kNoHit;
  double t0 = 0;
  double t1 = end;
  if (raster_.empty() ||
      (terrain_.grid.empty() && !clip(origin.z(), direction.z(), 0.0, max_m_, t0, t1)) ||
      !clip(origin.z(), direction.z(), -1e3, max_m_, t0, t1) ||
      !raster_.enter(origin, direction, t0, t1)) {
    return miss;
  }
  const double hit =
      block_max_m_.empty() ? march(origin, direction, t0, t1) : leap(origin, direction, t0, t1);
  return hit == kNoHit ? miss : std::min(hit, end);
}

// Block by block; cell by cell where the ray is low enough for a block's highest cell.
double TerrainIndex::leap(const Vector3& origin, const Vector3& direction, double t0,
                          double t1) const {
  RasterWalk walk(raster_.offset(origin), direction, t0, kCell_m * static_cast<double>(kBlock),
                  blocks_x_, blocks_y_);
  double from = t0;
  while (walk.inside(blocks_x_, blocks_y_)) {
    const double until = std::min(walk.leave(), t1);
    const double highest = block_max_m_[static_cast<std::size_t>(walk.j) * blocks_x_ +
                                        static_cast<std::size_t>(walk.i)];
    const double lowest = origin.z() + direction.z() * (direction.z() < 0 ? until : from);
    if (lowest <= highest) {
      const double hit = march(origin, direction, from, until);
      if (hit != kNoHit) return hit;
    }
    if (until >= t1) return kNoHit;
    from = until;
    walk.advance();
  }
  return kNoHit;
}

double TerrainIndex::march(const Vector3& origin, const Vector3& direction, double t0,
                           double t1) const {
  RasterWalk walk(raster_.offset(origin), direction, t0, kCell_m, raster_.nx(), raster_.ny());
  double from = t0;
  while (walk.inside(raster_.nx(), raster_.ny())) {
    const double until = std::min(walk.leave(), t1);
    const std::size_t cell =
        raster_.index(static_cast<std::size_t>(walk.i), static_cast<std::size_t>(walk.j));
    const double lowest = origin.z() + direction.z() * (direction.z() < 0 ? until : from);
    if (lowest <= cell_max_m_[cell]) {
      double hit = cast_boxes(cell, origin, direction);
      if (!terrain_.grid.empty()) hit = std::min(hit, cast_grid(origin, direction, from, until));
      // A box reaching into later cells may be hit there, behind something nearer.
      if (hit <= until) return hit;
    }
    if (until >= t1) return kNoHit;
    from = until;
    walk.advance();
  }
  return kNoHit;
}

}  // namespace surefoot::sim
