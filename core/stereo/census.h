// Census of a picture, a row at a time: 24 bits a pixel say which of the neighbours on a 7 x 7
// checkerboard are darker than the smoothed centre. Insensitive to exposure and gain.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/stereo/byte_lanes.h"
#include "core/stereo/images.h"

namespace surefoot::stereo {

inline constexpr std::size_t kCensusRadius_px = 3;
inline constexpr std::size_t kCensusRows = 2 * kCensusRadius_px + 1;
inline constexpr std::size_t kCensusPlanes = 3;  // bytes per pixel, each a plane of its own
inline constexpr std::size_t kRowPad = kBytes;

// Eight bits of every pixel of a row.
using CensusPlane = std::array<std::uint8_t, kMaxWidth_px + kRowPad>;

class CensusRow {
 public:
  using RowPointers = std::array<const std::uint8_t*, kCensusRows>;

  // start(), then advance() for rows 0, 1, ... in turn. Beyond the border the picture continues
  // with its outermost pixels. Cost: O(width).
  void start(const GreyView& image);
  void advance(const GreyView& image, std::size_t v);

  const std::array<CensusPlane, kCensusPlanes>& planes() const { return planes_; }
  // Largest minus smallest grey of the 7 x 7 pixels around each of the present row; writes
  // width_px rounded up to whole lanes.
  void contrast(std::size_t width_px, std::uint8_t* out);
  // Row v + offset of the picture; offset -3 to 3.
  const std::uint8_t* grey(std::ptrdiff_t offset) const {
    return rows_[slot(offset)].data() + kRowPad;
  }

 private:
  std::size_t slot(std::ptrdiff_t offset) const {
    return (middle_ + kCensusRows + static_cast<std::size_t>(offset + 3) - kCensusRadius_px) %
           kCensusRows;
  }
  RowPointers row_pointers() const;
  void copy_row(const GreyView& image, std::ptrdiff_t v, std::size_t to);

  // The seven rows around the present one, padded at both ends.
  using PaddedRow = std::array<std::uint8_t, kMaxWidth_px + 3 * kRowPad>;
  std::array<PaddedRow, kCensusRows> rows_{};
  std::array<CensusPlane, kCensusPlanes> planes_{};
  PaddedRow darkest_{};
  PaddedRow brightest_{};
  std::size_t middle_ = 0;  // slot of the present row
};

}  // namespace surefoot::stereo
