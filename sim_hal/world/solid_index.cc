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
    for (const PlanBounds& bounds : *list) all.include(bounds);
  }
  raster_ = CellRaster(all, kCell_m);
  solid_lists_.fill(raster_, solid_bounds);
  sapling_lists_.fill(raster_, sapling_bounds);
}

double SolidIndex::cast(const Vector3& origin, const Vector3& direction, double t_max) const {
  double t0 = 0;
  double t1 = t_max;
  if (!raster_.enter(origin, direction, t0, t1)) return kNoHit;
  RasterWalk walk(raster_.offset(origin), direction, t0, kCell_m, raster_.nx(), raster_.ny());
  while (walk.inside(raster_.nx(), raster_.ny())) {
    const double until = std::min(walk.leave(), t1);
    const std::size_t cell =
        raster_.index(static_cast<std::size_t>(walk.i), static_cast<std::size_t>(walk.j));
    double hit = kNoHit;
    for (const std::uint32_t k : solid_lists_.in(cell)) {
      hit = std::min(hit, cast_solid(solids_[k], origin, direction));
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
  if (saplings_.empty() || level2 == 0 || !raster_.enter(origin, direction, t0, t1)) return kNoHit;
  const double level = std::sqrt(level2);
  RasterWalk walk(raster_.offset(origin), direction, t0, kCell_m, raster_.nx(), raster_.ny());
  while (walk.inside(raster_.nx(), raster_.ny())) {
    const double until = std::min(walk.leave(), t1);
    const std::size_t cell =
        raster_.index(static_cast<std::size_t>(walk.i), static_cast<std::size_t>(walk.j));
    double nearest = kNoHit;
    for (const std::uint32_t k : sapling_lists_.in(cell)) {
      const Sapling& s = saplings_[k];
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
  CellRange range;
  if (!raster_.range({x, y, x, y}, range)) return top;
  for (const std::uint32_t k : solid_lists_.in(raster_.index(range.i0, range.j0))) {
    top = std::max(top, top_at(solids_[k], x, y));
  }
  return top;
}

std::size_t SolidIndex::near(double x0, double y0, double x1, double y1,
                             std::span<std::uint32_t> out) const {
  return solid_lists_.near(raster_, {x0, y0, x1, y1}, out);
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
