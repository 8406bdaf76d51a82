// From heights to classes over a square grid: opening, gradient map, patch under the foot, height
// of edges, class, distance to the nearest cell that cannot bear a foot. Rules: README.md.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/mapping/height_filter.h"
#include "core/mapping/traversability.h"

namespace surefoot::mapping {

// How far a cell reaches: opening 2 + 2, closing 2 + 2, edge 2, margin 2.
inline constexpr std::int32_t kFilterReach_cells = 12;

// Keeps every layer, so that update() recomputes what a change can reach and nothing else. All
// layers depend on the set cells alone: the result has the same bits as after computing all anew.
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
    low_.fill(Erosion::kNeutral);
    high_.fill(Dilation::kNeutral);
    hole_.fill(0);
    eroded_.fill(Dilation::kNeutral);
    opened_.fill(Dilation::kNeutral);
    top_.fill(0);
    covered_.fill(Erosion::kNeutral);
    closed_.fill(0);
    gradient_.fill(0);
    holes_.fill(0);
    class_.fill(0);
    margin_.fill(0);
    for (std::int32_t y = 0; y < kSide; ++y) {
      for (std::int32_t x = 0; x < kSide; ++x) clear(x, y);
    }
    update({0, kSide, 0, kSide});
  }

  void set(std::int32_t x, std::int32_t y, float height_m) {
    const float height = on_filter_grid(height_m);
    low_.row(y)[x] = height;
    high_.row(y)[x] = height;
    hole_.row(y)[x] = 0;
  }
  void clear(std::int32_t x, std::int32_t y) {
    low_.row(y)[x] = Erosion::kNeutral;
    high_.row(y)[x] = Dilation::kNeutral;
    hole_.row(y)[x] = 1;
  }

  // To be called when the cells of `changed` were set or cleared, before anything is read.
  void update(const CellRect& changed) {
    if (changed.empty()) return;
    const auto grown = [&changed](std::int32_t cells) { return changed.grown(cells, kSide); };
    apply_kernel<Erosion, Next::kOpposite>(low_, eroded_, grown(2));
    apply_kernel<Dilation, Next::kAny>(eroded_, opened_, grown(4));
    apply_kernel<Dilation, Next::kAny>(high_, top_, grown(2));
    apply_kernel<Sum, Next::kAny>(hole_, holes_, grown(2));
    apply_kernel<Dilation, Next::kOpposite>(opened_, covered_, grown(6));
    apply_kernel<Erosion, Next::kAny>(covered_, closed_, grown(8));
    gradient(opened_, gradient_, grown(5));
    classify(grown(10));
    find_margins(grown(12));
  }

  Traversability traversability(std::int32_t x, std::int32_t y) const {
    return static_cast<Traversability>(class_.row(y)[x]);
  }
  // 0 where no foot can be placed, else 1 .. kMaxMargin_cells.
  std::uint8_t margin_cells(std::int32_t x, std::int32_t y) const {
    return static_cast<std::uint8_t>(margin_.row(y)[x]);
  }
  const FilterGrid<kSide>& opened() const { return opened_; }
  const FilterGrid<kSide>& gradient_map() const { return gradient_; }

 private:
  using ClassGrid = PaddedGrid<std::int32_t, kSide>;

  // What one row contributes to the edges of its neighbours: differences over four cells and sums
  // over three, weighted as Sobel's.
  struct Row {
    Lanes across;
    Lanes along;
  };
  Row read(std::int32_t x, std::int32_t y) const {
    const float* row = closed_.row(y) + x;
    const Lanes middle = load_lanes(row);
    return {load_lanes(row + 2) - load_lanes(row - 2),
            load_lanes(row - 1) + load_lanes(row + 1) + (middle + middle)};
  }

  void classify(const CellRect& rect) {
    for (std::int32_t x = rect.x_begin; x < rect.x_end; x += kLanes) {
      Row rows[5] = {read(x, rect.y_begin - 2),
                     read(x, rect.y_begin - 1),
                     read(x, rect.y_begin),
                     read(x, rect.y_begin + 1),
                     {}};
      for (std::int32_t y = rect.y_begin; y < rect.y_end; ++y) {
        rows[4] = read(x, y + 2);
        const Lanes across = rows[1].across + rows[3].across + (rows[2].across + rows[2].across);
        const Lanes edge_x4 = larger(magnitude(across), magnitude(rows[4].along - rows[0].along));
        classify_lanes(x, y, edge_x4);
        rows[0] = rows[1];
        rows[1] = rows[2];
        rows[2] = rows[3];
        rows[3] = rows[4];
      }
    }
  }

  void classify_lanes(std::int32_t x, std::int32_t y, Lanes edge_x4) {
    const auto limit = [](double value) { return all_lanes(static_cast<float>(value)); };
    const Lanes height = load_lanes(low_.row(y) + x);
    const LaneMask known = load_lanes(hole_.row(y) + x) < all_lanes(0.5F);
    const LaneMask enough = load_lanes(holes_.row(y) + x) <= limit(limits_.max_unknown);
    const LaneMask fits = (load_lanes(top_.row(y) + x) - height <= limit(limits_.max_raise_m)) &
                          (height - load_lanes(eroded_.row(y) + x) <= limit(limits_.max_drop_m)) &
                          (load_lanes(gradient_.row(y) + x) <= all_lanes(max_gradient_m_));
    constexpr auto kUnsteppable = static_cast<std::int32_t>(Traversability::kUnsteppable);
    constexpr auto kSteppable = static_cast<std::int32_t>(Traversability::kSteppable);
    // A comparison that holds is -1: each limit that the edge exceeds is one class more.
    const LaneMask barred = kUnsteppable - (edge_x4 > limit(4.0 * limits_.max_step_m)) -
                            (edge_x4 > limit(4.0 * limits_.max_jump_m));
    const LaneMask known_class = (fits & kSteppable) | (~fits & barred);
    store_mask(known_class & known & enough, class_.row(y) + x);
  }

  void find_margins(const CellRect& rect) {
    constexpr auto kSteppable = static_cast<std::int32_t>(Traversability::kSteppable);
    struct Line {
      LaneMask three;
      LaneMask five;
    };
    const auto read_line = [this](std::int32_t x, std::int32_t y) {
      const std::int32_t* row = class_.row(y) + x;
      const LaneMask three = (load_mask(row - 1) == kSteppable) & (load_mask(row) == kSteppable) &
                             (load_mask(row + 1) == kSteppable);
      return Line{three,
                  three & (load_mask(row - 2) == kSteppable) & (load_mask(row + 2) == kSteppable)};
    };
    for (std::int32_t x = rect.x_begin; x < rect.x_end; x += kLanes) {
      Line lines[5] = {read_line(x, rect.y_begin - 2),
                       read_line(x, rect.y_begin - 1),
                       read_line(x, rect.y_begin),
                       read_line(x, rect.y_begin + 1),
                       {}};
      for (std::int32_t y = rect.y_begin; y < rect.y_end; ++y) {
        lines[4] = read_line(x, y + 2);
        const LaneMask ring1 = lines[1].three & lines[2].three & lines[3].three;
        const LaneMask ring2 =
            lines[0].five & lines[1].five & lines[2].five & lines[3].five & lines[4].five;
        const LaneMask own = load_mask(class_.row(y) + x) == kSteppable;
        store_mask(own & (1 - ring1 - ring2), margin_.row(y) + x);
        lines[0] = lines[1];
        lines[1] = lines[2];
        lines[2] = lines[3];
        lines[3] = lines[4];
      }
    }
  }

  TraversabilityLimits limits_;
  float max_gradient_m_ = 0;
  FilterGrid<kSide> low_;       // heights; +kNowhere_m where there is none
  FilterGrid<kSide> high_;      // heights; -kNowhere_m where there is none
  FilterGrid<kSide> hole_;      // 1: no height
  FilterGrid<kSide> eroded_;    // lowest of the patch
  FilterGrid<kSide> opened_;    // equation (4)
  FilterGrid<kSide> top_;       // highest of the patch
  FilterGrid<kSide> holes_;     // cells of the patch without height
  FilterGrid<kSide> covered_;   // dilation of opened_
  FilterGrid<kSide> closed_;    // closing of opened_
  FilterGrid<kSide> gradient_;  // equations (5), (6)
  ClassGrid class_;
  ClassGrid margin_;
};

}  // namespace surefoot::mapping
