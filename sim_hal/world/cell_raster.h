// A raster over the plan of a world, and lists of what may lie in its cells. Built once; queries
// neither allocate nor change it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/linear.h"

namespace surefoot::sim {

struct PlanBounds {
  double x0 = 0;
  double y0 = 0;
  double x1 = 0;
  double y1 = 0;

  void include(const PlanBounds& other) {
    x0 = std::min(x0, other.x0);
    y0 = std::min(y0, other.y0);
    x1 = std::max(x1, other.x1);
    y1 = std::max(y1, other.y1);
  }
};

// Cells i0..i1 by j0..j1, both ends included.
struct CellRange {
  std::size_t i0 = 0;
  std::size_t j0 = 0;
  std::size_t i1 = 0;
  std::size_t j1 = 0;
};

class CellRaster {
 public:
  CellRaster() = default;
  // Covers the bounds and a millimetre around them: surfaces on the border belong to it.
  CellRaster(const PlanBounds& bounds, double cell_m);

  bool empty() const { return nx_ == 0; }
  double cell_m() const { return cell_m_; }
  std::size_t nx() const { return nx_; }
  std::size_t ny() const { return ny_; }
  std::size_t cells() const { return nx_ * ny_; }
  std::size_t index(std::size_t i, std::size_t j) const { return j * nx_ + i; }
  // false: the bounds miss the raster.
  bool range(const PlanBounds& bounds, CellRange& range) const;
  // Narrows [t0, t1] to where the ray is above the raster; false: nowhere.
  bool enter(const Vector3& origin, const Vector3& direction, double& t0, double& t1) const;
  // From the raster's corner.
  Vector3 offset(const Vector3& origin) const {
    return {origin.x() - x0_m_, origin.y() - y0_m_, origin.z()};
  }

 private:
  double x0_m_ = 0;
  double y0_m_ = 0;
  double cell_m_ = 1;
  std::size_t nx_ = 0;
  std::size_t ny_ = 0;
};

class CellLists {
 public:
  void fill(const CellRaster& raster, const std::vector<PlanBounds>& bounds);

  // Numbers of the things that may lie in a cell, ascending.
  std::span<const std::uint32_t> in(std::size_t cell) const {
    return std::span(items_).subspan(cells_[cell].first, cells_[cell].count);
  }
  // Things that may touch the bounds, each once, ascending. Returns their number, at most
  // out.size(); more are cut off.
  std::size_t near(const CellRaster& raster, const PlanBounds& bounds,
                   std::span<std::uint32_t> out) const;

 private:
  struct Cell {
    std::uint32_t first = 0;  // into items_
    std::uint32_t count = 0;
  };

  std::vector<Cell> cells_;
  std::vector<std::uint32_t> items_;
};

}  // namespace surefoot::sim
