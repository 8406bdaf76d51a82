#include "core/terrain/patch_library.h"

#include <bit>

#include "core/base/hash.h"
#include "core/math/elementary.h"

namespace surefoot::terrain {

Status PatchLibrary::reset(double cell_m, std::int32_t patch_cells) {
  const bool patch = patch_cells >= 3 && patch_cells <= kMaxPatch_cells && patch_cells % 2 == 1;
  if (!patch || !(cell_m >= 0.001 && cell_m <= 1.0)) return Status::kInvalid;
  cell_m_ = cell_m;
  patch_cells_ = patch_cells;
  patches_ = 0;
  used_ = 0;
  pieces_.clear();
  return Status::kOk;
}

Status PatchLibrary::add(const Provenance& provenance, std::int32_t columns, std::int32_t rows,
                         double cell_m, std::span<const float> heights_m) {
  if (patch_cells_ == 0) return Status::kUnavailable;
  if (columns < patch_cells_ || rows < patch_cells_ || !same_cell_size(cell_m, cell_m_)) {
    return Status::kOutOfRange;
  }
  const std::uint64_t cells =
      static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows);
  if (pieces_.full() || cells > kMaxLibraryCells - used_) return Status::kExhausted;
  if (heights_m.size() < cells) return Status::kInvalid;
  Fnv64 hash;
  for (std::size_t i = 0; i < cells; ++i) {
    if (!math::is_finite(static_cast<double>(heights_m[i]))) return Status::kInvalid;
    hash.word(std::bit_cast<std::uint32_t>(heights_m[i]), 4);
  }
  for (std::size_t i = 0; i < cells; ++i) heights_m_[used_ + i] = heights_m[i];
  const std::size_t number = pieces_.size();
  const Status status = pieces_.push_back({provenance, columns, rows, used_, hash.value()});
  SUREFOOT_ASSERT(ok(status));
  used_ += cells;
  patches_ += static_cast<std::uint32_t>((columns - patch_cells_ + 1) * (rows - patch_cells_ + 1));
  last_patch_[number] = patches_;
  hint_shift_ = 0;
  while ((patches_ >> hint_shift_) >= kHints) ++hint_shift_;
  std::size_t first = 0;
  for (std::size_t k = 0; k < kHints; ++k) {
    while (first < number && (k << hint_shift_) >= last_patch_[first]) ++first;
    hint_[k] = static_cast<std::uint8_t>(first);
  }
  return Status::kOk;
}

PatchLibrary::Patch PatchLibrary::draw(Random& random) const {
  SUREFOOT_ASSERT(patches_ > 0);
  std::uint32_t number = random.below(patches_);
  std::size_t i = hint_[number >> hint_shift_];
  while (number >= last_patch_[i]) ++i;
  if (i > 0) number -= last_patch_[i - 1];
  const Piece& piece = pieces_[i];
  const auto across = static_cast<std::uint32_t>(piece.columns - patch_cells_ + 1);
  const std::size_t row = number / across;
  const std::size_t column = number % across;
  return {&heights_m_[piece.begin + row * static_cast<std::size_t>(piece.columns) + column],
          piece.columns};
}

}  // namespace surefoot::terrain
