#include "sim_hal/world/cell_raster.h"

#include <cmath>

#include "sim_hal/world/ray.h"

namespace surefoot::sim {

CellRaster::CellRaster(const PlanBounds& bounds, double cell_m)
    : x0_m_(bounds.x0 - 0.001), y0_m_(bounds.y0 - 0.001), cell_m_(cell_m) {
  nx_ = static_cast<std::size_t>(std::ceil((bounds.x1 + 0.001 - x0_m_) / cell_m));
  ny_ = static_cast<std::size_t>(std::ceil((bounds.y1 + 0.001 - y0_m_) / cell_m));
}

bool CellRaster::range(const PlanBounds& bounds, CellRange& range) const {
  if (empty()) return false;
  const double limit_x = static_cast<double>(nx_);
  const double limit_y = static_cast<double>(ny_);
  const double i0 = std::floor((bounds.x0 - x0_m_) / cell_m_);
  const double j0 = std::floor((bounds.y0 - y0_m_) / cell_m_);
  const double i1 = std::floor((bounds.x1 - x0_m_) / cell_m_);
  const double j1 = std::floor((bounds.y1 - y0_m_) / cell_m_);
  if (!(i1 >= 0 && j1 >= 0 && i0 < limit_x && j0 < limit_y)) return false;
  range.i0 = static_cast<std::size_t>(std::max(0.0, i0));
  range.j0 = static_cast<std::size_t>(std::max(0.0, j0));
  range.i1 = static_cast<std::size_t>(std::min(limit_x - 1, i1));
  range.j1 = static_cast<std::size_t>(std::min(limit_y - 1, j1));
  return true;
}

bool CellRaster::enter(const Vector3& origin, const Vector3& direction, double& t0,
                       double& t1) const {
  const double x1_m = x0_m_ + cell_m_ * static_cast<double>(nx_);
  const double y1_m = y0_m_ + cell_m_ * static_cast<double>(ny_);
  return !empty() && clip(origin.x(), direction.x(), x0_m_, x1_m, t0, t1) &&
         clip(origin.y(), direction.y(), y0_m_, y1_m, t0, t1);
}

void CellLists::fill(const CellRaster& raster, const std::vector<PlanBounds>& bounds) {
  std::vector<std::vector<std::uint32_t>> lists(raster.cells());
  for (std::size_t k = 0; k < bounds.size(); ++k) {
    CellRange range;
    if (!raster.range(bounds[k], range)) continue;
    for (std::size_t j = range.j0; j <= range.j1; ++j) {
      for (std::size_t i = range.i0; i <= range.i1; ++i) {
        lists[raster.index(i, j)].push_back(static_cast<std::uint32_t>(k));
      }
    }
  }
  cells_.resize(lists.size());
  items_.clear();
  for (std::size_t c = 0; c < lists.size(); ++c) {
    cells_[c] = {static_cast<std::uint32_t>(items_.size()),
                 static_cast<std::uint32_t>(lists[c].size())};
    items_.insert(items_.end(), lists[c].begin(), lists[c].end());
  }
}

std::size_t CellLists::near(const CellRaster& raster, const PlanBounds& bounds,
                            std::span<std::uint32_t> out) const {
  CellRange range;
  if (!raster.range(bounds, range)) return 0;
  std::size_t count = 0;
  for (std::size_t j = range.j0; j <= range.j1; ++j) {
    for (std::size_t i = range.i0; i <= range.i1; ++i) {
      for (const std::uint32_t item : in(raster.index(i, j))) {
        if (count == out.size()) break;
        const auto end = out.begin() + static_cast<std::ptrdiff_t>(count);
        if (std::find(out.begin(), end, item) == end) out[count++] = item;
      }
    }
  }
  std::sort(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count));
  return count;
}

}  // namespace surefoot::sim
