// A coarse raster over the terrain: which boxes may lie in a cell, and how high the ground gets
// there. Serves contact search, height queries and rays. Built once; queries neither allocate nor
// change it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/linear.h"
#include "sim_hal/world/cell_raster.h"
#include "sim_hal/world/ray.h"
#include "sim_hal/world/solid_index.h"
#include "sim_hal/world/terrain.h"

namespace surefoot::sim {

class TerrainIndex {
 public:
  static constexpr double kCell_m = 0.1;
  static constexpr std::size_t kMaxCandidates = 64;
  static constexpr std::size_t kBlock = 16;

  // The terrain must outlive the index.
  explicit TerrainIndex(const Terrain& terrain);

  // A box that may be moved between queries, beside the terrain: rays hit it. It is no ground: the
  // height queries know nothing of it. Null: none. It must outlive its use.
  void show(const TerrainBox* obstacle) { obstacle_ = obstacle; }
  // Solids, those that stay and those that move between queries: the same holds of them.
  void show(const SolidIndex* solids);
  void show(std::span<const Solid> moving) { moving_ = moving; }

  double height_m(double x, double y) const;
  // Upper bound of the ground inside the rectangle.
  double max_height_m(double x0, double y0, double x1, double y1) const;
  // Boxes that may touch the rectangle, each once, ascending. Returns their number, at most
  // out.size(); more are cut off.
  std::size_t boxes_near(double x0, double y0, double x1, double y1,
                         std::span<std::uint32_t> out) const;
  // Smallest t in (0, t_max] at which origin + t * direction is on the ground's surface; kNoHit
  // when none. The direction need not have unit length. Starting below the ground gives an
  // arbitrary hit.
  double cast(const Vector3& origin, const Vector3& direction, double t_max) const;
  // The same without what moves or may be moved.
  double cast_fixed(const Vector3& origin, const Vector3& direction, double t_max) const;

 private:
  double cast_ground(const Vector3& origin, const Vector3& direction, double t_max) const;
  double march(const Vector3& origin, const Vector3& direction, double t0, double t1) const;
  double leap(const Vector3& origin, const Vector3& direction, double t0, double t1) const;

  void add_boxes();
  void add_grid();
  void raise(const PlanBounds& bounds, double top_m);
  double cast_boxes(std::size_t cell, const Vector3& origin, const Vector3& direction) const;
  double cast_grid(const Vector3& origin, const Vector3& direction, double t0, double t1) const;

  const Terrain& terrain_;
  const TerrainBox* obstacle_ = nullptr;
  const SolidIndex* solids_ = nullptr;
  std::span<const Solid> moving_;
  CellRaster raster_;
  CellLists boxes_;                 // that may lie in a cell
  std::vector<double> cell_max_m_;  // how high the ground gets there
  double max_m_ = 0;
  std::size_t blocks_x_ = 0;  // blocks of kBlock x kBlock cells; none: far rays are not expected
  std::size_t blocks_y_ = 0;
  std::vector<double> block_max_m_;
};

}  // namespace surefoot::sim
