// Worlds made by draws: steps, ramps, clutter. contract.md "The worlds".
#include <algorithm>
#include <cmath>
#include <string>

#include "sim_hal/simulator_error.h"
#include "sim_hal/world/boxes.h"
#include "sim_hal/world/terrain.h"

namespace surefoot::sim {

namespace {

// Clutter.
constexpr double kMinSide_m = 0.08;
constexpr double kMaxSide_m = 0.30;
constexpr double kMinHeightPart = 0.3;
constexpr int kFreeAttempts = 20'000;    // boxes on the ground, not overlapping
constexpr int kStackAttempts = 200'000;  // then boxes on boxes

// A raster of the field that counts what is covered.
class CoverRaster {
 public:
  static constexpr double kCell_m = 0.01;
  static constexpr int kNx = 230;
  static constexpr int kNy = 120;

  CoverRaster() : covered_(static_cast<std::size_t>(kNx * kNy), 0) {}

  void add(const TerrainBox& box) {
    const double reach = std::hypot(box.half_length_m, box.half_width_m);
    const int i0 = std::max(0, index(box.x_m - reach - kFieldBegin_m));
    const int i1 = std::min(kNx - 1, index(box.x_m + reach - kFieldBegin_m));
    const int j0 = std::max(0, index(box.y_m - reach + kLaneWidth_m / 2));
    const int j1 = std::min(kNy - 1, index(box.y_m + reach + kLaneWidth_m / 2));
    for (int j = j0; j <= j1; ++j) {
      for (int i = i0; i <= i1; ++i) mark(i, j, box);
    }
  }
  double cover() const { return static_cast<double>(count_) / (kNx * kNy); }

 private:
  static int index(double offset_m) { return static_cast<int>(std::floor(offset_m / kCell_m)); }
  void mark(int i, int j, const TerrainBox& box) {
    const double x = kFieldBegin_m + (i + 0.5) * kCell_m;
    const double y = -kLaneWidth_m / 2 + (j + 0.5) * kCell_m;
    std::uint8_t& cell = covered_[static_cast<std::size_t>(j * kNx + i)];
    if (cell == 0 && box.covers(x, y)) {
      cell = 1;
      ++count_;
    }
  }

  std::vector<std::uint8_t> covered_;
  int count_ = 0;
};

BoxDraw clutter_boxes(double height_m) {
  return {kMinSide_m, kMaxSide_m,     kMinHeightPart * height_m,
          height_m,   kFieldLength_m, kLaneWidth_m};
}

bool free_of_all(const TerrainBox& box, const std::vector<TerrainBox>& others) {
  return std::none_of(others.begin(), others.end(),
                      [&](const TerrainBox& other) { return overlap(box, other); });
}

}  // namespace

double clutter_cover(const Terrain& terrain) {
  CoverRaster raster;
  for (const TerrainBox& box : terrain.boxes) raster.add(box);
  return raster.cover();
}

void make_clutter(double height_m, double cover, Random& random, Terrain& terrain) {
  if (!(height_m > 0)) throw SimulatorError("world: clutter needs height_m above 0");
  CoverRaster raster;
  for (int attempt = 0; attempt < kFreeAttempts && raster.cover() < cover; ++attempt) {
    const TerrainBox box = draw_box(clutter_boxes(height_m), random);
    if (!free_of_all(box, terrain.boxes)) continue;
    terrain.boxes.push_back(box);
    raster.add(box);
  }
  for (int attempt = 0; attempt < kStackAttempts && raster.cover() < cover; ++attempt) {
    TerrainBox box = draw_box(clutter_boxes(height_m), random);
    const double support = support_m(terrain.boxes, box);
    box.bottom_m += support;
    box.top_m += support;
    if (box.top_m > height_m) continue;
    terrain.boxes.push_back(box);
    raster.add(box);
  }
  if (raster.cover() < cover) {
    throw SimulatorError("world: clutter cover " + std::to_string(cover) +
                         " cannot be reached, got " + std::to_string(raster.cover()));
  }
}

void make_steps(double height_m, Random& random, Terrain& terrain) {
  constexpr double kMinLength_m = 0.25;
  constexpr double kMaxLength_m = 0.60;
  constexpr double kHalfWidth_m = 1.0;  // wider than the lane: no way around
  const double end_m = kFieldBegin_m + kFieldLength_m;
  double begin_m = kFieldBegin_m;
  while (end_m - begin_m >= kMinLength_m) {
    double length_m = random.uniform(kMinLength_m, std::min(kMaxLength_m, end_m - begin_m));
    // A rest too short for a platform joins this one, if that stays within the limit.
    if (end_m - begin_m - length_m < kMinLength_m && end_m - begin_m <= kMaxLength_m) {
      length_m = end_m - begin_m;
    }
    TerrainBox box;
    box.x_m = begin_m + length_m / 2;
    box.half_length_m = length_m / 2;
    box.half_width_m = kHalfWidth_m;
    box.top_m = random.uniform(0.0, height_m);
    if (box.top_m > 0.001) terrain.boxes.push_back(box);
    begin_m += length_m;
  }
}

namespace {

// 0 before a, 1 after b, straight between.
double ramp(double x, double a, double b) { return std::clamp((x - a) / (b - a), 0.0, 1.0); }

}  // namespace

// Along x: up over 0.4 m, twisting over 0.6 m into a side slope held for 0.3 m, twisting back, down
// over 0.4 m; the rest level. All break lines lie on nodes. The twist itself slopes along x by side
// * y / 0.6, so the side slope is drawn below steepest / sqrt(2): nothing inside the lane, where
// |y| <= 0.6, is steeper than slope_rad. Beyond the lane the ground goes on level across.
void make_ramps(double slope_rad, Random& random, Terrain& terrain) {
  constexpr double kCell_m = 0.05;
  constexpr double kHalfLane_m = kLaneWidth_m / 2;
  const double steepest = std::tan(slope_rad);
  const double up = random.uniform(0.5, 1.0) * steepest;
  const double side_sign = random.below(2) == 0 ? -1.0 : 1.0;
  const double side = side_sign * random.uniform(0.5, 1.0) * steepest / std::sqrt(2.0);

  HeightGrid& grid = terrain.grid;
  grid.cell_m = kCell_m;
  grid.x0_m = kFieldBegin_m;
  grid.y0_m = -1.5;
  grid.nx = 47;  // to x = 2.7
  grid.ny = 61;  // to y = 1.5
  grid.z_m.resize(grid.nx * grid.ny);
  for (std::size_t j = 0; j < grid.ny; ++j) {
    for (std::size_t i = 0; i < grid.nx; ++i) {
      const double x = grid.x0_m + kCell_m * static_cast<double>(i);
      const double y = grid.y0_m + kCell_m * static_cast<double>(j);
      const double along = 0.4 * up * (ramp(x, 0.4, 0.8) - ramp(x, 2.3, 2.7));
      const double tilt = side * (ramp(x, 0.8, 1.4) - ramp(x, 1.7, 2.3));
      grid.z_m[j * grid.nx + i] = along + tilt * std::clamp(y, -kHalfLane_m, kHalfLane_m);
    }
  }
}

}  // namespace surefoot::sim
