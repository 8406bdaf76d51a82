// What the ground under an unseen cell is likely to be, from the heights and ceilings around it: a
// linear regression learned off-line from library terrain that was scanned with the same sensor.
// It knows what the texture cannot: ground that would be level would have been seen.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/status.h"
#include "core/terrain/terrain_grid.h"

namespace surefoot::terrain {

inline constexpr std::int32_t kMaxPriorRadius = 6;
inline constexpr std::int32_t kDenseRadius = 2;  // where strides above 1 leave no gaps
inline constexpr std::size_t kMaxPriorPoints =
    (2 * kMaxPriorRadius + 1) * (2 * kMaxPriorRadius + 1) +
    (2 * kDenseRadius + 1) * (2 * kDenseRadius + 1);
inline constexpr std::size_t kMaxPriorInputs = 2 * kMaxPriorPoints + 1;

// How many points a stencil has: a square lattice and, where it has gaps, what lies between its
// points near the centre.
std::size_t prior_points(std::int32_t radius, std::int32_t stride);

// Plain data, made by surefoot-lab.
struct HeightPrior {
  std::int32_t radius = 0;  // points to each side of the centre; 0: there is no prior
  std::int32_t stride = 1;  // cells between points; around the centre there are all cells
  double cell_m = 0;        // of the terrain it was learned on
  double residual_m = 0;    // rms error on what it was learned from
  std::array<float, kMaxPriorInputs> weights{};

  bool exists() const { return radius > 0; }
  std::size_t points() const { return prior_points(radius, stride); }
  std::size_t inputs() const { return 2 * points() + 1; }
};

// kInvalid: radius, stride or cell out of range, or a weight that is not finite.
Status validate(const HeightPrior& prior);

// The points around a cell as offsets in cells: the lattice in rows across the view, each along it,
// then the dense points in the same order.
class PriorStencil {
 public:
  // view_rad: heading of the sensor in the grid, 0 along x. The stencil turns with it. mirrored:
  // left and right of the view change places. Radius 0..kMaxPriorRadius, stride 1..8.
  void set(std::int32_t radius, std::int32_t stride, double view_rad, bool mirrored = false);

  // For an unseen cell: for every point (value - own ceiling) / 3 cm, at most 4 in size, then for
  // every point whether it was measured, then 1. Values are measured heights or ceilings; points
  // about which nothing is known give 0 and 0. `inputs` holds 2 * points + 1 numbers.
  void gather(const TerrainGrid& grid, std::int32_t column, std::int32_t row,
              std::span<float> inputs) const;
  std::size_t points() const { return points_; }

 private:
  struct Offset {
    std::int16_t column;
    std::int16_t row;
  };
  void add(double along, double left, double cos, double sin);

  std::size_t points_ = 0;
  std::array<Offset, kMaxPriorPoints> offsets_{};
};

inline constexpr float kPriorScale_m = 0.03f;
inline constexpr float kPriorLimit = 4.0f;

// Height of an unseen cell, not above its ceiling. inputs as from gather(). About 1 us.
float predict(const HeightPrior& prior, std::span<const float> inputs, float ceiling_m);

}  // namespace surefoot::terrain
