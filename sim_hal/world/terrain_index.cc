#include "sim_hal/world/terrain_index.h"

#include <algorithm>
#include <cmath>

#include "sim_hal/world/ray.h"

namespace surefoot::sim {

namespace {

struct Rectangle {
  double x0 = 0;
  double y0 = 0;
  double x1 = 0;
  double y1 = 0;

  void include(const Rectangle& other) {
    x0 = std::min(x0, other.x0);
    y0 = std::min(y0, other.y0);
    x1 = std::max(x1, other.x1);
    y1 = std::max(y1, other.y1);
  }
};

Rectangle bounds(const TerrainBox& box) {
  const double c = std::fabs(box.cos_yaw);
  const double s = std::fabs(box.sin_yaw);
  const double reach_x = c * box.half_length_m + s * box.half_width_m;
  const double reach_y = s * box.half_length_m + c * box.half_width_m;
  return {box.x_m - reach_x, box.y_m - reach_y, box.x_m + reach_x, box.y_m + reach_y};
}

}  // namespace

TerrainIndex::TerrainIndex(const Terrain& terrain) : terrain_(terrain) {
  bool any = false;
  Rectangle all;
  const auto include = [&](const Rectangle& rectangle) {
    if (any) {
      all.include(rectangle);
    } else {
      all = rectangle;
    }
    any = true;
  };
  for (const TerrainBox& box : terrain.boxes) include(bounds(box));
  const HeightGrid& grid = terrain.grid;
  if (!grid.empty()) include({grid.x0_m, grid.y0_m, grid.end_x_m(), grid.end_y_m()});
  if (!any) return;
  // A margin of 1 mm: surfaces on the border belong to the raster.
  x0_m_ = all.x0 - 0.001;
  y0_m_ = all.y0 - 0.001;
  nx_ = static_cast<std::size_t>(std::ceil((all.x1 + 0.001 - x0_m_) / kCell_m));
  ny_ = static_cast<std::size_t>(std::ceil((all.y1 + 0.001 - y0_m_) / kCell_m));
  cells_.resize(nx_ * ny_);
  add_boxes();
  add_grid();
  for (const Cell& cell : cells_) max_m_ = std::max(max_m_, cell.max_m);
}

void TerrainIndex::add_boxes() {
  std::vector<std::vector<std::uint32_t>> lists(cells_.size());
  for (std::size_t k = 0; k < terrain_.boxes.size(); ++k) {
    const Rectangle r = bounds(terrain_.boxes[k]);
    std::size_t range[4];
    if (!rectangle(r.x0, r.y0, r.x1, r.y1, range)) continue;
    for (std::size_t j = range[1]; j <= range[3]; ++j) {
      for (std::size_t i = range[0]; i <= range[2]; ++i) {
        lists[j * nx_ + i].push_back(static_cast<std::uint32_t>(k));
        Cell& cell = cells_[j * nx_ + i];
        cell.max_m = std::max(cell.max_m, terrain_.boxes[k].top_m);
      }
    }
  }
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    cells_[c].first = static_cast<std::uint32_t>(items_.size());
    cells_[c].count = static_cast<std::uint32_t>(lists[c].size());
    items_.insert(items_.end(), lists[c].begin(), lists[c].end());
  }
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
      std::size_t range[4];
      if (!rectangle(x, y, x + grid.cell_m, y + grid.cell_m, range)) continue;
      for (std::size_t b = range[1]; b <= range[3]; ++b) {
        for (std::size_t a = range[0]; a <= range[2]; ++a) {
          Cell& cell = cells_[b * nx_ + a];
          cell.max_m = std::max(cell.max_m, top);
        }
      }
    }
  }
}

// Raster cells [0]..[2] by [1]..[3] of a rectangle; false when it misses the raster.
bool TerrainIndex::rectangle(double x0, double y0, double x1, double y1,
                             std::size_t (&range)[4]) const {
  if (cells_.empty()) return false;
  const double limit_x = static_cast<double>(nx_);
  const double limit_y = static_cast<double>(ny_);
  const double i0 = std::floor((x0 - x0_m_) / kCell_m);
  const double j0 = std::floor((y0 - y0_m_) / kCell_m);
  const double i1 = std::floor((x1 - x0_m_) / kCell_m);
  const double j1 = std::floor((y1 - y0_m_) / kCell_m);
  if (!(i1 >= 0 && j1 >= 0 && i0 < limit_x && j0 < limit_y)) return false;
  range[0] = static_cast<std::size_t>(std::max(0.0, i0));
  range[1] = static_cast<std::size_t>(std::max(0.0, j0));
  range[2] = static_cast<std::size_t>(std::min(limit_x - 1, i1));
  range[3] = static_cast<std::size_t>(std::min(limit_y - 1, j1));
  return true;
}

double TerrainIndex::height_m(double x, double y) const {
  double height = terrain_.grid.contains(x, y) ? terrain_.grid.height_m(x, y) : 0.0;
  std::size_t range[4];
  if (!rectangle(x, y, x, y, range)) return height;
  const Cell& cell = cells_[range[1] * nx_ + range[0]];
  for (std::uint32_t k = 0; k < cell.count; ++k) {
    const TerrainBox& box = terrain_.boxes[items_[cell.first + k]];
    if (box.top_m > height && box.covers(x, y)) height = box.top_m;
  }
  return height;
}

double TerrainIndex::max_height_m(double x0, double y0, double x1, double y1) const {
  double height = 0;
  std::size_t range[4];
  if (!rectangle(x0, y0, x1, y1, range)) return height;
  for (std::size_t j = range[1]; j <= range[3]; ++j) {
    for (std::size_t i = range[0]; i <= range[2]; ++i) {
      height = std::max(height, cells_[j * nx_ + i].max_m);
    }
  }
  return height;
}

std::size_t TerrainIndex::boxes_near(double x0, double y0, double x1, double y1,
                                     std::span<std::uint32_t> out) const {
  std::size_t range[4];
  if (!rectangle(x0, y0, x1, y1, range)) return 0;
  std::size_t count = 0;
  for (std::size_t j = range[1]; j <= range[3]; ++j) {
    for (std::size_t i = range[0]; i <= range[2]; ++i) {
      const Cell& cell = cells_[j * nx_ + i];
      for (std::uint32_t k = 0; k < cell.count && count < out.size(); ++k) {
        const std::uint32_t box = items_[cell.first + k];
        const auto end = out.begin() + static_cast<std::ptrdiff_t>(count);
        if (std::find(out.begin(), end, box) == end) out[count++] = box;
      }
    }
  }
  std::sort(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count));
  return count;
}

double TerrainIndex::cast_boxes(const Cell& cell, const Vector3& origin,
                                const Vector3& direction) const {
  double nearest = kNoHit;
  for (std::uint32_t k = 0; k < cell.count; ++k) {
    const TerrainBox& box = terrain_.boxes[items_[cell.first + k]];
    nearest = std::min(nearest, cast_box(box, origin, direction));
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
  if (solids == nullptr || cells_.empty() || !block_max_m_.empty()) return;
  blocks_x_ = (nx_ + kBlock - 1) / kBlock;
  blocks_y_ = (ny_ + kBlock - 1) / kBlock;
  block_max_m_.assign(blocks_x_ * blocks_y_, 0.0);
  for (std::size_t j = 0; j < ny_; ++j) {
    for (std::size_t i = 0; i < nx_; ++i) {
      double& highest = block_max_m_[j / kBlock * blocks_x_ + i / kBlock];
      highest = std::max(highest, cells_[j * nx_ + i].max_m);
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
  if (cells_.empty() ||
      (terrain_.grid.empty() && !clip(origin.z(), direction.z(), 0.0, max_m_, t0, t1)) ||
      !clip(origin.z(), direction.z(), -1e3, max_m_, t0, t1) ||
      !clip(origin.x(), direction.x(), x0_m_, x0_m_ + kCell_m * static_cast<double>(nx_), t0, t1) ||
      !clip(origin.y(), direction.y(), y0_m_, y0_m_ + kCell_m * static_cast<double>(ny_), t0, t1)) {
    return miss;
  }
  const double hit =
      block_max_m_.empty() ? march(origin, direction, t0, t1) : leap(origin, direction, t0, t1);
  return hit == kNoHit ? miss : std::min(hit, end);
}

// Block by block; cell by cell where the ray is low enough for a block's highest cell.
double TerrainIndex::leap(const Vector3& origin, const Vector3& direction, double t0,
                          double t1) const {
  const Vector3 offset(origin.x() - x0_m_, origin.y() - y0_m_, origin.z());
  RasterWalk walk(offset, direction, t0, kCell_m * static_cast<double>(kBlock), blocks_x_,
                  blocks_y_);
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
  const Vector3 offset(origin.x() - x0_m_, origin.y() - y0_m_, origin.z());
  RasterWalk walk(offset, direction, t0, kCell_m, nx_, ny_);
  double from = t0;
  while (walk.inside(nx_, ny_)) {
    const double until = std::min(walk.leave(), t1);
    const Cell& cell =
        cells_[static_cast<std::size_t>(walk.j) * nx_ + static_cast<std::size_t>(walk.i)];
    const double lowest = origin.z() + direction.z() * (direction.z() < 0 ? until : from);
    if (lowest <= cell.max_m) {
      double hit = cell.count > 0 ? cast_boxes(cell, origin, direction) : kNoHit;
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
