#include "sim_hal/world/relief.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace surefoot::sim {

namespace {

constexpr double kPi = 3.141592653589793;
constexpr double kCell_m = 0.1;
constexpr double kShortest_m = 9.0;  // hills, from crest to crest
constexpr double kLongest_m = 30.0;
constexpr double kFade_m = 6.0;  // hills at the border
constexpr double kRoughFade_m = 1.0;
constexpr double kCoarse_m = 0.6;
constexpr double kFine_m = 0.3;

double smooth(double s) {
  const double t = std::clamp(s, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

struct Wave {
  double kx = 0;
  double ky = 0;
  double phase = 0;
  double height_m = 0;
};

class Hills {
 public:
  explicit Hills(Random& random) {
    for (Wave& wave : waves_) {
      const double length_m = random.uniform(kShortest_m, kLongest_m);
      const double heading = random.uniform(0.0, 2 * kPi);
      wave.kx = 2 * kPi / length_m * std::cos(heading);
      wave.ky = 2 * kPi / length_m * std::sin(heading);
      wave.phase = random.uniform(0.0, 2 * kPi);
      wave.height_m = length_m * random.uniform(0.5, 1.0);
    }
  }
  double at(double x, double y) const {
    double z = 0;
    for (const Wave& w : waves_) z += w.height_m * std::sin(w.kx * x + w.ky * y + w.phase);
    return z;
  }

 private:
  std::array<Wave, 6> waves_;
};

// Normal draws on a raster, smoothly joined.
class Noise {
 public:
  Noise(const PlanBounds& area, double cell_m, Random& random)
      : x0_m_(area.x0), y0_m_(area.y0), cell_m_(cell_m) {
    nx_ = static_cast<std::size_t>(std::ceil((area.x1 - area.x0) / cell_m)) + 2;
    const auto ny = static_cast<std::size_t>(std::ceil((area.y1 - area.y0) / cell_m)) + 2;
    values_.resize(nx_ * ny);
    for (double& value : values_) value = random.normal();
  }
  double at(double x, double y) const {
    const double u = (x - x0_m_) / cell_m_;
    const double v = (y - y0_m_) / cell_m_;
    const auto i = static_cast<std::size_t>(u);
    const auto j = static_cast<std::size_t>(v);
    const double s = smooth(u - static_cast<double>(i));
    const double t = smooth(v - static_cast<double>(j));
    const double* row = values_.data() + j * nx_ + i;
    return (1 - t) * ((1 - s) * row[0] + s * row[1]) + t * ((1 - s) * row[nx_] + s * row[nx_ + 1]);
  }

 private:
  double x0_m_;
  double y0_m_;
  double cell_m_;
  std::size_t nx_ = 0;
  std::vector<double> values_;
};

double from_border_m(const PlanBounds& area, double x, double y) {
  return std::min(std::min(x - area.x0, area.x1 - x), std::min(y - area.y0, area.y1 - y));
}

double level(const LevelDisc& disc, double x, double y) {
  const double d = std::hypot(x - disc.x_m, y - disc.y_m);
  return smooth((d - disc.inner_m) / (disc.outer_m - disc.inner_m));
}

template <class Function>
void for_nodes(const HeightGrid& grid, const Function& function) {
  for (std::size_t j = 0; j < grid.ny; ++j) {
    for (std::size_t i = 0; i < grid.nx; ++i) {
      function(j * grid.nx + i, grid.x0_m + kCell_m * static_cast<double>(i),
               grid.y0_m + kCell_m * static_cast<double>(j));
    }
  }
}

double steepest(const HeightGrid& grid, const std::vector<double>& z) {
  double most2 = 0;
  for (std::size_t j = 0; j + 1 < grid.ny; ++j) {
    for (std::size_t i = 0; i + 1 < grid.nx; ++i) {
      const std::size_t n = j * grid.nx + i;
      const double dx = (z[n + 1] - z[n]) / kCell_m;
      const double dy = (z[n + grid.nx] - z[n]) / kCell_m;
      most2 = std::max(most2, dx * dx + dy * dy);
    }
  }
  return std::sqrt(most2);
}

}  // namespace

HeightGrid make_relief(const ReliefConfig& config, Random& random) {
  HeightGrid grid;
  const PlanBounds& area = config.area;
  grid.cell_m = kCell_m;
  grid.x0_m = area.x0;
  grid.y0_m = area.y0;
  grid.nx = static_cast<std::size_t>(std::llround((area.x1 - area.x0) / kCell_m)) + 1;
  grid.ny = static_cast<std::size_t>(std::llround((area.y1 - area.y0) / kCell_m)) + 1;
  grid.z_m.resize(grid.nx * grid.ny);
  const Hills hills(random);
  const Noise coarse(area, kCoarse_m, random);
  const Noise fine(area, kFine_m, random);
  const LevelDisc& start = config.start;
  const double z0 = hills.at(start.x_m, start.y_m);
  std::vector<double>& z = grid.z_m;
  for_nodes(grid, [&](std::size_t n, double x, double y) {
    const double border = smooth(from_border_m(area, x, y) / kFade_m);
    z[n] = border * level(start, x, y) * (hills.at(x, y) - z0);
  });
  const double most = steepest(grid, z);
  const double gain = most > 0 ? std::tan(config.steepest_rad) / most : 0.0;
  std::vector<double> rough(z.size());
  double squares = 0;
  for_nodes(grid, [&](std::size_t n, double x, double y) {
    rough[n] = coarse.at(x, y) + 0.6 * fine.at(x, y);
    squares += rough[n] * rough[n];
  });
  const double scale =
      config.roughness_rms_m / std::sqrt(squares / static_cast<double>(rough.size()));
  for_nodes(grid, [&](std::size_t n, double x, double y) {
    const double part = smooth(from_border_m(area, x, y) / kRoughFade_m) * level(start, x, y);
    z[n] = gain * z[n] + scale * part * rough[n];
  });
  return grid;
}

}  // namespace surefoot::sim
