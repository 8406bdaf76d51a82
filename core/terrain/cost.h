// How bad the ground around a cell is to stand on, from 0 to 1: slope, height difference, standard
// deviation and roughness of the heights in three windows around it, weighted. Paper section IV
// names the features; weights come from configuration.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/parameters.h"
#include "core/base/status.h"
#include "core/terrain/fill.h"
#include "core/terrain/terrain_grid.h"

namespace surefoot::terrain {

inline constexpr std::size_t kCostWindows = 3;
inline constexpr std::size_t kCostFeatures = 4;
inline constexpr std::int32_t kMaxCostRadius = 10;

// Of the cells with height within a square window around a cell.
struct WindowFeatures {
  double slope = 0;                // tangent of the steepest direction of the plane through them
  double height_difference_m = 0;  // highest minus lowest
  double deviation_m = 0;          // standard deviation of the heights
  double roughness_per_m = 0;  // mean size of the Laplacian, where all four neighbours are known

  std::array<double, kCostFeatures> values() const {
    return {slope, height_difference_m, deviation_m, roughness_per_m};
  }
};

// A feature in all windows: the value that costs as much as any (scale), and its weight.
struct FeatureCost {
  std::array<double, kCostWindows> scale{};
  std::array<double, kCostWindows> weight{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.reals("scale", self.scale, {1e-6, 1e6}, "value from which on the feature costs 1");
    visit.reals("weight", self.weight, {0.0, 1000.0}, "share of the feature in the cost");
  }
};

// Defaults are none on purpose (core/base/parameters.h).
struct CostConfig {
  std::array<double, kCostWindows> radius_cells{};  // whole, ascending: the window is 2 r + 1 wide
  FeatureCost slope;
  FeatureCost height_difference;
  FeatureCost deviation;
  FeatureCost roughness;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.reals("radius_cells", self.radius_cells, {1, kMaxCostRadius}, "of the three windows");
    visit.group("slope", self.slope);
    visit.group("height_difference", self.height_difference);
    visit.group("deviation", self.deviation);
    visit.group("roughness", self.roughness);
  }
};

// kInvalid: outside describe()'s ranges, radii not whole or not ascending, weights all zero.
Status validate(const CostConfig& config);

using CellFeatures = std::array<WindowFeatures, kCostWindows>;

// The cost of every cell with height, row by row as time allows. Static memory: 480 kB.
class CostMap {
 public:
  // kInvalid: see validate(); nothing changed.
  Status configure(const CostConfig& config);

  // Writes every page, so that no later call meets one for the first time.
  void touch();

  // Several views of one terrain, draws of its unseen parts for instance, are given one after the
  // other; the map holds mean and spread of their costs. kUnavailable: not configured.
  Status start();
  // All views since start() have one size and one state. The view must stay until its last row.
  // kInvalid: another size than the views before, or beyond kMaxSide. About 0.1 ms for 10^4 cells.
  Status add(const HeightView& view);
  // Works on up to `rows` rows; true: the view added last is done.
  bool advance(std::int32_t rows);

  // Once done. 0 for cells without height.
  double cost(std::size_t i) const { return count_ > 0 ? sum_[i] / count_ : 0.0; }
  double spread(std::size_t i) const;

  // The features of one cell with height, by themselves. Needs add(), not advance().
  CellFeatures features(std::int32_t column, std::int32_t row) const;

 private:
  double cost_of(const CellFeatures& features) const;
  bool known(std::int32_t column, std::int32_t row) const;
  float height(std::int32_t column, std::int32_t row) const;
  float bend(std::int32_t column, std::int32_t row) const;

  CostConfig config_;
  bool configured_ = false;
  std::array<std::int32_t, kCostWindows> radius_{};
  double total_weight_ = 0;
  HeightView view_;
  std::int32_t row_ = 0;
  double count_ = 0;
  std::array<float, kMaxCells>
      bend_m_{};  // size of the Laplacian; negative: a neighbour is missing
  std::array<float, kMaxCells> sum_{};
  std::array<float, kMaxCells> squares_{};
};

}  // namespace surefoot::terrain
