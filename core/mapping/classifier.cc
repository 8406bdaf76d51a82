#include "core/mapping/classifier.h"

#include <algorithm>

namespace surefoot::mapping {
namespace {

// Sums for a least-squares plane z = c + a x + b y, x and y in cells from the patch's centre.
struct PlaneSums {
  double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0, z = 0, xz = 0, yz = 0;

  void add(double dx, double dy, double dz) {
    n += 1;
    x += dx;
    y += dy;
    xx += dx * dx;
    yy += dy * dy;
    xy += dx * dy;
    z += dz;
    xz += dx * dz;
    yz += dy * dz;
  }
  // Squared gradient [height per cell]; negative where the cells do not span a plane.
  double gradient2() const {
    const double sxx = n * xx - x * x;
    const double syy = n * yy - y * y;
    const double sxy = n * xy - x * y;
    const double sxz = n * xz - x * z;
    const double syz = n * yz - y * z;
    const double determinant = sxx * syy - sxy * sxy;
    if (!(determinant > 0.5)) return -1;  // integers: either singular or at least one
    const double a = (sxz * syy - syz * sxy) / determinant;
    const double b = (syz * sxx - sxz * sxy) / determinant;
    return a * a + b * b;
  }
};

constexpr std::int32_t kNeighbours = 8;

}  // namespace

void WindowClassifier::run(const ControlMap& map, const MappingConfig& config, CellIndex centre,
                           MapWindow& out) {
  out.first = {centre.ix - kWindowSide / 2, centre.iy - kWindowSide / 2};
  load(map, {out.first.ix - kRim, out.first.iy - kRim});
  if (config.bridge_holes) bridge();
  constexpr std::int32_t kBegin = kRim - kMaxMargin_cells;
  constexpr std::int32_t kEnd = kSide - kBegin;
  for (std::int32_t y = kBegin; y < kEnd; ++y) {
    for (std::int32_t x = kBegin; x < kEnd; ++x) {
      cells_[at(x, y)].foothold = classify(x, y, config);
    }
  }
  for (std::int32_t y = 0; y < kWindowSide; ++y) {
    for (std::int32_t x = 0; x < kWindowSide; ++x) {
      WindowCell cell = cells_[at(x + kRim, y + kRim)];
      if (cell.foothold == FootholdClass::kSteppable) {
        cell.margin_cells = margin(x + kRim, y + kRim);
      }
      out.cells[static_cast<std::size_t>(y) * kWindowSide + static_cast<std::size_t>(x)] = cell;
    }
  }
}

void WindowClassifier::load(const ControlMap& map, CellIndex first) {
  for (std::int32_t y = 0; y < kSide; ++y) {
    for (std::int32_t x = 0; x < kSide; ++x) {
      WindowCell& cell = cells_[at(x, y)];
      cell = WindowCell{};
      const MapCell* source = map.find({first.ix + x, first.iy + y});
      if (source == nullptr) continue;
      cell.height_m = source->height_m;
      cell.state = source->state;
    }
  }
}

void WindowClassifier::bridge() {
  for (std::int32_t y = 1; y + 1 < kSide; ++y) {
    for (std::int32_t x = 1; x + 1 < kSide; ++x) {
      WindowCell& cell = cells_[at(x, y)];
      if (cell.state >= CellState::kAssumed) continue;
      std::array<float, kNeighbours> heights{};
      std::size_t count = 0;
      for (std::int32_t i = 0; i < 9; ++i) {
        const WindowCell& other = cells_[at(x + i % 3 - 1, y + i / 3 - 1)];
        if (i == 4 || other.state < CellState::kAssumed) continue;
        std::size_t place = count++;  // sorted insertion
        for (; place > 0 && heights[place - 1] > other.height_m; --place) {
          heights[place] = heights[place - 1];
        }
        heights[place] = other.height_m;
      }
      if (count < kNeighbours) continue;
      const float median = 0.5F * (heights[3] + heights[4]);
      // A line of sight passed here: the ground cannot stand above it.
      cell.height_m = cell.state == CellState::kBounded ? std::min(median, cell.height_m) : median;
      cell.bridged = true;
    }
  }
}

FootholdClass WindowClassifier::classify(std::int32_t x, std::int32_t y,
                                         const MappingConfig& config) const {
  const WindowCell& centre = cells_[at(x, y)];
  if (!centre.has_height()) return FootholdClass::kUnknown;
  const std::int32_t radius = config.foothold_radius_cells;
  const std::int32_t disc = radius * radius + radius;  // (radius + 1/2)^2, rounded down
  const auto raise = static_cast<float>(config.foothold_max_raise_m);
  const auto drop = static_cast<float>(config.foothold_max_drop_m);
  std::int32_t unknown = 0;
  PlaneSums sums;
  for (std::int32_t dy = -radius; dy <= radius; ++dy) {
    for (std::int32_t dx = -radius; dx <= radius; ++dx) {
      if (dx * dx + dy * dy > disc) continue;
      const WindowCell& cell = cells_[at(x + dx, y + dy)];
      if (!cell.has_height()) {
        ++unknown;
        continue;
      }
      const float dz = cell.height_m - centre.height_m;
      if (dz > raise || dz < -drop) return FootholdClass::kNotSteppable;
      sums.add(dx, dy, static_cast<double>(dz));
    }
  }
  if (unknown > config.foothold_max_unknown) return FootholdClass::kUnknown;
  const double gradient2 = sums.gradient2();
  if (gradient2 < 0) return FootholdClass::kUnknown;
  const double limit = config.foothold_max_slope * config.cell_size_m;
  return gradient2 <= limit * limit ? FootholdClass::kSteppable : FootholdClass::kNotSteppable;
}

std::uint8_t WindowClassifier::margin(std::int32_t x, std::int32_t y) const {
  for (std::int32_t ring = 1; ring < kMaxMargin_cells; ++ring) {
    for (std::int32_t i = -ring; i <= ring; ++i) {
      const bool good = cells_[at(x + i, y - ring)].foothold == FootholdClass::kSteppable &&
                        cells_[at(x + i, y + ring)].foothold == FootholdClass::kSteppable &&
                        cells_[at(x - ring, y + i)].foothold == FootholdClass::kSteppable &&
                        cells_[at(x + ring, y + i)].foothold == FootholdClass::kSteppable;
      if (!good) return static_cast<std::uint8_t>(ring);
    }
  }
  return kMaxMargin_cells;
}

}  // namespace surefoot::mapping
