// A point cloud for alignment: not the points but, cell by cell, their sums, in a pyramid of four
// cell sizes. This is the coarse model of paper 001, section II; the fine one that feet are placed
// on is core/mapping's.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/base/status.h"
#include "core/math/elementary.h"
#include "core/math/linear.h"
#include "core/registration/moments.h"

namespace surefoot::registration {

inline constexpr int kLevels = 4;                       // cell sizes h, 2 h, 4 h, 8 h
inline constexpr std::size_t kMaxFineCells = 16384;     // of the finest level
inline constexpr std::size_t kMaxCells = 24576;         // of all levels
inline constexpr std::size_t kMaxBlocks = 12288;        // of 4 x 4 x 4 cells, all levels
inline constexpr std::int32_t kMaxCellIndex = 1 << 20;  // of the finest level, either side of 0

// Cells of a block of 4 x 4 x 4, one bit each, by which of the four places along an axis are wanted
// (four bits).
using BlockMasks = std::array<std::uint64_t, 16>;
constexpr BlockMasks block_masks(std::uint32_t shift_of_axis) {
  BlockMasks out{};
  for (std::uint32_t wanted = 0; wanted < 16; ++wanted) {
    for (std::uint32_t cell = 0; cell < 64; ++cell) {
      const std::uint64_t bit = (wanted >> ((cell >> shift_of_axis) & 3u)) & 1u;
      out[wanted] |= bit << cell;
    }
  }
  return out;
}
inline constexpr BlockMasks kAlongX = block_masks(0);
inline constexpr BlockMasks kAlongY = block_masks(2);
inline constexpr BlockMasks kAlongZ = block_masks(4);

struct CellPlace {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t z = 0;
};

// A piece of surface: what stands for a cell and its neighbours.
struct Surfel {
  Vector3 position_m = Vector3::Zero();
  Vector3 normal = Vector3::UnitZ();  // either side
  double variance_m2 = 0;             // of position_m along the normal
  double tilt_variance_rad2 = 0;      // of the normal, per tangent direction
  double overlap = 1;  // points it was made from, per point of its own cell: how much it shares
};

class Cloud {
 public:
  // Empties the cloud. kInvalid: cell_m is not above 0 or not finite; nothing changed.
  Status reset(double cell_m);

  // Writes every page, so that no later call meets one for the first time. Empties the cloud.
  void touch();

  // Not after finish(). kInvalid: not finite. kOutOfRange: beyond kMaxCellIndex cells.
  // kExhausted: it needs a cell and there is none left. The cloud is unchanged then, but for
  // dropped_points(). Points of the same cells may come in any number.
  Status add(const Vector3& p_m);

  // Sums the coarse levels up. To be called after the last add() and before the cloud is read.
  // kExhausted: no room for all coarse cells; those that fit are there.
  Status finish();

  double cell_m(int level) const { return cell_m_[static_cast<std::size_t>(level)]; }
  std::size_t point_count() const { return points_; }
  std::size_t dropped_points() const { return dropped_; }
  // Cells of `level` are first_cell(level) to first_cell(level + 1), in the order of their first
  // point.
  std::size_t first_cell(int level) const { return first_[static_cast<std::size_t>(level)]; }

  // The cell's number, kNone where there is no point.
  static constexpr std::uint16_t kNone = 0xFFFF;
  std::uint16_t find(int level, const CellPlace& place) const;
  // Calls visit(cell) for the cells with points of the 3 x 3 x 3 around `place`, at most 27, in an
  // order that depends on nothing but `place`.
  template <class Visit>
  void for_neighbours(int level, const CellPlace& place, Visit&& visit) const {
    const Span x = span(place.x);
    const Span y = span(place.y);
    const Span z = span(place.z);
    for (std::int32_t bz = z.first_block; bz <= z.last_block; ++bz) {
      for (std::int32_t by = y.first_block; by <= y.last_block; ++by) {
        for (std::int32_t bx = x.first_block; bx <= x.last_block; ++bx) {
          const std::uint16_t block = find_block(block_key(level, {bx, by, bz}));
          if (block == kNoBlock) continue;
          std::uint64_t cells = occupied_[block] & kAlongX[x.inside(bx)] & kAlongY[y.inside(by)] &
                                kAlongZ[z.inside(bz)];
          for (; cells != 0; cells &= cells - 1) {
            visit(blocks_[block][static_cast<std::size_t>(std::countr_zero(cells))]);
          }
        }
      }
    }
  }
  CellPlace place_of(int level, const Vector3& p_m) const {
    const double scale = cells_per_m_[static_cast<std::size_t>(level)];
    return {math::floor_of(p_m.x() * scale), math::floor_of(p_m.y() * scale),
            math::floor_of(p_m.z() * scale)};
  }

  const Vector3& mean_m(std::size_t cell) const { return means_m_[cell]; }
  // Known to have none: surfel() would give null.
  bool has_no_surface(std::size_t cell) const { return surfaces_[cell] == Surface::kNone; }
  // Null where the points around the cell are too few or do not lie in a plane. Computed when first
  // asked for. Cost: 27 cells are looked up and a plane is fitted.
  const Surfel* surfel(int level, std::size_t cell);

 private:
  static constexpr std::size_t kSlots = 32768;
  static_assert(kSlots > 2 * kMaxBlocks && (kSlots & (kSlots - 1)) == 0);
  static constexpr std::int32_t kSide = 4;
  static constexpr std::uint16_t kNoBlock = 0xFFFF;

  enum class Surface : std::uint8_t { kUnasked, kPlane, kNone };
  struct Cell {
    Moments moments;  // about the centre of the cell
    CellPlace place;
  };
  using Block = std::array<std::uint16_t, kSide * kSide * kSide>;

  // Along one axis: the blocks that the three cells around one lie in, and where in them.
  struct Span {
    std::int32_t first_block = 0;
    std::int32_t last_block = 0;
    std::uint32_t three = 0;  // bits of the three cells in two blocks

    std::size_t inside(std::int32_t block) const {
      return (three >> (block == first_block ? 0u : 4u)) & 0xFu;
    }
  };
  static Span span(std::int32_t cell) {
    const std::int32_t first = cell - 1;
    return {first >> 2, (cell + 1) >> 2, 7u << static_cast<std::uint32_t>(first & 3)};
  }
  static std::uint64_t block_key(int level, const CellPlace& block) {
    const auto part = [](std::int32_t index) {
      return static_cast<std::uint64_t>(static_cast<std::uint32_t>(index) & 0xFFFFFu);
    };
    const std::uint64_t key = static_cast<std::uint64_t>(level) << 20u | part(block.x);
    return (key << 20u | part(block.y)) << 20u | part(block.z);
  }
  static CellPlace block_of(const CellPlace& place) {
    return {place.x >> 2, place.y >> 2, place.z >> 2};
  }
  static std::size_t place_in_block(const CellPlace& place) {
    return static_cast<std::size_t>((place.x & 3) | (place.y & 3) << 2 | (place.z & 3) << 4);
  }
  static std::size_t first_slot(std::uint64_t key) {
    return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ull) >> 49u);
  }
  std::uint16_t find_block(std::uint64_t key) const {
    std::size_t slot = first_slot(key);
    while (slots_[slot] != 0) {
      const auto block = static_cast<std::uint16_t>(slots_[slot] - 1u);
      if (keys_[block] == key) return block;
      slot = (slot + 1) & (kSlots - 1);
    }
    return kNoBlock;
  }
  // The cell there, made if need be; kNone: no room.
  std::uint16_t obtain(int level, const CellPlace& place, std::size_t limit);
  Vector3 centre_m(int level, const CellPlace& place) const {
    const double size_m = cell_m(level);
    return {(place.x + 0.5) * size_m, (place.y + 0.5) * size_m, (place.z + 0.5) * size_m};
  }
  // Adds the cells of `level` to those of the next. False: not all found room.
  bool sum_up(int level);
  void make_surfel(int level, std::size_t cell);

  std::array<double, kLevels> cell_m_{};
  std::array<double, kLevels> cells_per_m_{};
  bool finished_ = false;
  std::size_t points_ = 0;
  std::size_t dropped_ = 0;
  std::size_t cell_count_ = 0;
  std::size_t block_count_ = 0;
  std::array<std::size_t, kLevels + 1> first_{};
  std::array<Cell, kMaxCells> cells_{};
  std::array<Vector3, kMaxCells> means_m_{};
  std::array<Surface, kMaxCells> surfaces_{};
  std::array<Surfel, kMaxCells> surfels_{};
  std::array<std::uint64_t, kMaxBlocks> keys_{};
  std::array<std::uint64_t, kMaxBlocks> occupied_{};  // which cells of a block there are
  std::array<Block, kMaxBlocks> blocks_{};
  std::array<std::uint16_t, kSlots> slots_{};  // block number plus one; 0: free
};

}  // namespace surefoot::registration
