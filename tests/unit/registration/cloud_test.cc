#include "core/registration/cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "core/base/random.h"
#include "core/math/elementary.h"
#include "core/registration/moments.h"

namespace surefoot::registration {
namespace {

constexpr double kCell_m = 0.03;
using Key = std::tuple<int, int, int>;

std::vector<Vector3> random_points(std::size_t count, double side_m, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vector3> points(count);
  for (Vector3& p : points) {
    for (int axis = 0; axis < 3; ++axis) p[axis] = random.uniform(-side_m, side_m);
  }
  return points;
}

Key key_of(const Vector3& p, double cell_m) {
  const Vector3 index = (p / cell_m).array().floor();
  return {static_cast<int>(index.x()), static_cast<int>(index.y()), static_cast<int>(index.z())};
}

class CloudTest : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(cloud_->reset(kCell_m), Status::kOk); }
  void fill(const std::vector<Vector3>& points) {
    for (const Vector3& p : points) ASSERT_EQ(cloud_->add(p), Status::kOk);
    ASSERT_EQ(cloud_->finish(), Status::kOk);
  }
  std::unique_ptr<Cloud> cloud_ = std::make_unique<Cloud>();
};

TEST_F(CloudTest, EveryLevelHoldsTheMeansOfItsCells) {
  const std::vector<Vector3> points = random_points(3000, 0.4, 1);
  fill(points);
  EXPECT_EQ(cloud_->point_count(), points.size());
  for (int level = 0; level < kLevels; ++level) {
    std::map<Key, std::pair<Vector3, int>> cells;
    for (const Vector3& p : points) {
      auto& cell = cells[key_of(p, cloud_->cell_m(level))];
      cell.first += p;
      ++cell.second;
    }
    EXPECT_EQ(cloud_->first_cell(level + 1) - cloud_->first_cell(level), cells.size());
    for (const auto& [key, sum] : cells) {
      const auto [x, y, z] = key;
      const std::uint16_t cell = cloud_->find(level, {x, y, z});
      ASSERT_NE(cell, Cloud::kNone);
      EXPECT_LT((cloud_->mean_m(cell) - sum.first / sum.second).norm(), 1e-12);
    }
  }
}

TEST_F(CloudTest, NeighboursAreWhatFindFinds) {
  fill(random_points(2000, 0.3, 2));
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    CellPlace place;
    place.x = static_cast<std::int32_t>(random.below(30)) - 15;
    place.y = static_cast<std::int32_t>(random.below(30)) - 15;
    place.z = static_cast<std::int32_t>(random.below(30)) - 15;
    const int level = i % kLevels;
    std::vector<std::uint16_t> visited;
    cloud_->for_neighbours(level, place, [&](std::uint16_t cell) { visited.push_back(cell); });
    std::vector<std::uint16_t> found;
    for (int k = 0; k < 27; ++k) {
      const CellPlace at{place.x + k % 3 - 1, place.y + k / 3 % 3 - 1, place.z + k / 9 - 1};
      const std::uint16_t cell = cloud_->find(level, at);
      if (cell != Cloud::kNone) found.push_back(cell);
    }
    std::sort(visited.begin(), visited.end());
    std::sort(found.begin(), found.end());
    ASSERT_EQ(visited, found);
  }
}

// Every point within one cell of the query is in one of the 27 cells: a brute-force search over all
// points finds no nearer cell mean.
TEST_F(CloudTest, NearestMeanIsThatOfABruteForceSearch) {
  fill(random_points(4000, 0.3, 4));
  const std::vector<Vector3> queries = random_points(500, 0.3, 5);
  for (const Vector3& query : queries) {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < cloud_->first_cell(1); ++i) {
      nearest_m = std::min(nearest_m, (cloud_->mean_m(i) - query).norm());
    }
    double found_m = std::numeric_limits<double>::infinity();
    cloud_->for_neighbours(0, cloud_->place_of(0, query), [&](std::uint16_t cell) {
      found_m = std::min(found_m, (cloud_->mean_m(cell) - query).norm());
    });
    if (nearest_m < kCell_m)
      EXPECT_DOUBLE_EQ(found_m, nearest_m);
    else
      EXPECT_GE(found_m, kCell_m);
  }
}

TEST_F(CloudTest, SurfelsOfATiltedPlaneLieOnIt) {
  const Vector3 normal = Vector3(0.3, -0.2, 0.9).normalized();
  Random random(6);
  std::vector<Vector3> points;
  for (int i = 0; i < 6000; ++i) {
    const double x_m = random.uniform(-0.5, 0.5);
    const double y_m = random.uniform(-0.5, 0.5);
    points.emplace_back(x_m, y_m, -(normal.x() * x_m + normal.y() * y_m) / normal.z());
  }
  fill(points);
  int planes = 0;
  for (int level = 0; level < kLevels; ++level) {
    for (std::size_t i = cloud_->first_cell(level); i < cloud_->first_cell(level + 1); ++i) {
      const Surfel* surfel = cloud_->surfel(level, i);
      if (surfel == nullptr) continue;
      ++planes;
      EXPECT_NEAR(math::magnitude(surfel->normal.dot(normal)), 1.0, 1e-9);
      EXPECT_NEAR(surfel->position_m.dot(normal), 0.0, 1e-9);
      EXPECT_GE(surfel->variance_m2, 0.0);
    }
  }
  EXPECT_GT(planes, 1000);
}

TEST_F(CloudTest, LoneLineAndVolumeHaveNoSurface) {
  std::vector<Vector3> points{{1.0, 1.0, 1.0}};
  for (int i = 0; i < 400; ++i) points.emplace_back(0.001 * i, 0.0, 0.0);
  fill(points);
  for (std::size_t i = 0; i < cloud_->first_cell(1); ++i) {
    EXPECT_EQ(cloud_->surfel(0, i), nullptr);
    EXPECT_TRUE(cloud_->has_no_surface(i));
  }
}

TEST_F(CloudTest, RefusesWhatIsNoPoint) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(cloud_->add({nan, 0, 0}), Status::kInvalid);
  EXPECT_EQ(cloud_->add({0, nan, 0}), Status::kInvalid);
  EXPECT_EQ(cloud_->add({0, 0, -infinity}), Status::kInvalid);
  EXPECT_EQ(cloud_->add({infinity, -infinity, 0}), Status::kInvalid);
  EXPECT_EQ(cloud_->add({1e9, 0, 0}), Status::kOutOfRange);
  EXPECT_EQ(cloud_->add({0, -1e300, 0}), Status::kOutOfRange);
  EXPECT_EQ(cloud_->dropped_points(), 6u);
  EXPECT_EQ(cloud_->point_count(), 0u);
  EXPECT_EQ(cloud_->finish(), Status::kOk);
  EXPECT_EQ(cloud_->first_cell(kLevels), 0u);
  EXPECT_EQ(cloud_->reset(0.0), Status::kInvalid);
  EXPECT_EQ(cloud_->reset(nan), Status::kInvalid);
  EXPECT_EQ(cloud_->reset(-1.0), Status::kInvalid);
}

// Each point in a block of its own is what runs out first; what is there stays usable.
TEST_F(CloudTest, FullIsAStatusAndKnownCellsStillTakePoints) {
  std::size_t taken = 0;
  Status status = Status::kOk;
  for (int i = 0; i < 30000 && ok(status); ++i) {
    status = cloud_->add({8 * kCell_m * (i % 200), 8 * kCell_m * (i / 200), 0.001});
    taken += ok(status) ? 1u : 0u;
  }
  EXPECT_EQ(status, Status::kExhausted);
  EXPECT_EQ(taken, kMaxBlocks);
  EXPECT_EQ(cloud_->add({0, 0, 0.002}), Status::kOk);
  EXPECT_EQ(cloud_->finish(), Status::kExhausted);
  EXPECT_EQ(cloud_->reset(kCell_m), Status::kOk);
  EXPECT_EQ(cloud_->point_count(), 0u);
  EXPECT_EQ(cloud_->find(0, {0, 0, 0}), Cloud::kNone);
}

TEST_F(CloudTest, CellsRunOutToo) {
  std::size_t taken = 0;
  for (int i = 0; i < 40 * 40 * 40; ++i) {
    const Vector3 p =
        kCell_m * Vector3(i % 40, i / 40 % 40, i / 1600) + Vector3::Constant(0.5 * kCell_m);
    taken += ok(cloud_->add(p)) ? 1u : 0u;
  }
  EXPECT_EQ(taken, kMaxFineCells);
  EXPECT_EQ(cloud_->dropped_points(), 64000u - kMaxFineCells);
  EXPECT_EQ(cloud_->finish(), Status::kOk);
}

// Eigen's own solver as the oracle, over random covariances down to flat and needle-like ones.
TEST(PlaneFit, AgreesWithAnEigenSolver) {
  Random random(8);
  for (int i = 0; i < 2000; ++i) {
    Vector3 scale;
    for (int axis = 0; axis < 3; ++axis) scale[axis] = std::pow(10.0, random.uniform(-3, 0));
    Eigen::Matrix3d mix;
    for (int k = 0; k < 9; ++k) mix(k / 3, k % 3) = random.normal();
    std::vector<Vector3> points(40);
    Moments moments;
    for (Vector3& p : points) {
      for (int axis = 0; axis < 3; ++axis) p[axis] = scale[axis] * random.normal();
      p = mix * p + Vector3(0.1, -0.2, 0.3);
      moments.add(p);
    }
    Vector3 mean = Vector3::Zero();
    for (const Vector3& p : points) mean += p / 40.0;
    Matrix3 covariance = Matrix3::Zero();
    for (const Vector3& p : points) covariance += (p - mean) * (p - mean).transpose() / 40.0;
    const Eigen::SelfAdjointEigenSolver<Matrix3> oracle(covariance);
    const PlaneFit fit = fit_plane(moments);
    const double size = oracle.eigenvalues()[2];
    EXPECT_NEAR(fit.across_m2, oracle.eigenvalues()[0], 1e-11 * size);
    EXPECT_NEAR(fit.narrow_m2, oracle.eigenvalues()[1], 1e-9 * size);
    EXPECT_NEAR(fit.wide_m2, oracle.eigenvalues()[2], 1e-9 * size);
    EXPECT_LT((fit.centre_m - mean).norm(), 1e-12);
    if (oracle.eigenvalues()[0] < 0.5 * oracle.eigenvalues()[1] &&
        oracle.eigenvalues()[1] > 1e-4 * size) {
      EXPECT_NEAR(math::magnitude(fit.normal.dot(oracle.eigenvectors().col(0))), 1.0, 1e-6);
    }
  }
}

TEST(PlaneFit, OfOnePlaceIsFinite) {
  Moments moments;
  for (int i = 0; i < 5; ++i) moments.add({0.01, 0.02, 0.03});
  const PlaneFit fit = fit_plane(moments);
  EXPECT_NEAR(fit.wide_m2, 0.0, 1e-18);
  EXPECT_DOUBLE_EQ(fit.normal.norm(), 1.0);
}

// Sums about another centre are those of the moved points.
TEST(Moments, MoveWithTheirCentre) {
  Random random(9);
  Moments near;
  Moments far;
  const Vector3 offset(0.3, -0.1, 0.2);
  for (int i = 0; i < 20; ++i) {
    Vector3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = random.normal();
    near.add(p);
    far.add(p + offset);
  }
  Moments moved;
  moved.add(near, offset, 2.0);
  EXPECT_DOUBLE_EQ(moved.count, 40.0);
  EXPECT_LT((moved.sum_m - 2.0 * far.sum_m).norm(), 1e-12);
  const double differences[] = {moved.xx - 2 * far.xx, moved.xy - 2 * far.xy,
                                moved.xz - 2 * far.xz, moved.yy - 2 * far.yy,
                                moved.yz - 2 * far.yz, moved.zz - 2 * far.zz};
  for (const double difference : differences) EXPECT_NEAR(difference, 0.0, 1e-12);
}

}  // namespace
}  // namespace surefoot::registration
