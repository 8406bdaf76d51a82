// The cells one frame hits, each with the one height the frame gives it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/assert.h"
#include "core/base/status.h"
#include "core/mapping/depth_image.h"
#include "core/mapping/integration.h"

namespace surefoot::mapping {

inline constexpr std::size_t kMaxScanCells = kMaxPixels;

// One point as its cell sees it.
struct CellPoint {
  double height_m = 0;
  double variance_m2 = 0;         // its own
  double weight = 0;              // 1 / variance
  double shared_variance_m2 = 0;  // what averaging cannot reduce (attitude, floor)
};

// The highest surface among a frame's points in one cell: points that agree with it (within the
// gate) are averaged with their inverse variances, lower ones are left out.
struct ScanCell {
  std::uint32_t place = 0;       // in the map's square: column + row * kMapSide
  float shared_variance_m2 = 0;  // the largest
  double weight = 0;             // sum of 1 / variance
  double weighted_height = 0;    // sum of height / variance

  double height_m() const { return weighted_height / weight; }
  double variance_m2() const { return 1.0 / weight + static_cast<double>(shared_variance_m2); }
};

// A table with an entry for each cell of the map's square. Cells are listed in the order of their
// first point.
class ScanCells {
 public:
  // Cost: one entry per cell listed.
  void clear() {
    for (std::size_t i = 0; i < size_; ++i) entries_[cells_[i].place] = 0;
    size_ = 0;
  }
  // kExhausted: kMaxScanCells are in use, the point is left out. gate2: squared, in sigma.
  Status add(std::uint32_t place, const CellPoint& point, double gate2) {
    std::uint16_t& entry = entries_[place];
    if (entry != 0) {
      combine(point, gate2, cells_[entry - 1u]);
      return Status::kOk;
    }
    if (size_ == kMaxScanCells) return Status::kExhausted;
    ScanCell& cell = cells_[size_++];
    cell.place = place;
    take(point, cell);
    entry = static_cast<std::uint16_t>(size_);
    return Status::kOk;
  }
  std::size_t size() const { return size_; }
  const ScanCell& operator[](std::size_t i) const {
    SUREFOOT_ASSERT(i < size_);
    return cells_[i];
  }

 private:
  static_assert(kMaxScanCells <= 65535);

  static void take(const CellPoint& point, ScanCell& cell) {
    cell.weight = point.weight;
    cell.weighted_height = point.weight * point.height_m;
    cell.shared_variance_m2 = static_cast<float>(point.shared_variance_m2);
  }
  // difference^2 <= gate^2 (variance of the cell + variance of the point), times weight^2 of the
  // cell, which spares two divisions. What points of the cell have in common counts for both.
  static void combine(const CellPoint& point, double gate2, ScanCell& cell) {
    const double weight = cell.weight;
    const double difference = point.height_m * weight - cell.weighted_height;
    const double common = 2.0 * static_cast<double>(cell.shared_variance_m2);
    const double bound = gate2 * (weight + weight * weight * (point.variance_m2 + common));
    if (difference * difference <= bound) {
      cell.weight += point.weight;
      cell.weighted_height += point.weight * point.height_m;
      cell.shared_variance_m2 =
          std::max(cell.shared_variance_m2, static_cast<float>(point.shared_variance_m2));
    } else if (difference > 0) {  // a higher surface takes the cell
      take(point, cell);
    }
  }

  std::array<ScanCell, kMaxScanCells> cells_{};
  // Place in cells_ plus one; 0: not hit.
  std::array<std::uint16_t, static_cast<std::size_t>(kMapSide) * kMapSide> entries_{};
  std::size_t size_ = 0;
};

}  // namespace surefoot::mapping
