// From heights to classes over a square grid: opening, gradient map, patch under the foot, height
// of edges, class, distance to the nearest cell that cannot bear a foot. Rules: README.md.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/base/assert.h"
#include "core/mapping/class_layers.h"
#include "core/mapping/height_filter.h"
#include "core/mapping/height_scale.h"
#include "core/mapping/traversability.h"

namespace surefoot::mapping {

// How far a cell reaches: opening 2 + 2, closing 2 + 2, edge 2, margin 2.
inline constexpr std::int32_t kFilterReach_cells = 12;

// Keeps every layer, so that update() recomputes what a change can reach and nothing else. All
// layers depend on the set cells alone: the result has the same bits as after computing all anew.
// Heights are kept in steps where those can hold them, else in metres.
template <std::int32_t kSide>
class TraversabilityFilter {
 public:
  // Forgets all heights.
  void reset(const TraversabilityLimits& limits, double cell_size_m) {
    limits_ = limits;
    // Sobel gives 8 cells of slope along an axis; along a diagonal the larger of the two components
    // is smaller by sqrt(2). No direction shall be steeper than the limit.
    constexpr double kDiagonal = 0.70710678118654752;
    max_gradient_m_ = static_cast<float>(8.0 * kDiagonal * limits.max_slope * cell_size_m);
    in_steps_.reset();
    in_metres_.reset();
    grids_.height_m.fill(kNowhere_m);
    grids_.hole.fill(0);
    grids_.usable.fill(0);
    grids_.classes.fill(0);
    grids_.steppable.fill(0);
    margin_.fill(0);
    for (std::int32_t y = 0; y < kSide; ++y) {
      for (std::int32_t x = 0; x < kSide; ++x) clear(x, y);
    }
    uses_steps_ = true;
    in_steps_.set_scale(StepScale(0));
    update(whole());
  }

  void set(std::int32_t x, std::int32_t y, float height_m) {
    grids_.height_m.row(y)[x] = on_filter_grid(height_m);
    grids_.hole.row(y)[x] = 0;
  }
  void clear(std::int32_t x, std::int32_t y) {
    grids_.height_m.row(y)[x] = kNowhere_m;
    grids_.hole.row(y)[x] = -1;
  }

  // To be called when the cells of `changed` were set or cleared, before anything is read.
  void update(const CellRect& changed) {
    if (changed.empty()) return;
    const CellRect loaded = load(changed);
    count_holes(loaded.grown(2, kSide));
    if (uses_steps_) {
      in_steps_.update(loaded, limits_, max_gradient_m_, grids_);
    } else {
      in_metres_.update(loaded, limits_, max_gradient_m_, grids_);
    }
    find_margins(loaded.grown(kFilterReach_cells, kSide));
  }

  Traversability traversability(std::int32_t x, std::int32_t y) const {
    return static_cast<Traversability>(grids_.classes.row(y)[x]);
  }
  // 0 where no foot can be placed, else 1 .. kMaxMargin_cells.
  std::uint8_t margin_cells(std::int32_t x, std::int32_t y) const {
    return static_cast<std::uint8_t>(margin_.row(y)[x]);
  }
  // Equation (4); -kNowhere_m where nothing is found.
  float opened_m(std::int32_t x, std::int32_t y) const {
    return uses_steps_ ? in_steps_.opened_m(x, y) : in_metres_.opened_m(x, y);
  }
  // Equations (5) and (6). Without meaning beside cells where nothing is found.
  float gradient_m(std::int32_t x, std::int32_t y) const {
    return uses_steps_ ? in_steps_.gradient_m(x, y) : in_metres_.gradient_m(x, y);
  }
  bool uses_steps() const { return uses_steps_; }

 private:
  using ByteGrid = PaddedGrid<std::int8_t, kSide>;
  static constexpr CellRect whole() { return {0, kSide, 0, kSide}; }

  // What must be computed anew: the changed cells, or all where heights are kept in another way
  // from now on.
  CellRect load(const CellRect& changed) {
    const CellRect rect = changed.grown(0, kSide);
    if (uses_steps_ && in_steps_.load(grids_, rect)) return changed;
    const auto [lowest_m, highest_m] = find_span();
    const bool used_steps = uses_steps_;
    uses_steps_ = StepScale::can_hold(lowest_m, highest_m);
    if (uses_steps_) {
      in_steps_.set_scale(StepScale(on_filter_grid(0.5F * (lowest_m + highest_m))));
      SUREFOOT_ASSERT(in_steps_.load(grids_, whole()));
      return whole();
    }
    (void)in_metres_.load(grids_, used_steps ? whole() : rect);
    return used_steps ? whole() : changed;
  }
  struct Span {
    float lowest_m;
    float highest_m;
  };
  // Of all heights; 0 and 0 where there is none.
  Span find_span() const {
    Lanes lowest = all_lanes(kNowhere_m);
    Lanes highest = all_lanes(-kNowhere_m);
    for (std::int32_t y = 0; y < kSide; ++y) {
      for_lanes<kLanes, kSide>(whole(), [&](std::int32_t x) {
        const MetreScale::Heights heights =
            MetreScale::read(grids_.height_m.row(y) + x, grids_.hole.row(y) + x);
        lowest = smaller(lowest, heights.low);
        highest = larger(highest, heights.high);
      });
    }
    Span span{lowest[0], highest[0]};
    for (int i = 1; i < kLanes; ++i) {
      span = {std::min(span.lowest_m, lowest[i]), std::max(span.highest_m, highest[i])};
    }
    return span.lowest_m <= span.highest_m ? span : Span{0, 0};
  }

  void count_holes(const CellRect& rect) {
    const auto least = all_lanes(static_cast<std::int8_t>(-limits_.max_unknown));
    apply_kernel<Sum>(grids_.hole, rect, [&](std::int32_t x, std::int32_t y, ByteLanes holes) {
      const ByteLanes hole = load_lanes(grids_.hole.row(y) + x);
      store_lanes(~hole & (holes >= least), grids_.usable.row(y) + x);
    });
  }

  void find_margins(const CellRect& rect) {
    struct Line {
      ByteLanes three;
      ByteLanes five;
    };
    const auto read_line = [this](std::int32_t x, std::int32_t y) {
      const std::int8_t* row = grids_.steppable.row(y) + x;
      const ByteLanes three = load_lanes(row - 1) & load_lanes(row) & load_lanes(row + 1);
      return Line{three, three & load_lanes(row - 2) & load_lanes(row + 2)};
    };
    for_lanes<kByteLanes, kSide>(rect, [&](std::int32_t x) {
      Line lines[4] = {read_line(x, rect.y_begin - 2), read_line(x, rect.y_begin - 1),
                       read_line(x, rect.y_begin), read_line(x, rect.y_begin + 1)};
      for (std::int32_t y = rect.y_begin; y < rect.y_end; ++y) {
        const Line last = read_line(x, y + 2);
        const ByteLanes ring1 = lines[1].three & lines[2].three & lines[3].three;
        const ByteLanes ring2 =
            lines[0].five & lines[1].five & lines[2].five & lines[3].five & last.five;
        const ByteLanes own = load_lanes(grids_.steppable.row(y) + x);
        store_lanes(own & (1 - ring1 - ring2), margin_.row(y) + x);
        lines[0] = lines[1];
        lines[1] = lines[2];
        lines[2] = lines[3];
        lines[3] = last;
      }
    });
  }

  TraversabilityLimits limits_;
  float max_gradient_m_ = 0;
  bool uses_steps_ = true;
  ClassGrids<kSide> grids_;
  ClassLayers<StepScale, kSide> in_steps_;
  ClassLayers<MetreScale, kSide> in_metres_;  // up to date while !uses_steps_
  ByteGrid margin_;
};

}  // namespace surefoot::mapping
