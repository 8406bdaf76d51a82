#include "tests/support/rocky_board.h"

#include <algorithm>
#include <cmath>

namespace surefoot::tests {

RockyBoard::RockyBoard(std::uint64_t seed, const BoardOptions& options) : options_(options) {
  Random random(seed, 11);
  for (int i = 0; i < options.features; ++i) {
    Feature feature;
    feature.x_m = random.uniform(-0.5 * options.side_m, 0.5 * options.side_m + options.shift_m);
    feature.y_m = random.uniform(-0.5 * options.side_m, 0.5 * options.side_m);
    feature.radius_m = random.uniform(options.min_radius_m, options.max_radius_m);
    feature.height_m = random.uniform(0.2, 1.0) * options.max_height_m;
    feature.step = options.steps > 0 && i % options.steps == 0;
    features_.push_back(feature);
  }
}

// Bumps add up, steps are plateaus of which the highest shows.
double RockyBoard::height_m(double x_m, double y_m) const {
  double bumps_m = 0;
  double steps_m = 0;
  for (const Feature& feature : features_) {
    const double dx = x_m - feature.x_m;
    const double dy = y_m - feature.y_m;
    if (feature.step) {
      const double farthest = std::max(std::fabs(dx), std::fabs(dy));
      if (farthest < feature.radius_m) steps_m = std::max(steps_m, feature.height_m);
    } else {
      const double ratio2 = (dx * dx + dy * dy) / (feature.radius_m * feature.radius_m);
      bumps_m = std::max(bumps_m, feature.height_m * std::exp(-2.0 * ratio2));
    }
  }
  return std::max(bumps_m, steps_m) + options_.slope * x_m;
}

std::vector<Vector3> RockyBoard::scan(double x_begin_m, int points, Random& random) const {
  std::vector<Vector3> out;
  for (int i = 0; i < points; ++i) {
    const double x_m = x_begin_m + random.uniform() * options_.side_m;
    const double y_m = (random.uniform() - 0.5) * options_.side_m;
    Vector3 p(x_m, y_m, height_m(x_m, y_m));
    for (int axis = options_.vertical_noise_only ? 2 : 0; axis < 3; ++axis) {
      p[axis] += options_.noise_m * random.normal();
    }
    out.push_back(p);
  }
  return out;
}

}  // namespace surefoot::tests
