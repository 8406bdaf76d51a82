#include "sim_hal/world/terrain_index.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

// Narrows [t0, t1] to where origin + t * direction lies in [low, high]; false when nowhere.
bool clip(double origin, double direction, double low, double high, double& t0, double& t1) {
  if (direction == 0) return origin >= low && origin <= high;
  const double inverse = 1.0 / direction;
  double near = (low - origin) * inverse;
  double far = (high - origin) * inverse;
  if (near > far) std::swap(near, far);
  t0 = std::max(t0, near);
  t1 = std::min(t1, far);
  return t0 <= t1;
}

double cast_box(const TerrainBox& box, const Vector3& origin, const Vector3& direction) {
  double t0 = 0;
  double t1 = kNoHit;
  if (!clip(origin.z(), direction.z(), box.bottom_m, box.top_m, t0, t1)) return kNoHit;
  const double dx = origin.x() - box.x_m;
  const double dy = origin.y() - box.y_m;
  const double along = box.cos_yaw * dx + box.sin_yaw * dy;
  const double along_rate = box.cos_yaw * direction.x() + box.sin_yaw * direction.y();
  if (!clip(along, along_rate, -box.half_length_m, box.half_length_m, t0, t1)) return kNoHit;
  const double across = box.cos_yaw * dy - box.sin_yaw * dx;
  const double across_rate = box.cos_yaw * direction.y() - box.sin_yaw * direction.x();
  if (!clip(across, across_rate, -box.half_width_m, box.half_width_m, t0, t1)) return kNoHit;
  return t0 > 0 ? t0 : kNoHit;
}

}  // namespace

// Steps from raster cell to raster cell along a ray (Amanatides and Woo).
struct TerrainIndex::Walk {
  std::int64_t i = 0;
  std::int64_t j = 0;
  std::int64_t step_i = 0;
  std::int64_t step_j = 0;
  double next_i = kNoHit;  // t at which the ray leaves the cell in x
  double next_j = kNoHit;
  double per_i = kNoHit;
  double per_j = kNoHit;

  static void axis(double offset, double direction, double t0, double cell, std::int64_t limit,
                   std::int64_t& index, std::int64_t& step, double& next, double& per) {
    const double at = (offset + t0 * direction) / cell;
    index = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(at)), 0, limit - 1);
    if (direction == 0) return;
    step = direction > 0 ? 1 : -1;
    per = cell / std::fabs(direction);
    const double border = static_cast<double>(direction > 0 ? index + 1 : index) * cell;
    next = (border - offset) / direction;
  }
  Walk(const Vector3& offset, const Vector3& direction, double t0, double cell, std::size_t nx,
       std::size_t ny) {
    axis(offset.x(), direction.x(), t0, cell, static_cast<std::int64_t>(nx), i, step_i, next_i,
         per_i);
    axis(offset.y(), direction.y(), t0, cell, static_cast<std::int64_t>(ny), j, step_j, next_j,
         per_j);
  }
  double leave() const { return std::min(next_i, next_j); }
  void advance() {
    if (next_i <= next_j) {
      i += step_i;
      next_i += per_i;
    } else {
      j += step_j;
      next_j += per_j;
    }
  }
  bool inside(std::size_t nx, std::size_t ny) const {
    return i >= 0 && j >= 0 && i < static_cast<std::int64_t>(nx) &&
           j < static_cast<std::int64_t>(ny);
  }
};

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
  Walk walk(offset, direction, t0, grid.cell_m, grid.nx - 1, grid.ny - 1);
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

double TerrainIndex::cast(const Vector3& origin, const Vector3& direction, double t_max) const {
  const double ground = cast_ground(origin, direction, t_max);
  if (obstacle_ == nullptr) return ground;
  const double box = cast_box(*obstacle_, origin, direction);
  return box <= t_max ? std::min(ground, box) : ground;
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
  const Vector3 offset(origin.x() - x0_m_, origin.y() - y0_m_, origin.z());
  Walk walk(offset, direction, t0, kCell_m, nx_, ny_);
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
      if (hit <= until) return std::min(hit, end);
    }
    if (until >= t1) return miss;
    from = until;
    walk.advance();
  }
  return miss;
}

}  // namespace surefoot::sim
