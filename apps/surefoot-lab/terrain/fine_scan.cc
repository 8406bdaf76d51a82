#include "apps/surefoot-lab/terrain/fine_scan.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/math/linear.h"

namespace surefoot::apps {
namespace {

constexpr double kBehind_m = 0.30;  // the ground the body stands on
constexpr double kHalfWidth_m = 0.08;

std::int32_t sample_of(double x_m) {
  return static_cast<std::int32_t>(std::floor(x_m / FineTerrain::kStep_m));
}

// Mean height of the ground under and behind the camera; before the terrain its first 10 cm.
double ground_height_m(const FineTerrain& terrain, double x_m) {
  const double middle_m = 0.5 * terrain.rows * FineTerrain::kStep_m;
  const std::int32_t end = std::clamp(sample_of(std::max(x_m, 0.10)), 1, terrain.columns);
  const std::int32_t begin = std::clamp(sample_of(x_m - kBehind_m), 0, end - 1);
  double sum = 0;
  double count = 0;
  for (std::int32_t j = sample_of(middle_m - kHalfWidth_m); j < sample_of(middle_m + kHalfWidth_m);
       ++j) {
    for (std::int32_t i = begin; i < end; ++i) {
      if (!terrain.contains(i, j)) continue;
      sum += static_cast<double>(terrain.z_m[terrain.index(i, j)]);
      count += 1;
    }
  }
  return count > 0 ? sum / count : 0.0;
}

// More than half a unit in the last place of any height here: rounding never lowers a ceiling.
constexpr double kRoundingUp_m = 1e-7;

// Follows a ray in steps of a millimetre until it meets the surface or leaves terrain and range.
// In millimetres, the height in metres; casts for floors, since this is the experiment's hot loop.
void follow(const FineTerrain& terrain, const Vector3& from_m, const Vector3& direction,
            double range_m, FineScan& scan) {
  const int steps = static_cast<int>(range_m / FineTerrain::kStep_m);
  double x = from_m.x() / FineTerrain::kStep_m;
  double y = from_m.y() / FineTerrain::kStep_m;
  double z_m = from_m.z();
  const double step_z_m = direction.z() * FineTerrain::kStep_m;
  int k = 0;
  if (x < 0) {  // before the terrain: straight to its edge
    if (direction.x() <= 0) return;
    k = static_cast<int>(-x / direction.x()) + 1;
    x += k * direction.x();
    y += k * direction.y();
    z_m += k * step_z_m;
  }
  for (; k < steps; ++k, x += direction.x(), y += direction.y(), z_m += step_z_m) {
    if (x < 0 || y < 0) return;
    const auto i = static_cast<std::int32_t>(x);
    const auto j = static_cast<std::int32_t>(y);
    if (i >= terrain.columns || j >= terrain.rows) return;
    const std::size_t at = terrain.index(i, j);
    if (z_m <= static_cast<double>(terrain.z_m[at])) {
      for (std::int32_t v = j - 1; v <= j + 1; ++v) {
        for (std::int32_t u = i - 1; u <= i + 1; ++u) {
          if (terrain.contains(u, v)) scan.seen[terrain.index(u, v)] = 1;
        }
      }
      return;
    }
    const auto ceiling_m = static_cast<float>(z_m + kRoundingUp_m);
    if (ceiling_m < scan.ceiling_m[at]) scan.ceiling_m[at] = ceiling_m;
  }
}

}  // namespace

FineScan scan_terrain(const FineTerrain& terrain, const ScanOptions& options) {
  FineScan scan;
  scan.ceiling_m.assign(terrain.z_m.size(), kNoSight_m);
  scan.seen.assign(terrain.z_m.size(), 0);
  const double cos_tilt = std::cos(options.tilt_rad);
  const double sin_tilt = std::sin(options.tilt_rad);
  const double half_x = std::tan(0.5 * options.view_x_rad);
  const double half_y = std::tan(0.5 * options.view_y_rad);
  const int places =
      static_cast<int>((options.last_x_m - options.first_x_m) / options.step_m + 1e-6) + 1;
  for (int place = 0; place < places; ++place) {
    const double x_m = options.first_x_m + place * options.step_m;
    const Vector3 camera(x_m, 0.5 * terrain.rows * FineTerrain::kStep_m,
                         ground_height_m(terrain, x_m) + options.height_m);
    for (int row = 0; row < options.rows; ++row) {
      const double down = half_y * (2 * (row + 0.5) / options.rows - 1);
      for (int column = 0; column < options.columns; ++column) {
        const double left = half_x * (1 - 2 * (column + 0.5) / options.columns);
        const Vector3 direction =
            Vector3(cos_tilt - down * sin_tilt, left, -sin_tilt - down * cos_tilt).normalized();
        follow(terrain, camera, direction, options.range_m, scan);
      }
    }
  }
  return scan;
}

void to_grid(const FineTerrain& terrain, const FineScan& scan, int cell_mm, double noise_m,
             std::uint64_t seed, terrain::TerrainGrid& out) {
  const Status status =
      out.reset(terrain.columns / cell_mm, terrain.rows / cell_mm, 1e-3 * cell_mm);
  SUREFOOT_ASSERT(ok(status));
  Random random(seed, 77);
  for (std::int32_t row = 0; row < out.rows; ++row) {
    for (std::int32_t column = 0; column < out.columns; ++column) {
      const std::size_t from =
          terrain.index(column * cell_mm + cell_mm / 2, row * cell_mm + cell_mm / 2);
      const std::size_t to = out.index(column, row);
      const auto noise = static_cast<float>(noise_m * random.normal());
      if (scan.seen[from] != 0) {
        out.measure(to, terrain.z_m[from] + noise);
      } else if (scan.ceiling_m[from] < kNoSight_m) {
        out.bound(to, scan.ceiling_m[from] + noise);
      }
    }
  }
}

void true_grid(const FineTerrain& terrain, int cell_mm, terrain::TerrainGrid& out) {
  const Status status =
      out.reset(terrain.columns / cell_mm, terrain.rows / cell_mm, 1e-3 * cell_mm);
  SUREFOOT_ASSERT(ok(status));
  for (std::int32_t row = 0; row < out.rows; ++row) {
    for (std::int32_t column = 0; column < out.columns; ++column) {
      const std::size_t from =
          terrain.index(column * cell_mm + cell_mm / 2, row * cell_mm + cell_mm / 2);
      const std::size_t to = out.index(column, row);
      if (terrain.is_true(from)) {
        out.measure(to, terrain.z_m[from]);
      } else {
        out.bound(to, terrain.z_m[from]);
      }
    }
  }
}

}  // namespace surefoot::apps
