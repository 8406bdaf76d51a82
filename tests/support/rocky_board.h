// Rocky boards with known geometry, scanned from above with noise: what the registration is
// measured on (unit tests, surefoot-lab).
#pragma once

#include <vector>

#include "core/base/random.h"
#include "core/math/linear.h"

namespace surefoot::tests {

struct BoardOptions {
  double slope = 0;        // of the board along x
  double noise_m = 0.003;  // of each coordinate of a point
  double side_m = 1.2;     // the first scan covers this square about the origin
  double shift_m = 0.3;    // the second scan covers the square this much farther along x
  int features = 60;       // bumps and steps
  int steps = 2;           // every so many-th is a step: 0 none, 1 all
  double max_height_m = 0.08;
  double min_radius_m = 0.03;  // half the side of a step; two sigma of a bump
  double max_radius_m = 0.12;
  bool vertical_noise_only = false;
};

class RockyBoard {
 public:
  RockyBoard(std::uint64_t seed, const BoardOptions& options);

  double height_m(double x_m, double y_m) const;
  // Points of the square from `x_begin_m`, uniform in x and y, in the board's frame.
  std::vector<Vector3> scan(double x_begin_m, int points, Random& random) const;
  const BoardOptions& options() const { return options_; }

 private:
  struct Feature {
    double x_m = 0;
    double y_m = 0;
    double radius_m = 0;
    double height_m = 0;
    bool step = false;
  };
  BoardOptions options_;
  std::vector<Feature> features_;
};

}  // namespace surefoot::tests
