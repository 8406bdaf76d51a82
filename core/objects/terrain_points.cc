#include "core/objects/terrain_points.h"

#include <algorithm>
#include <limits>

#include "core/math/elementary.h"

namespace surefoot::objects {
namespace {

constexpr std::int32_t kSide = mapping::kWindowSide;
constexpr float kNothing = std::numeric_limits<float>::max();

std::size_t place(std::int32_t x, std::int32_t y) {
  return static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x);
}

}  // namespace

void TerrainPoints::reset(const ObjectsConfig& config) {
  config_ = config;
  counters_ = TerrainCounters{};
}

// Lowest of a square, rows first.
void TerrainPoints::find_lowest(const mapping::MapWindow& window, std::int32_t reach) {
  for (std::int32_t y = 0; y < kSide; ++y) {
    for (std::int32_t x = 0; x < kSide; ++x) {
      float low = kNothing;
      for (std::int32_t i = std::max(0, x - reach); i <= std::min(kSide - 1, x + reach); ++i) {
        const mapping::WindowCell& cell = window.cells[place(i, y)];
        if (cell.has_height()) low = std::min(low, cell.height_m);
      }
      row_low_m_[place(x, y)] = low;
    }
  }
  for (std::int32_t y = 0; y < kSide; ++y) {
    for (std::int32_t x = 0; x < kSide; ++x) {
      float low = kNothing;
      for (std::int32_t i = std::max(0, y - reach); i <= std::min(kSide - 1, y + reach); ++i) {
        low = std::min(low, row_low_m_[place(x, i)]);
      }
      low_m_[place(x, y)] = low;
    }
  }
}

void TerrainPoints::find(const mapping::MapWindow& window, SurfacePoints& out) {
  out.clear();
  const double cell_m = window.cell_size_m;
  if (!(cell_m > 0)) return;
  const double cells = config_.terrain_reach_m / cell_m;
  find_lowest(window, static_cast<std::int32_t>(math::clamp(cells, 1.0, kSide - 1.0)));
  square_.fill(0);
  // Squares of O, so that a window that moves on finds the same ones.
  const double square_m = std::max(config_.thin_m, cell_m);
  const mapping::CellIndex first =
      mapping::cell_index(mapping::cell_centre(window.first.ix, cell_m),
                          mapping::cell_centre(window.first.iy, cell_m), square_m);
  for (std::int32_t y = 0; y < kSide; ++y) {
    for (std::int32_t x = 0; x < kSide; ++x) {
      const mapping::WindowCell& cell = window.cells[place(x, y)];
      if (!cell.has_height()) continue;
      const double rise_m = static_cast<double>(cell.height_m - low_m_[place(x, y)]);
      if (rise_m < config_.terrain_rise_m) continue;
      ++counters_.cells;
      const Vector2 p(mapping::cell_centre(window.first.ix + x, cell_m),
                      mapping::cell_centre(window.first.iy + y, cell_m));
      const mapping::CellIndex at = mapping::cell_index(p[0], p[1], square_m);
      std::uint16_t& known = square_[place(at.ix - first.ix, at.iy - first.iy)];
      if (known != 0) {
        ++counters_.thinned;
        SurfacePoint& point = out[known - 1u];
        point.z_O_m = std::max(point.z_O_m, cell.height_m);
        continue;
      }
      if (!ok(out.push_back({p, cell.height_m, 0, kNoBeam}))) {
        ++counters_.refused;
        continue;
      }
      known = static_cast<std::uint16_t>(out.size());
    }
  }
}

bool TerrainPoints::is_level(const mapping::MapWindow& window, const Vector2& p_O_m) const {
  const double half_m = 0.5 * config_.thin_m;
  const double cell_m = window.cell_size_m;
  const auto low = mapping::cell_index(p_O_m[0] - half_m, p_O_m[1] - half_m, cell_m);
  const auto high = mapping::cell_index(p_O_m[0] + half_m, p_O_m[1] + half_m, cell_m);
  if (!window.contains(low) || !window.contains(high)) return false;
  for (std::int32_t iy = low.iy; iy <= high.iy; ++iy) {
    for (std::int32_t ix = low.ix; ix <= high.ix; ++ix) {
      const std::size_t at = window.place({ix, iy});
      const mapping::WindowCell& cell = window.cells[at];
      if (!cell.has_height()) return false;
      const double rise_m = static_cast<double>(cell.height_m - low_m_[at]);
      if (rise_m >= config_.terrain_rise_m) return false;
    }
  }
  return true;
}

}  // namespace surefoot::objects
