#include "core/mapping/scan_cells.h"

#include <algorithm>
#include <cstring>

namespace surefoot::mapping {

void ScanCells::clear() {
  std::memset(slots_.data(), 0, sizeof(slots_));
  size_ = 0;
}

Status ScanCells::add(CellIndex index, double height_m, double variance_m2,
                      double shared_variance_m2, double gate_sigma) {
  const std::uint32_t key = static_cast<std::uint32_t>(index.ix) * 0x9E3779B1u ^
                            static_cast<std::uint32_t>(index.iy) * 0x85EBCA77u;
  std::size_t slot = (key ^ (key >> 15u)) & (kSlots - 1);
  while (slots_[slot] != 0 && !(cells_[slots_[slot] - 1u].index == index)) {
    slot = (slot + 1) & (kSlots - 1);  // ends: fewer cells than slots
  }
  const double weight = 1.0 / variance_m2;
  if (slots_[slot] == 0) {
    if (size_ == kMaxScanCells) return Status::kExhausted;
    cells_[size_] = {index, weight, weight * height_m, static_cast<float>(shared_variance_m2)};
    ++size_;
    slots_[slot] = static_cast<std::uint16_t>(size_);
    return Status::kOk;
  }
  ScanCell& cell = cells_[slots_[slot] - 1u];
  const double difference = height_m - cell.height_m();
  const double gate2 =
      gate_sigma * gate_sigma *
      (cell.variance_m2() + variance_m2 + static_cast<double>(cell.shared_variance_m2));
  if (difference * difference <= gate2) {
    cell.weight += weight;
    cell.weighted_height += weight * height_m;
    cell.shared_variance_m2 =
        std::max(cell.shared_variance_m2, static_cast<float>(shared_variance_m2));
  } else if (difference > 0) {  // a higher surface takes the cell
    cell.weight = weight;
    cell.weighted_height = weight * height_m;
    cell.shared_variance_m2 = static_cast<float>(shared_variance_m2);
  }
  return Status::kOk;
}

}  // namespace surefoot::mapping
