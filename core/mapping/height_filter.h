// Filters over a square grid of heights: opening with the elliptical kernel and Sobel gradients
// (paper 002, equations 4 to 6), bit-equal to OpenCV's morphologyEx(MORPH_OPEN) and Sobel with
// their default borders.
//
// Cells without a height are treated as OpenCV treats the cells outside of an image: they take part
// in no minimum and no maximum. The kernel is placed on them nevertheless, so a cell without height
// gets one from its neighbours (paper: "fill in sparse regions") as long as any of them has one.
//
// Minimum and maximum only select, so they are exact for any heights. Sobel adds: its sums are
// exact, whatever their order, for heights on the grid of on_filter_grid().
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/mapping/lanes.h"

namespace surefoot::mapping {

// Stands for "no height": +kNowhere_m where a minimum is taken, -kNowhere_m where a maximum is.
inline constexpr float kNowhere_m = 1e9F;
// Heights are below this in size (height_map.h), so that it tells the two apart.
inline constexpr float kLargestHeight_m = 5e8F;

// Rounded to whole 2^-14 m (0.06 mm) up to 128 m from O's origin: below what any sensor resolves,
// and eight such heights add without rounding. Never -0.
constexpr float on_filter_grid(float height_m) {
  constexpr float kShift_m = 768.0F;  // its last bit is worth 2^-14
  return height_m + kShift_m - kShift_m + 0.0F;
}

// A grid with a margin around it, so that no filter needs to ask where the grid ends.
template <class Cell, std::int32_t kSide>
class PaddedGrid {
  static_assert(sizeof(Cell) == 4);
  static_assert(kSide % kLanes == 0);

 public:
  static constexpr std::int32_t kReach = 2;  // of the kernel
  static constexpr std::int32_t kPad = kLanes;
  static constexpr std::int32_t stride() { return kSide + 2 * kPad; }

  // Every cell and the margin.
  void fill(Cell value) { cells_.fill(value); }
  // y in [-kReach, kSide + kReach); from the pointer, x in [-kPad, kSide + kPad).
  Cell* row(std::int32_t y) { return cells_.data() + place(y); }
  const Cell* row(std::int32_t y) const { return cells_.data() + place(y); }

 private:
  static std::size_t place(std::int32_t y) {
    const std::int32_t index = (y + kReach) * stride() + kPad;
    return static_cast<std::size_t>(index);
  }
  std::array<Cell, static_cast<std::size_t>(kSide + 2 * kReach) * stride()> cells_{};
};

template <std::int32_t kSide>
using FilterGrid = PaddedGrid<float, kSide>;

// Cells [x_begin, x_end) x [y_begin, y_end).
struct CellRect {
  std::int32_t x_begin = 0;
  std::int32_t x_end = 0;
  std::int32_t y_begin = 0;
  std::int32_t y_end = 0;

  constexpr bool empty() const { return x_begin >= x_end || y_begin >= y_end; }
  // Grown by `cells` on all sides and, in x, to whole lanes; not beyond the grid.
  constexpr CellRect grown(std::int32_t cells, std::int32_t side) const {
    if (empty()) return {};
    const std::int32_t x_low = std::max(x_begin - cells, 0);
    return {x_low - x_low % kLanes, std::min((x_end + cells + kLanes - 1) / kLanes * kLanes, side),
            std::max(y_begin - cells, 0), std::min(y_end + cells, side)};
  }
};

struct Erosion {
  static constexpr float kNeutral = kNowhere_m;  // for the margin of the grid it reads
  static Lanes combine(Lanes a, Lanes b) { return smaller(a, b); }
  static LaneMask found_nothing(Lanes a) { return a > all_lanes(kLargestHeight_m); }
};
struct Dilation {
  static constexpr float kNeutral = -kNowhere_m;
  static Lanes combine(Lanes a, Lanes b) { return larger(a, b); }
  static LaneMask found_nothing(Lanes a) { return a < all_lanes(-kLargestHeight_m); }
};
// Cells that are not one of the numbers above: how many of the kernel's cells hold a one.
struct Sum {
  static constexpr float kNeutral = 0;
  static Lanes combine(Lanes a, Lanes b) { return a + b; }
};

// What follows: the same filter again or a picture of the result, or the opposite one, for which
// cells where nothing was found must change sides.
enum class Next : std::uint8_t { kAny, kOpposite };

// Kernel of equation (4): three rows of five and one cell above and below. `rect` in whole lanes;
// reads two cells around it.
template <class Filter, Next kNext, std::int32_t kSide>
void apply_kernel(const FilterGrid<kSide>& in, FilterGrid<kSide>& out, const CellRect& rect) {
  constexpr std::int32_t kStride = FilterGrid<kSide>::stride();
  const auto five = [](const float* centre, Lanes middle) {
    const Lanes left = Filter::combine(load_lanes(centre - 2), load_lanes(centre - 1));
    const Lanes right = Filter::combine(load_lanes(centre + 1), load_lanes(centre + 2));
    return Filter::combine(Filter::combine(left, right), middle);
  };
  for (std::int32_t x = rect.x_begin; x < rect.x_end; x += kLanes) {
    const float* from = in.row(rect.y_begin - 2) + x;
    float* to = out.row(rect.y_begin) + x;
    // Centres of the five rows above each other, and the rows' fives.
    Lanes top = load_lanes(from);
    Lanes upper = load_lanes(from + kStride);
    Lanes centre = load_lanes(from + 2 * kStride);
    Lanes lower = load_lanes(from + 3 * kStride);
    Lanes upper_five = five(from + kStride, upper);
    Lanes centre_five = five(from + 2 * kStride, centre);
    from += 3 * kStride;
    for (std::int32_t y = rect.y_begin; y < rect.y_end; ++y) {
      const Lanes lower_five = five(from, lower);
      from += kStride;
      const Lanes bottom = load_lanes(from);
      const Lanes ends = Filter::combine(top, bottom);
      const Lanes rows = Filter::combine(upper_five, Filter::combine(centre_five, lower_five));
      Lanes result = Filter::combine(ends, rows);
      if constexpr (kNext == Next::kOpposite) {
        constexpr auto kSign = static_cast<std::int32_t>(0x80000000U);
        result = from_bits(bits(result) ^ (Filter::found_nothing(result) & kSign));
      }
      store_lanes(result, to);
      to += kStride;
      top = upper;
      upper = centre;
      centre = lower;
      lower = bottom;
      upper_five = centre_five;
      centre_five = lower_five;
    }
  }
}

namespace detail {

// Cell outside of the grid, as OpenCV's BORDER_REFLECT_101 does.
template <std::int32_t kSide>
constexpr std::int32_t reflect(std::int32_t i) {
  if (i < 0) return -i;
  return i < kSide ? i : 2 * kSide - 2 - i;
}

template <std::int32_t kSide>
float gradient_at(const FilterGrid<kSide>& in, std::int32_t x, std::int32_t y) {
  const float* rows[3] = {in.row(reflect<kSide>(y - 1)), in.row(y), in.row(reflect<kSide>(y + 1))};
  const std::int32_t left = reflect<kSide>(x - 1);
  const std::int32_t right = reflect<kSide>(x + 1);
  const auto across = [&](const float* row) { return row[right] - row[left]; };
  const auto along = [&](const float* row) { return row[left] + row[right] + 2.0F * row[x]; };
  const float gx = across(rows[0]) + across(rows[2]) + 2.0F * across(rows[1]);
  const float gy = along(rows[2]) - along(rows[0]);
  return std::max(gx < 0 ? -gx : gx, gy < 0 ? -gy : gy);
}

}  // namespace detail

// Gradient map: the larger magnitude of the two Sobel gradients, equations (5) and (6). A plane of
// slope s along x or y gives 8 s times the cell's side, a step of height h between two cells 4 h in
// both. `rect` in whole lanes; reads one cell around it.
template <std::int32_t kSide>
void gradient(const FilterGrid<kSide>& in, FilterGrid<kSide>& out, const CellRect& rect) {
  struct Row {
    Lanes across;
    Lanes along;
  };
  const auto read = [&in](std::int32_t y, std::int32_t x) {
    const float* row = in.row(detail::reflect<kSide>(y)) + x;
    const Lanes left = load_lanes(row - 1);
    const Lanes right = load_lanes(row + 1);
    const Lanes middle = load_lanes(row);
    return Row{right - left, left + right + (middle + middle)};
  };
  for (std::int32_t x = rect.x_begin; x < rect.x_end; x += kLanes) {
    Row above = read(rect.y_begin - 1, x);
    Row here = read(rect.y_begin, x);
    for (std::int32_t y = rect.y_begin; y < rect.y_end; ++y) {
      const Row below = read(y + 1, x);
      const Lanes gx = above.across + below.across + (here.across + here.across);
      const Lanes gy = below.along - above.along;
      store_lanes(larger(magnitude(gx), magnitude(gy)), out.row(y) + x);
      above = here;
      here = below;
    }
  }
  // The margin is no mirror: the outermost columns again.
  for (std::int32_t y = rect.y_begin; y < rect.y_end; ++y) {
    if (rect.x_begin == 0) out.row(y)[0] = detail::gradient_at(in, 0, y);
    if (rect.x_end == kSide) out.row(y)[kSide - 1] = detail::gradient_at(in, kSide - 1, y);
  }
}

}  // namespace surefoot::mapping
