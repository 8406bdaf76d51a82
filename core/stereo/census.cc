#include "core/stereo/census.h"

#include <algorithm>
#include <utility>

namespace surefoot::stereo {

namespace {

struct Offset {
  std::int8_t u;
  std::int8_t v;
};

// The fields of one colour of the 7 x 7 board, without the centre.
constexpr std::array<Offset, 24> make_offsets() {
  std::array<Offset, 24> offsets{};
  std::size_t count = 0;
  for (int v = -3; v <= 3; ++v) {
    for (int u = -3; u <= 3; ++u) {
      if ((u != 0 || v != 0) && (u + v) % 2 == 0) {
        offsets[count++] = {static_cast<std::int8_t>(u), static_cast<std::int8_t>(v)};
      }
    }
  }
  return offsets;
}
constexpr std::array<Offset, 24> kOffsets = make_offsets();

// (4 centre + the four neighbours + 4) / 8 without leaving the byte: sums of halves would lose
// bits, so in 16-bit lanes.
Words weighted(Words centre, Words up, Words down, Words left, Words right) {
  return (4 * centre + up + down + left + right + 4) >> 3;
}

Bytes narrow(Words low, Words high) {
  return __builtin_shufflevector(std::bit_cast<Bytes>(low), std::bit_cast<Bytes>(high), 0, 2, 4, 6,
                                 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
}

Bytes smoothed(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below) {
  const Bytes centre = load_lanes(here);
  const Bytes up = load_lanes(above);
  const Bytes down = load_lanes(below);
  const Bytes left = load_lanes(here - 1);
  const Bytes right = load_lanes(here + 1);
  return narrow(weighted(widen_low(centre), widen_low(up), widen_low(down), widen_low(left),
                         widen_low(right)),
                weighted(widen_high(centre), widen_high(up), widen_high(down), widen_high(left),
                         widen_high(right)));
}

template <std::size_t kFirst, std::size_t... kBit>
Bytes census_byte(const CensusRow::RowPointers& rows, std::size_t u, Bytes centre,
                  std::index_sequence<kBit...>) {
  return ((mask_less(load_lanes(rows[static_cast<std::size_t>(kOffsets[kFirst + kBit].v + 3)] +
                                static_cast<std::ptrdiff_t>(u) + kOffsets[kFirst + kBit].u),
                     centre) &
           all_lanes<std::uint8_t>(1u << kBit)) |
          ...);
}

}  // namespace

void CensusRow::copy_row(const GreyView& image, std::ptrdiff_t v, std::size_t to) {
  const auto last = static_cast<std::ptrdiff_t>(image.height_px) - 1;
  const std::uint8_t* from =
      image.row(static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(v, 0, last)));
  std::uint8_t* row = rows_[to].data();
  std::fill_n(row, kRowPad, from[0]);
  std::copy_n(from, image.width_px, row + kRowPad);
  std::fill_n(row + kRowPad + image.width_px, 2 * kRowPad, from[image.width_px - 1]);
}

CensusRow::RowPointers CensusRow::row_pointers() const {
  RowPointers rows;
  for (std::size_t i = 0; i < kCensusRows; ++i) rows[i] = grey(static_cast<std::ptrdiff_t>(i) - 3);
  return rows;
}

void CensusRow::start(const GreyView& image) {
  middle_ = kCensusRadius_px - 1;
  for (std::size_t i = 0; i + 1 < kCensusRows; ++i) {
    copy_row(image, static_cast<std::ptrdiff_t>(i) - static_cast<std::ptrdiff_t>(kCensusRadius_px),
             i);
  }
}

void CensusRow::advance(const GreyView& image, std::size_t v) {
  middle_ = (middle_ + 1) % kCensusRows;
  copy_row(image, static_cast<std::ptrdiff_t>(v + kCensusRadius_px), slot(3));
  const RowPointers rows = row_pointers();
  constexpr auto kBits = std::make_index_sequence<8>();
  for (std::size_t u = 0; u < image.width_px; u += kBytes) {
    const Bytes centre = smoothed(rows[2] + u, rows[3] + u, rows[4] + u);
    store_lanes(census_byte<0>(rows, u, centre, kBits), planes_[0].data() + u);
    store_lanes(census_byte<8>(rows, u, centre, kBits), planes_[1].data() + u);
    store_lanes(census_byte<16>(rows, u, centre, kBits), planes_[2].data() + u);
  }
}

// Extremes of the columns of seven first, then of seven columns.
void CensusRow::contrast(std::size_t width_px, std::uint8_t* out) {
  const RowPointers rows = row_pointers();
  // From kRowPad before the first pixel: the pads hold copies of the outermost pixels.
  for (std::size_t u = 0; u < width_px + 2 * kRowPad; u += kBytes) {
    Bytes low = load_lanes(rows[0] - kRowPad + u);
    Bytes high = low;
    for (std::size_t i = 1; i < kCensusRows; ++i) {
      const Bytes grey = load_lanes(rows[i] - kRowPad + u);
      low = smaller(low, grey);
      high = larger(high, grey);
    }
    store_lanes(low, darkest_.data() + u);
    store_lanes(high, brightest_.data() + u);
  }
  for (std::size_t u = 0; u < width_px; u += kBytes) {
    const std::uint8_t* dark = darkest_.data() + kRowPad + u - kCensusRadius_px;
    const std::uint8_t* bright = brightest_.data() + kRowPad + u - kCensusRadius_px;
    Bytes low = load_lanes(dark);
    Bytes high = load_lanes(bright);
    for (std::size_t i = 1; i < kCensusRows; ++i) {
      low = smaller(low, load_lanes(dark + i));
      high = larger(high, load_lanes(bright + i));
    }
    store_lanes(high - low, out + u);
  }
}

}  // namespace surefoot::stereo
