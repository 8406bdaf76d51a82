// From heights to classes: the layers of README.md, "Filter and traversability", for one way to
// keep a height.
#pragma once

#include <cstdint>

#include "core/mapping/height_filter.h"
#include "core/mapping/height_scale.h"
#include "core/mapping/traversability.h"

namespace surefoot::mapping {

// What does not depend on the way the heights are kept.
template <std::int32_t kSide>
struct ClassGrids {
  PaddedGrid<float, kSide> height_m;         // kNowhere_m where there is none
  PaddedGrid<std::int8_t, kSide> hole;       // -1: no height
  PaddedGrid<std::int8_t, kSide> usable;     // -1: a height, and few enough holes in the patch
  PaddedGrid<std::int8_t, kSide> classes;    // Traversability
  PaddedGrid<std::int8_t, kSide> steppable;  // -1: that class
};

template <class Scale, std::int32_t kSide>
class ClassLayers {
 public:
  void reset() {
    low_.fill(Scale::kNowhereHigh);
    high_.fill(Scale::kNowhereLow);
    eroded_.fill(Scale::kNowhereLow);
    opened_.fill(Scale::kNowhereLow);
    top_.fill(0);
    covered_.fill(Scale::kNowhereHigh);
    closed_.fill(0);
    gradient_.fill(0);
    edges_x4_.fill(0);
  }
  void set_scale(const Scale& scale) { scale_ = scale; }

  // Takes over the heights of `rect`. False: some cannot be kept in this way.
  bool load(const ClassGrids<kSide>& grids, const CellRect& rect) {
    const Scale scale = scale_;
    auto fit = as_lanes<LaneMask>(all_lanes(std::int8_t{-1}));
    for (std::int32_t y = rect.y_begin; y < rect.y_end; ++y) {
      const float* heights_m = grids.height_m.row(y);
      const std::int8_t* holes = grids.hole.row(y);
      Number* low = low_.row(y);
      Number* high = high_.row(y);
      for_lanes<Scale::kCount, kSide>(rect, [&](std::int32_t x) {
        const auto heights = scale.read(heights_m + x, holes + x);
        store_lanes(heights.low, low + x);
        store_lanes(heights.high, high + x);
        fit &= as_lanes<LaneMask>(heights.fit);
      });
    }
    return (fit[0] & fit[1] & fit[2] & fit[3]) == -1;
  }

  // Recomputes what a change within `changed` reaches, once it is loaded and grids.usable is
  // up to date.
  void update(const CellRect& changed, const TraversabilityLimits& limits, float max_gradient_m,
              ClassGrids<kSide>& grids) {
    const auto grown = [&changed](std::int32_t cells) { return changed.grown(cells, kSide); };
    filter_and_swap<Erosion>(low_, eroded_, grown(2), Scale::kNowhereHigh);
    filter<Dilation>(eroded_, opened_, grown(4));
    filter<Dilation>(high_, top_, grown(2));
    filter_and_swap<Dilation>(opened_, covered_, grown(6), Scale::kNowhereLow);
    filter<Erosion>(covered_, closed_, grown(8));
    gradient(opened_, gradient_, grown(5));
    closed_.repeat_border();
    edges(closed_, edges_x4_, grown(10));
    classify(grown(10), limits, max_gradient_m, grids);
  }

  float opened_m(std::int32_t x, std::int32_t y) const {
    return scale_.height_m(opened_.row(y)[x]);
  }
  float gradient_m(std::int32_t x, std::int32_t y) const {
    return scale_.magnitude_m(gradient_.row(y)[x]);
  }

 private:
  using Number = typename Scale::Number;
  using Numbers = typename LanesOf<Number>::Type;
  using Grid = PaddedGrid<Number, kSide>;

  template <class Filter>
  static void filter(const Grid& in, Grid& out, const CellRect& rect) {
    apply_kernel<Filter>(in, rect, [&out](std::int32_t x, std::int32_t y, Numbers result) {
      store_lanes(result, out.row(y) + x);
    });
  }
  // For the opposite filter to follow: cells where nothing was found change sides.
  template <class Filter>
  static void filter_and_swap(const Grid& in, Grid& out, const CellRect& rect, Number nowhere) {
    apply_kernel<Filter>(in, rect, [&out, nowhere](std::int32_t x, std::int32_t y, Numbers result) {
      store_lanes(Scale::swap(result, nowhere), out.row(y) + x);
    });
  }

  void classify(const CellRect& rect, const TraversabilityLimits& limits, float max_gradient_m,
                ClassGrids<kSide>& grids) const {
    constexpr auto kImpassable = static_cast<std::int8_t>(Traversability::kImpassable);
    constexpr auto kSteppable = static_cast<std::int8_t>(Traversability::kSteppable);
    constexpr std::int8_t kFits = 8;  // above all classes
    const auto raise = all_lanes(Scale::difference_limit(limits.max_raise_m));
    const auto drop = all_lanes(Scale::difference_limit(limits.max_drop_m));
    const auto steepest = all_lanes(Scale::magnitude_limit(static_cast<double>(max_gradient_m)));
    const auto step_x4 = all_lanes(Scale::magnitude_limit(4.0 * limits.max_step_m));
    const auto jump_x4 = all_lanes(Scale::magnitude_limit(4.0 * limits.max_jump_m));
    for (std::int32_t y = rect.y_begin; y < rect.y_end; ++y) {
      const Number* heights = low_.row(y);
      const Number* top = top_.row(y);
      const Number* lowest = eroded_.row(y);
      const auto* slopes = gradient_.row(y);
      const auto* edges = edges_x4_.row(y);
      const std::int8_t* usable_cells = grids.usable.row(y);
      std::int8_t* steppable_cells = grids.steppable.row(y);
      std::int8_t* classes = grids.classes.row(y);
      // The class where no foot can be placed, and whether one can.
      const auto code = [&](std::int32_t x) __attribute__((always_inline)) {
        const Numbers height = load_lanes(heights + x);
        const auto fits = (difference(load_lanes(top + x), height) <= raise) &
                          (difference(height, load_lanes(lowest + x)) <= drop) &
                          (load_lanes(slopes + x) <= steepest);
        const auto edge_x4 = load_lanes(edges + x);
        // A comparison that holds is -1: each limit that the edge respects is one class less.
        return (kImpassable + (edge_x4 <= step_x4) + (edge_x4 <= jump_x4)) | (fits & kFits);
      };
      for_lanes<kByteLanes, kSide>(rect, [&](std::int32_t x) {
        const ByteLanes both = Scale::bytes(x, code);
        const ByteLanes usable = load_lanes(usable_cells + x);
        const ByteLanes steppable = usable & (both >= all_lanes(kFits));
        store_lanes(steppable, steppable_cells + x);
        store_lanes((steppable & kSteppable) | (usable & ~steppable & both), classes + x);
      });
    }
  }

  Scale scale_;
  Grid low_;      // heights; kNowhereHigh where there is none
  Grid high_;     // heights; kNowhereLow where there is none
  Grid eroded_;   // lowest of the patch
  Grid opened_;   // equation (4)
  Grid top_;      // highest of the patch
  Grid covered_;  // dilation of opened_
  Grid closed_;   // closing of opened_
  using MagnitudeGrid = PaddedGrid<typename Scale::Magnitude, kSide>;
  MagnitudeGrid gradient_;  // equations (5), (6)
  MagnitudeGrid edges_x4_;  // of closed_
};

}  // namespace surefoot::mapping
