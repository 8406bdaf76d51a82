// The cells one frame hits, each with the one height the frame gives it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/mapping/depth_image.h"
#include "core/mapping/height_map.h"

namespace surefoot::mapping {

inline constexpr std::size_t kMaxScanCells = kMaxPixels;

// The highest surface among a frame's points in one cell: points that agree with it (within the
// gate) are averaged with their inverse variances, lower ones are left out.
struct ScanCell {
  CellIndex index;
  double weight = 0;             // sum of 1 / variance
  double weighted_height = 0;    // sum of height / variance
  float shared_variance_m2 = 0;  // what averaging cannot reduce (attitude, floor): the largest

  double height_m() const { return weighted_height / weight; }
  double variance_m2() const { return 1.0 / weight + static_cast<double>(shared_variance_m2); }
};

// An open-addressing table keyed by the cell's index; cells are listed in the order of their first
// point, so the result does not depend on where the map is.
class ScanCells {
 public:
  void clear();
  // kExhausted: kMaxScanCells are in use, the point is left out.
  Status add(CellIndex index, double height_m, double variance_m2, double shared_variance_m2,
             double gate_sigma);
  std::size_t size() const { return size_; }
  const ScanCell& operator[](std::size_t i) const {
    SUREFOOT_ASSERT(i < size_);
    return cells_[i];
  }

 private:
  static constexpr std::size_t kSlots = 32768;
  static_assert(kSlots > kMaxScanCells && (kSlots & (kSlots - 1)) == 0);

  std::array<ScanCell, kMaxScanCells> cells_{};
  std::array<std::uint16_t, kSlots> slots_{};  // place in cells_ plus one; 0: free
  std::size_t size_ = 0;
};

}  // namespace surefoot::mapping
