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

#include "core/math/lanes.h"

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
  static_assert(kSide % 2 == 0 && kSide >= kByteLanes);

 public:
  static constexpr std::int32_t kReach = 2;  // of the kernel
  static constexpr std::int32_t kPad = kShortLanes;
  static constexpr std::int32_t stride() {
    return (kSide + kShortLanes - 1) / kShortLanes * kShortLanes + 2 * kPad;
  }

  // Every cell and the margin.
  void fill(Cell value) { cells_.fill(value); }
  // y in [-kReach, kSide + kReach); from the pointer, x in [-kPad, kSide + kPad).
  Cell* row(std::int32_t y) { return cells_.data() + place(y); }
  const Cell* row(std::int32_t y) const { return cells_.data() + place(y); }
  // Gives the margin that the kernel reaches the values of the outermost cells.
  void repeat_border() {
    for (std::int32_t y = 0; y < kSide; ++y) {
      std::fill_n(row(y) - kReach, kReach, row(y)[0]);
      std::fill_n(row(y) + kSide, kReach, row(y)[kSide - 1]);
    }
    for (std::int32_t i = 1; i <= kReach; ++i) {
      std::copy_n(row(0) - kReach, kSide + 2 * kReach, row(-i) - kReach);
      std::copy_n(row(kSide - 1) - kReach, kSide + 2 * kReach, row(kSide - 1 + i) - kReach);
    }
  }

 private:
  static std::size_t place(std::int32_t y) {
    const std::int32_t index = (y + kReach) * stride() + kPad;
    return static_cast<std::size_t>(index);
  }
  alignas(16) std::array<Cell, static_cast<std::size_t>(kSide + 2 * kReach) * stride()> cells_{};
};

// Cells [x_begin, x_end) x [y_begin, y_end).
struct CellRect {
  std::int32_t x_begin = 0;
  std::int32_t x_end = 0;
  std::int32_t y_begin = 0;
  std::int32_t y_end = 0;

  constexpr bool empty() const { return x_begin >= x_end || y_begin >= y_end; }
  // Grown by `cells` on all sides and to whole lanes and pairs of rows; not beyond the grid.
  constexpr CellRect grown(std::int32_t cells, std::int32_t side) const {
    if (empty()) return {};
    const auto down = [cells](std::int32_t i, std::int32_t multiple) {
      return std::max(i - cells, 0) / multiple * multiple;
    };
    const auto up = [cells, side](std::int32_t i, std::int32_t multiple) {
      return std::min((i + cells + multiple - 1) / multiple * multiple, side);
    };
    return {down(x_begin, kShortLanes), up(x_end, kShortLanes), down(y_begin, 2), up(y_end, 2)};
  }
};

// Calls visit(x) for every group of `kCount` cells that a row of `rect` needs. Where the grid ends
// within a group the last one begins earlier: some cells are computed twice, to the same result.
template <std::int32_t kCount, std::int32_t kSide, class Visit>
[[gnu::always_inline]] inline void for_lanes(const CellRect& rect, Visit&& visit) {
  for (std::int32_t x = rect.x_begin; x < rect.x_end; x += kCount) {
    visit(std::min(x, kSide - kCount));
  }
}

struct Erosion {
  template <class Numbers>
  static Numbers combine(Numbers a, Numbers b) {
    return smaller(a, b);
  }
};
struct Dilation {
  template <class Numbers>
  static Numbers combine(Numbers a, Numbers b) {
    return larger(a, b);
  }
};
struct Sum {
  template <class Numbers>
  static Numbers combine(Numbers a, Numbers b) {
    return sum(a, b);
  }
};

// Kernel of equation (4): three rows of five and one cell above and below. Calls
// store(x, y, lanes) for all of `rect`, two rows at a time; reads two cells around it.
template <class Filter, class Number, std::int32_t kSide, class Store>
void apply_kernel(const PaddedGrid<Number, kSide>& in, const CellRect& rect, Store&& store) {
  using Numbers = typename LanesOf<Number>::Type;
  constexpr std::int32_t kStride = PaddedGrid<Number, kSide>::stride();
  const auto combine = [](Numbers a, Numbers b) { return Filter::combine(a, b); };
  const auto five = [&combine](const Number* centre, Numbers middle) {
    const Numbers left = combine(load_lanes(centre - 2), load_lanes(centre - 1));
    const Numbers right = combine(load_lanes(centre + 1), load_lanes(centre + 2));
    return combine(combine(left, right), middle);
  };
  for_lanes<16 / sizeof(Number), kSide>(rect, [&](std::int32_t x) {
    const Number* from = in.row(rect.y_begin) + x;
    // Centres of the rows y - 2 to y + 1 (a to d), and the fives of the rows y - 1 and y.
    Numbers a = load_lanes(from - 2 * kStride);
    Numbers b = load_lanes(from - kStride);
    Numbers c = load_lanes(from);
    Numbers d = load_lanes(from + kStride);
    Numbers upper = five(from - kStride, b);
    Numbers lower = five(from, c);
    // Two rows; the new centres take the place of the first two.
    const auto advance = [&](std::int32_t y, Numbers& first, Numbers& second, Numbers below) {
      const Numbers next = five(from + kStride, below);
      const Numbers both = combine(lower, next);
      const Numbers centre = load_lanes(from + 2 * kStride);
      store(x, y, combine(combine(upper, both), combine(first, centre)));
      first = centre;
      upper = next;
      lower = five(from + 2 * kStride, centre);
      const Numbers last = load_lanes(from + 3 * kStride);
      store(x, y + 1, combine(combine(both, lower), combine(second, last)));
      second = last;
      from += 2 * kStride;
    };
    for (std::int32_t y = rect.y_begin; y < rect.y_end; y += 4) {
      advance(y, a, b, d);
      if (y + 2 >= rect.y_end) break;
      advance(y + 2, c, d, b);
    }
  });
}

// a + 2 b + c
template <class Numbers>
Numbers weighted(Numbers a, Numbers b, Numbers c) {
  return sum(sum(a, c), sum(b, b));
}

// Gradient map: the larger magnitude of the two Sobel gradients, equations (5) and (6). A plane of
// slope s along x or y gives 8 s times the cell's side, a step of height h between two cells 4 h in
// both. Beyond the grid the cells are mirrored, as by OpenCV's BORDER_REFLECT_101. Reads one cell
// around `rect`.
template <class Number, class Magnitude, std::int32_t kSide>
void gradient(const PaddedGrid<Number, kSide>& in, PaddedGrid<Magnitude, kSide>& out,
              const CellRect& rect) {
  using Numbers = typename LanesOf<Number>::Type;
  constexpr std::int32_t kStride = PaddedGrid<Number, kSide>::stride();
  const auto mirrored = [&in](std::int32_t y) {
    return in.row(y < 0 ? 1 : (y < kSide ? y : kSide - 2));
  };
  const auto across = [](const Number* row, Numbers left, Numbers right) {
    return weighted(left, load_lanes(row), right);
  };
  for_lanes<16 / sizeof(Number), kSide>(rect, [&](std::int32_t x) {
    const Number* row = mirrored(rect.y_begin - 1) + x;
    Numbers left = load_lanes(row - 1);
    Numbers right = load_lanes(row + 1);
    Numbers above = across(row, left, right);
    row = in.row(rect.y_begin) + x;
    // Sums of two rows: two of them make a column's 1 : 2 : 1.
    Numbers left2 = sum(left, load_lanes(row - 1));
    Numbers right2 = sum(right, load_lanes(row + 1));
    left = load_lanes(row - 1);
    right = load_lanes(row + 1);
    Numbers here = across(row, left, right);
    Magnitude* to = out.row(rect.y_begin) + x;
    // One row, from the one below it; that takes the place of the one above.
    const auto advance = [&](const Number* below, Numbers& across_above) {
      const Numbers new_left = load_lanes(below - 1);
      const Numbers new_right = load_lanes(below + 1);
      const Numbers new_left2 = sum(left, new_left);
      const Numbers new_right2 = sum(right, new_right);
      const Numbers new_across = across(below, new_left, new_right);
      store_lanes(larger(distance(sum(right2, new_right2), sum(left2, new_left2)),
                         distance(new_across, across_above)),
                  to);
      across_above = new_across;
      left = new_left;
      right = new_right;
      left2 = new_left2;
      right2 = new_right2;
      to += kStride;
    };
    for (std::int32_t y = rect.y_begin; y < rect.y_end; y += 2) {
      row += kStride;
      advance(row, above);
      row = y + 2 < kSide ? row + kStride : mirrored(kSide) + x;
      advance(row, here);
    }
  });
  // The margin is no mirror: the outermost columns again. Along x they have no gradient.
  for (std::int32_t y = rect.y_begin; y < rect.y_end; ++y) {
    const Number* above = mirrored(y - 1);
    const Number* below = mirrored(y + 1);
    const auto along_y = [above, below](std::int32_t border, std::int32_t inner) {
      const auto rise = below[border] - above[border] + (below[inner] - above[inner]);
      return static_cast<Magnitude>(2 * (rise < 0 ? -rise : rise));
    };
    if (rect.x_begin == 0) out.row(y)[0] = along_y(0, 1);
    if (rect.x_end == kSide) out.row(y)[kSide - 1] = along_y(kSide - 1, kSide - 2);
  }
}

// Four times the height of edges: the larger magnitude of the rises over four cells along x and
// along y, each of three lines weighted as Sobel's. Reads two cells around `rect`.
template <class Number, class Magnitude, std::int32_t kSide>
void edges(const PaddedGrid<Number, kSide>& in, PaddedGrid<Magnitude, kSide>& out,
           const CellRect& rect) {
  using Numbers = typename LanesOf<Number>::Type;
  constexpr std::int32_t kStride = PaddedGrid<Number, kSide>::stride();
  const auto across = [](const Number* row) {
    return weighted(load_lanes(row - 1), load_lanes(row), load_lanes(row + 1));
  };
  for_lanes<16 / sizeof(Number), kSide>(rect, [&](std::int32_t x) {
    const Number* row = in.row(rect.y_begin) + x;
    Magnitude* to = out.row(rect.y_begin) + x;
    Numbers a = across(row - 2 * kStride);
    Numbers b = across(row - kStride);
    Numbers c = across(row);
    Numbers d = across(row + kStride);
    Numbers left = load_lanes(row - 2);
    Numbers right = load_lanes(row + 2);
    Numbers left2 = sum(load_lanes(row - kStride - 2), left);
    Numbers right2 = sum(load_lanes(row - kStride + 2), right);
    // One row; the one two below takes the place of the one two above.
    const auto advance = [&](Numbers& above) {
      row += kStride;
      const Numbers new_left = load_lanes(row - 2);
      const Numbers new_right = load_lanes(row + 2);
      const Numbers new_left2 = sum(left, new_left);
      const Numbers new_right2 = sum(right, new_right);
      const Numbers below = across(row + kStride);
      store_lanes(
          larger(distance(sum(right2, new_right2), sum(left2, new_left2)), distance(below, above)),
          to);
      above = below;
      left = new_left;
      right = new_right;
      left2 = new_left2;
      right2 = new_right2;
      to += kStride;
    };
    for (std::int32_t y = rect.y_begin; y < rect.y_end; y += 4) {
      advance(a);
      advance(b);
      if (y + 2 >= rect.y_end) break;
      advance(c);
      advance(d);
    }
  });
}

}  // namespace surefoot::mapping
