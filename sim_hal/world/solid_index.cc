#include "sim_hal/world/solid_index.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace surefoot::sim {

namespace {

// How far beside its axis a beam may meet a sapling: none is farther away than this in a cell.
constexpr double kSaplingMargin_m = 0.25;

PlanBounds bounds_of_sapling(const Sapling& s) {
  const double r = s.radius_m + kSaplingMargin_m;
  return {s.x_m - r, s.y_m - r, s.x_m + r, s.y_m + r};
}

}  // namespace

SolidIndex::SolidIndex(const std::vector<Solid>& solids, const std::vector<Sapling>& saplings)
    : solids_(solids), saplings_(saplings) {
  std::vector<PlanBounds> solid_bounds;
  std::vector<PlanBounds> sapling_bounds;
  for (const Solid& solid : solids_) solid_bounds.push_back(plan_bounds(solid));
  for (const Sapling& sapling : saplings_) sapling_bounds.push_back(bounds_of_sapling(sapling));
  if (empty()) return;
  PlanBounds all = solid_bounds.empty() ? sapling_bounds.front() : solid_bounds.front();
  for (const auto* list : {&solid_bounds, &sapling_bounds}) {
    for (const PlanBounds& b : *list) {
      all = {std::min(all.x0, b.x0), std::min(all.y0, b.y0), std::max(all.x1, b.x1),
             std::max(all.y1, b.y1)};
    }
  }
  x0_m_ = all.x0 - 0.001;
  y0_m_ = all.y0 - 0.001;
  nx_ = static_cast<std::size_t>(std::ceil((all.x1 + 0.001 - x0_m_) / kCell_m));
  ny_ = static_cast<std::size_t>(std::ceil((all.y1 + 0.001 - y0_m_) / kCell_m));
  fill(solid_bounds, solid_layer_);
  fill(sapling_bounds, sapling_layer_);
}

void SolidIndex::fill(const std::vector<PlanBounds>& bounds, Layer& layer) const {
  std::vector<std::vector<std::uint32_t>> lists(nx_ * ny_);
  for (std::size_t k = 0; k < bounds.size(); ++k) {
    std::size_t range[4];
    if (!rectangle(bounds[k].x0, bounds[k].y0, bounds[k].x1, bounds[k].y1, range)) continue;
    for (std::size_t j = range[1]; j <= range[3]; ++j) {
      for (std::size_t i = range[0]; i <= range[2]; ++i) {
        lists[j * nx_ + i].push_back(static_cast<std::uint32_t>(k));
      }
    }
  }
  layer.cells.resize(nx_ * ny_);
  for (std::size_t c = 0; c < lists.size(); ++c) {
    layer.cells[c] = {static_cast<std::uint32_t>(layer.items.size()),
                      static_cast<std::uint32_t>(lists[c].size())};
    layer.items.insert(layer.items.end(), lists[c].begin(), lists[c].end());
  }
}

bool SolidIndex::rectangle(double x0, double y0, double x1, double y1,
                           std::size_t (&range)[4]) const {
  if (nx_ == 0) return false;
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

// Where the ray is above the raster.
bool SolidIndex::enter(const Vector3& origin, const Vector3& direction, double& t0,
                       double& t1) const {
  return nx_ > 0 &&
         clip(origin.x(), direction.x(), x0_m_, x0_m_ + kCell_m * static_cast<double>(nx_), t0,
              t1) &&
         clip(origin.y(), direction.y(), y0_m_, y0_m_ + kCell_m * static_cast<double>(ny_), t0, t1);
}

double SolidIndex::cast(const Vector3& origin, const Vector3& direction, double t_max) const {
  double t0 = 0;
  double t1 = t_max;
  if (!enter(origin, direction, t0, t1)) return kNoHit;
  const Vector3 offset(origin.x() - x0_m_, origin.y() - y0_m_, origin.z());
  RasterWalk walk(offset, direction, t0, kCell_m, nx_, ny_);
  while (walk.inside(nx_, ny_)) {
    const double until = std::min(walk.leave(), t1);
    const std::size_t c = static_cast<std::size_t>(walk.j) * nx_ + static_cast<std::size_t>(walk.i);
    const Cell& cell = solid_layer_.cells[c];
    double hit = kNoHit;
    for (std::uint32_t k = 0; k < cell.count; ++k) {
      const Solid& solid = solids_[solid_layer_.items[cell.first + k]];
      hit = std::min(hit, cast_solid(solid, origin, direction));
    }
    // What reaches into later cells may be hit there, behind something nearer.
    if (hit <= until) return hit;
    if (until >= t1) return kNoHit;
    walk.advance();
  }
  return kNoHit;
}

double SolidIndex::cast_saplings(const Vector3& origin, const Vector3& direction, double t_max,
                                 double divergence_rad, double& share) const {
  double t0 = 0;
  double t1 = t_max;
  const double level2 = direction.x() * direction.x() + direction.y() * direction.y();
  if (saplings_.empty() || level2 == 0 || !enter(origin, direction, t0, t1)) return kNoHit;
  const double level = std::sqrt(level2);
  const Vector3 offset(origin.x() - x0_m_, origin.y() - y0_m_, origin.z());
  RasterWalk walk(offset, direction, t0, kCell_m, nx_, ny_);
  while (walk.inside(nx_, ny_)) {
    const double until = std::min(walk.leave(), t1);
    const std::size_t c = static_cast<std::size_t>(walk.j) * nx_ + static_cast<std::size_t>(walk.i);
    const Cell& cell = sapling_layer_.cells[c];
    double nearest = kNoHit;
    for (std::uint32_t k = 0; k < cell.count; ++k) {
      const Sapling& s = saplings_[sapling_layer_.items[cell.first + k]];
      const double dx = s.x_m - origin.x();
      const double dy = s.y_m - origin.y();
      const double t = (dx * direction.x() + dy * direction.y()) / level2;
      if (!(t > 0 && t <= t1 && t < nearest)) continue;
      const double off = std::fabs(dx * direction.y() - dy * direction.x()) / level;
      const double half = 0.5 * divergence_rad * t * level;
      if (off > half + s.radius_m) continue;
      const double z = origin.z() + t * direction.z();
      if (z < s.bottom_m || z > s.top_m) continue;
      nearest = t;
      share = std::min(1.0, s.radius_m / std::max(half, 1e-6));
    }
    if (nearest <= until) return nearest;
    if (until >= t1) return kNoHit;
    walk.advance();
  }
  return kNoHit;
}

double SolidIndex::top_m(double x, double y) const {
  double top = -kNoHit;
  std::size_t range[4];
  if (!rectangle(x, y, x, y, range)) return top;
  const Cell& cell = solid_layer_.cells[range[1] * nx_ + range[0]];
  for (std::uint32_t k = 0; k < cell.count; ++k) {
    top = std::max(top, top_at(solids_[solid_layer_.items[cell.first + k]], x, y));
  }
  return top;
}

std::size_t SolidIndex::near(double x0, double y0, double x1, double y1,
                             std::span<std::uint32_t> out) const {
  std::size_t range[4];
  if (!rectangle(x0, y0, x1, y1, range)) return 0;
  std::size_t count = 0;
  for (std::size_t j = range[1]; j <= range[3]; ++j) {
    for (std::size_t i = range[0]; i <= range[2]; ++i) {
      const Cell& cell = solid_layer_.cells[j * nx_ + i];
      for (std::uint32_t k = 0; k < cell.count && count < out.size(); ++k) {
        const std::uint32_t solid = solid_layer_.items[cell.first + k];
        const auto end = out.begin() + static_cast<std::ptrdiff_t>(count);
        if (std::find(out.begin(), end, solid) == end) out[count++] = solid;
      }
    }
  }
  std::sort(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count));
  return count;
}

Clearance SolidIndex::clearance(const Vector2& a_m, const Vector2& b_m, double half_width_m,
                                double reach_m) const {
  const double margin = half_width_m + reach_m;
  std::array<std::uint32_t, kMaxCandidates> found;
  const std::size_t count =
      near(std::min(a_m.x(), b_m.x()) - margin, std::min(a_m.y(), b_m.y()) - margin,
           std::max(a_m.x(), b_m.x()) + margin, std::max(a_m.y(), b_m.y()) + margin, found);
  Clearance least{reach_m, Vector2(1, 0)};
  for (std::size_t k = 0; k < count; ++k) {
    Vector2 away;
    const double distance = plan_distance_m(solids_[found[k]], a_m, b_m, away) - half_width_m;
    if (distance < least.distance_m) least = {distance, away};
  }
  return least;
}

}  // namespace surefoot::sim
