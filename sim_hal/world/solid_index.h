// A raster over the solids that stay where they are, and over saplings: which may lie in a cell.
// Built once; queries neither allocate nor change it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/linear.h"
#include "sim_hal/world/cell_raster.h"
#include "sim_hal/world/ray.h"
#include "sim_hal/world/solid.h"

namespace surefoot::sim {

struct Clearance {
  double distance_m = kNoHit;  // negative: inside
  Vector2 away = Vector2(1, 0);
};

class SolidIndex {
 public:
  static constexpr double kCell_m = 1.0;
  static constexpr std::size_t kMaxCandidates = 64;

  // They must outlive the index.
  SolidIndex(const std::vector<Solid>& solids, const std::vector<Sapling>& saplings);

  bool empty() const { return solids_.empty() && saplings_.empty(); }
  const std::vector<Solid>& solids() const { return solids_; }

  // Smallest t in (0, t_max] at which origin + t * direction is on a solid's surface; kNoHit: none.
  double cast(const Vector3& origin, const Vector3& direction, double t_max) const;
  // The nearest sapling that a beam of this full width meets at all within t_max; `share` is the
  // part of the beam's width that it fills there. kNoHit: none.
  double cast_saplings(const Vector3& origin, const Vector3& direction, double t_max,
                       double divergence_rad, double& share) const;
  // Highest solid above (x, y); -infinity: none.
  double top_m(double x, double y) const;
  // Solids that may touch the rectangle, each once, ascending. Returns their number, at most
  // out.size(); more are cut off.
  std::size_t near(double x0, double y0, double x1, double y1, std::span<std::uint32_t> out) const;
  // The solid nearest in plan to the segment a-b, with half a width around it, of those nearer
  // than reach_m.
  Clearance clearance(const Vector2& a_m, const Vector2& b_m, double half_width_m,
                      double reach_m) const;

 private:
  const std::vector<Solid>& solids_;
  const std::vector<Sapling>& saplings_;
  CellRaster raster_;
  CellLists solid_lists_;
  CellLists sapling_lists_;
};

}  // namespace surefoot::sim
