// Rocky boards of ten seeds: error from starts near and far, and that the covariance is honest.
#include <algorithm>
#include <cstdio>
#include <iterator>
#include <vector>

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "tests/support/registration_parts.h"
#include "tests/support/rocky_board.h"
#include "tests/support/samples.h"

namespace surefoot::registration {
namespace {

struct Errors {
  std::vector<double> error_mm;
  std::vector<double> error_deg;
  double surprise = 0;  // mean squared error in units of the covariance; 6 when it is exact
  int not_ok = 0;

  double median_mm() const {
    std::vector<double> sorted = error_mm;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
  double worst_mm() const { return *std::max_element(error_mm.begin(), error_mm.end()); }
};

Errors align_boards(const tests::BoardOptions& options, int points, double scale, int seeds) {
  Errors errors;
  tests::Workbench bench;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(seeds); ++seed) {
    const tests::RockyBoard board(seed, options);
    Random random(seed, 5);
    const std::vector<Vector3> first = board.scan(-0.5 * options.side_m, points, random);
    const std::vector<Vector3> second =
        board.scan(options.shift_m - 0.5 * options.side_m, points, random);
    const SourcePose truth =
        tests::random_motion(random, 0.016 * scale, 1.4 * scale * tests::kRadPerDeg);
    EXPECT_TRUE(bench.configure({}));
    bench.fill(*bench.target, first);
    bench.fill(*bench.source, tests::seen_from(truth, second));
    const Status status = bench.align({.X_TS = {}, .sigma_m = 0.1, .sigma_rad = 0.1});
    errors.not_ok += ok(status) ? 0 : 1;
    const SourcePose& found = bench.result.X_TS;
    errors.error_mm.push_back(1e3 * tests::distance_m(found, truth));
    errors.error_deg.push_back(tests::angle_rad(found, truth) / tests::kRadPerDeg);
    Vector6 error;
    error << found.origin.m - truth.origin.m,
        geometry::to_rotation_vector(found.rotation.matrix * truth.rotation.matrix.transpose());
    const Vector6 solved = bench.result.covariance.llt().solve(error);
    errors.surprise += error.dot(solved) / static_cast<double>(seeds);
  }
  return errors;
}

struct Case {
  const char* name;
  double slope;
  int steps;
};

constexpr Case kCases[] = {{"flat", 0.0, 2}, {"slope", 0.6, 2}, {"bumps", 0.0, 0}};

// All errors of the three kinds of board.
Errors align_all(double scale, int seeds) {
  Errors all;
  for (const Case& board : kCases) {
    tests::BoardOptions options;
    options.slope = board.slope;
    options.steps = board.steps;
    const Errors errors = align_boards(options, 8000, scale, seeds);
    std::printf("  %s, start %.0f mm off: median %.2f mm, worst %.2f mm, surprise %.1f\n",
                board.name, 16 * scale, errors.median_mm(), errors.worst_mm(), errors.surprise);
    all.error_mm.insert(all.error_mm.end(), errors.error_mm.begin(), errors.error_mm.end());
    all.surprise += errors.surprise / static_cast<double>(std::size(kCases));
    all.not_ok += errors.not_ok;
  }
  return all;
}

TEST(Boards, AreAlignedFromNear) {
  const Errors errors = align_all(1, tests::samples(10, 2));
  EXPECT_EQ(errors.not_ok, 0);
  EXPECT_LE(errors.median_mm(), 0.74);
  EXPECT_LE(errors.worst_mm(), 5.0);
}

TEST(Boards, AreAlignedFromFar) {
  const Errors errors = align_all(3, tests::samples(10, 2));
  EXPECT_EQ(errors.not_ok, 0);
  EXPECT_LE(errors.median_mm(), 2.6);
  EXPECT_LE(errors.worst_mm(), 5.0);
}

// A covariance that is too small would make the robot trust a wrong place; one that is far too
// large would waste what was seen.
TEST(Boards, CovarianceIsHonest) {
  const Errors errors = align_all(1, tests::samples(20, 2));
  EXPECT_LT(errors.surprise, 8.0);
  EXPECT_GT(errors.surprise, 0.6);
}

// Nothing but plateaus with vertical faces that the scan from above does not see: all that tells
// about x, y and yaw is where the edges are.
TEST(Boards, OfPlateausAloneAreAligned) {
  tests::BoardOptions options;
  options.steps = 1;
  const Errors errors = align_boards(options, 8000, 1, tests::samples(10, 2));
  std::printf("  plateaus: median %.2f mm, worst %.2f mm\n", errors.median_mm(), errors.worst_mm());
  EXPECT_EQ(errors.not_ok, 0);
  EXPECT_LE(errors.median_mm(), 2.6);
  EXPECT_LE(errors.worst_mm(), 5.0);
}

TEST(Boards, OfFewPointsFallBackToWiderCells) {
  const Errors errors = align_boards({}, 2000, 1, tests::samples(10, 2));
  std::printf("  2000 points: median %.2f mm, worst %.2f mm\n", errors.median_mm(),
              errors.worst_mm());
  EXPECT_EQ(errors.not_ok, 0);
  EXPECT_LE(errors.median_mm(), 5.0);
}

}  // namespace
}  // namespace surefoot::registration
