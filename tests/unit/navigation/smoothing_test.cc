#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <memory>

#include "core/base/random.h"
#include "core/navigation/path_smoothing.h"
#include "core/navigation/smoothing_spline.h"
#include "tests/support/samples.h"
#include "tests/unit/navigation/parts.h"

namespace surefoot::navigation {
namespace {

// The same minimum from dense normal equations: (p W + (1 - p) Q R^-1 Q^T * 6) f = p W y, as the
// integral of f''^2 is 6 f^T Q R^-1 Q^T f with R as in the header.
Eigen::MatrixXd dense(const Eigen::VectorXd& x, const Eigen::MatrixXd& y, const Eigen::VectorXd& w,
                      double p) {
  const Eigen::Index n = x.size();
  Eigen::MatrixXd q = Eigen::MatrixXd::Zero(n, n - 2);
  Eigen::MatrixXd r = Eigen::MatrixXd::Zero(n - 2, n - 2);
  for (Eigen::Index i = 0; i < n - 2; ++i) {
    const double h0 = x[i + 1] - x[i];
    const double h1 = x[i + 2] - x[i + 1];
    q(i, i) = 1 / h0;
    q(i + 1, i) = -1 / h0 - 1 / h1;
    q(i + 2, i) = 1 / h1;
    r(i, i) = 2 * (h0 + h1);
    if (i + 1 < n - 2) r(i, i + 1) = r(i + 1, i) = h1;
  }
  const Eigen::MatrixXd bend = 6.0 * q * r.inverse() * q.transpose();
  const Eigen::MatrixXd weight = w.asDiagonal();
  return (p * weight + (1 - p) * bend).ldlt().solve(p * weight * y);
}

TEST(SmoothingSpline, IsTheMinimumThatDenseNormalEquationsGive) {
  Random random(4);
  const auto spline = std::make_unique<SmoothingSpline>();
  double worst = 0;
  for (int sample = 0; sample < tests::samples(300, 20); ++sample) {
    const auto n = static_cast<Eigen::Index>(3 + random.below(60));
    Eigen::VectorXd x(n);
    Eigen::VectorXd w(n);
    Eigen::MatrixXd y(n, 2);
    double at = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      x[i] = at += random.uniform(0.1, 0.4);
      w[i] = random.uniform(0.5, 3.0);
      y(i, 0) = random.normal();
      y(i, 1) = random.normal();
    }
    const double p = random.uniform(0.05, 0.999);
    spline->resize(static_cast<std::size_t>(n));
    for (Eigen::Index i = 0; i < n; ++i) {
      spline->set(static_cast<std::size_t>(i), x[i], Vector2(y(i, 0), y(i, 1)), w[i]);
    }
    spline->fit(p);
    const Eigen::MatrixXd wanted = dense(x, y, w, p);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Vector2 error =
          spline->knot_value(static_cast<std::size_t>(i)) - Vector2(wanted(i, 0), wanted(i, 1));
      worst = std::max(worst, error.norm());
    }
  }
  EXPECT_LT(worst, 1e-9);
}

TEST(SmoothingSpline, IsContinuousToItsSecondDerivative) {
  const auto spline = std::make_unique<SmoothingSpline>();
  spline->resize(10);
  for (std::size_t i = 0; i < 10; ++i) {
    spline->set(i, 0.3 * static_cast<double>(i), Vector2(static_cast<double>(i % 3), 0), 1);
  }
  spline->fit(0.9);
  for (std::size_t i = 1; i + 1 < 10; ++i) {
    std::size_t before = i - 1;
    std::size_t after = i;
    const double x = 0.3 * static_cast<double>(i);
    const SmoothingSpline::Sample a = spline->at(x - 1e-9, before);
    const SmoothingSpline::Sample b = spline->at(x + 1e-9, after);
    EXPECT_LT((a.value - b.value).norm(), 1e-6);
    EXPECT_LT((a.slope - b.slope).norm(), 1e-5);
    EXPECT_LT((a.bend - b.bend).norm(), 1e-4);
  }
}

TEST(PathSmoothing, RoundsAStaircaseAndKeepsItsEnds) {
  const auto smoothing = std::make_unique<PathSmoothing>();
  const NavigationConfig config = test::small_robot();
  smoothing->reset(config.shape);
  const auto map = std::make_unique<CostMap>();
  map->reset(config);
  map->clear(Vector2::Zero());
  RawPath raw;
  for (int i = 0; i < 40; ++i) {
    ASSERT_TRUE(ok(raw.push_back(Vector2(0.2 * i, i % 5 == 0 ? 0.2 : 0.0))));
  }
  const auto path = std::make_unique<Path>();
  const SmoothingResult result = smoothing->smooth(*map, raw, *path);
  EXPECT_EQ(result.tries, 1u);
  EXPECT_LT(((*path)[0].p_O_m - raw[0]).norm(), 0.01);
  EXPECT_LT((path->back().p_O_m - raw.back()).norm(), 0.01);
  for (std::size_t i = 20; i < 60; ++i) EXPECT_LT(std::abs((*path)[i].tangent_O[1]), 0.1);
}

TEST(PathSmoothing, NeverTouchesWhatThePolylineGoesRound) {
  const auto smoothing = std::make_unique<PathSmoothing>();
  NavigationConfig config = test::small_robot();
  config.shape.smoothing_m = 8.0;
  smoothing->reset(config.shape);
  const auto map = std::make_unique<CostMap>();
  map->reset(config);
  map->clear(Vector2::Zero());
  RawPath raw;  // a corner of 90 degrees with a block inside
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(ok(raw.push_back(Vector2(0.2 * i + 0.1, 0.1))));
  for (int i = 1; i < 20; ++i) ASSERT_TRUE(ok(raw.push_back(Vector2(3.9, 0.2 * i + 0.1))));
  for (double x = -1; x < 3.8; x += 0.2) {
    for (double y = 0.3; y < 4; y += 0.2) {
      map->set_cost(map->cell_of(Vector2(x, y)), kLethalCost);
    }
  }
  const auto path = std::make_unique<Path>();
  const SmoothingResult result = smoothing->smooth(*map, raw, *path);
  EXPECT_GT(result.tries, 1u);
  for (const PathPoint& point : *path) EXPECT_FALSE(map->lethal_at(point.p_O_m));
}

}  // namespace
}  // namespace surefoot::navigation
