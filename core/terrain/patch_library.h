// The library of fully known terrain that patches are drawn from, in fixed memory, with the origin
// of every piece.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/fixed_vector.h"
#include "core/base/random.h"
#include "core/base/status.h"
#include "core/terrain/table_index.h"

namespace surefoot::terrain {

inline constexpr std::size_t kMaxLibraryCells = 400'000;  // ten square metres of 5 mm cells
inline constexpr std::size_t kMaxPieces = 32;
inline constexpr std::int32_t kMaxPatch_cells = 15;

// Where a piece comes from: enough to find or make it again.
struct Provenance {
  std::array<char, 32> source{};  // name of the generator or of the recording, zero-terminated
  std::uint64_t seed = 0;         // or number within the recording
};

struct Piece {
  Provenance provenance;
  std::int32_t columns = 0;
  std::int32_t rows = 0;
  std::size_t begin = 0;     // of its heights
  std::uint64_t digest = 0;  // Fnv64 of the heights' bits
};

class PatchLibrary {
 public:
  // Forgets all pieces. Patches of patch_cells (odd, 3..kMaxPatch_cells) will be drawn.
  // kInvalid: patch_cells or cell_m (1 mm..1 m) is out of range; nothing changed.
  Status reset(double cell_m, std::int32_t patch_cells);

  // Heights row by row, x fastest, any datum: only differences within a patch count.
  // On error nothing changed. kInvalid: fewer heights than columns * rows, or one of them not
  // finite. kOutOfRange: cell_m differs from the library's, or the piece is smaller than a patch.
  // kExhausted: no room for it. kUnavailable: reset() was never called.
  Status add(const Provenance& provenance, std::int32_t columns, std::int32_t rows, double cell_m,
             std::span<const float> heights_m);

  double cell_m() const { return cell_m_; }
  std::int32_t patch_cells() const { return patch_cells_; }
  std::size_t pieces() const { return pieces_.size(); }
  const Piece& piece(std::size_t i) const { return pieces_[i]; }
  float height_m(const Piece& piece, std::int32_t column, std::int32_t row) const {
    return heights_m_[piece.begin + table_index(column, row, piece.columns)];
  }
  // How many different patches there are.
  std::uint32_t patches() const { return patches_; }

  // A patch: its first height, then rows `pitch` apart. At least 16 floats from every row's begin
  // may be read, of which the first patch_cells belong to the patch.
  struct Patch {
    const float* corner = nullptr;
    std::int32_t pitch = 0;
  };
  // Uniform over all patches; patches() > 0.
  Patch draw(Random& random) const;

 private:
  double cell_m_ = 0;
  std::int32_t patch_cells_ = 0;
  std::uint32_t patches_ = 0;
  std::size_t used_ = 0;
  FixedVector<Piece, kMaxPieces> pieces_;
  std::array<std::uint32_t, kMaxPieces> last_patch_{};  // sums: patches up to and with a piece
  // Where the search for a patch's piece begins, by the high bits of its number: draw() is half of
  // the time of a fill with small patches.
  static constexpr std::size_t kHints = 256;
  std::uint32_t hint_shift_ = 0;
  std::array<std::uint8_t, kHints> hint_{};
  std::array<float, kMaxLibraryCells + 16> heights_m_{};
};

}  // namespace surefoot::terrain
