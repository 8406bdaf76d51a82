// Features of the cost against least squares and plain loops, and what weights make of them.
#include "core/terrain/cost.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "tests/support/terrain_parts.h"

namespace surefoot::terrain {
namespace {

constexpr double kCell_m = 0.01;

CostConfig some_cost() {
  CostConfig config;
  config.radius_cells = {1, 2, 4};
  config.slope = {{1.0, 0.8, 0.6}, {1, 2, 3}};
  config.height_difference = {{0.02, 0.04, 0.06}, {1, 1, 1}};
  config.deviation = {{0.01, 0.02, 0.03}, {2, 0, 1}};
  config.roughness = {{200, 150, 100}, {1, 1, 0}};
  return config;
}

struct Ground {
  std::int32_t columns = 0;
  std::int32_t rows = 0;
  std::vector<float> height_m;
  std::vector<FilledState> state;

  HeightView view() const {
    return {height_m.data(), state.data(), columns, rows, columns, kCell_m};
  }
  bool known(std::int32_t c, std::int32_t r) const {
    return c >= 0 && r >= 0 && c < columns && r < rows &&
           state[static_cast<std::size_t>(r * columns + c)] != FilledState::kUnknown;
  }
  double at(std::int32_t c, std::int32_t r) const {
    return static_cast<double>(height_m[static_cast<std::size_t>(r * columns + c)]);
  }
};

Ground rough_ground(std::uint64_t seed, double unknown_share) {
  Ground ground{23, 17, tests::rough_heights(seed, 23, 17), {}};
  Random random(seed, 8);
  for (std::size_t i = 0; i < ground.height_m.size(); ++i) {
    ground.state.push_back(random.uniform() < unknown_share ? FilledState::kUnknown
                                                            : FilledState::kMeasured);
  }
  return ground;
}

WindowFeatures by_the_book(const Ground& ground, std::int32_t column, std::int32_t row,
                           std::int32_t radius) {
  std::vector<Eigen::Vector3d> points;
  double bends = 0;
  double bend = 0;
  for (std::int32_t r = row - radius; r <= row + radius; ++r) {
    for (std::int32_t c = column - radius; c <= column + radius; ++c) {
      if (!ground.known(c, r)) continue;
      points.emplace_back(c * kCell_m, r * kCell_m, ground.at(c, r));
      if (!ground.known(c - 1, r) || !ground.known(c + 1, r) || !ground.known(c, r - 1) ||
          !ground.known(c, r + 1)) {
        continue;
      }
      bends += 1;
      bend += std::abs(ground.at(c - 1, r) + ground.at(c + 1, r) + ground.at(c, r - 1) +
                       ground.at(c, r + 1) - 4 * ground.at(c, r)) /
              (kCell_m * kCell_m);
    }
  }
  WindowFeatures out;
  Eigen::MatrixXd a(points.size(), 3);
  Eigen::VectorXd z(points.size());
  double low = 1e9, high = -1e9, sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    a.row(k) = Eigen::RowVector3d(points[i].x(), points[i].y(), 1);
    z[k] = points[i].z();
    low = std::min(low, points[i].z());
    high = std::max(high, points[i].z());
    sum += points[i].z();
  }
  const double mean = sum / static_cast<double>(points.size());
  double squares = 0;
  for (const Eigen::Vector3d& p : points) squares += (p.z() - mean) * (p.z() - mean);
  out.height_difference_m = high - low;
  out.deviation_m = std::sqrt(squares / static_cast<double>(points.size()));
  out.roughness_per_m = bends > 0 ? bend / bends : 0;
  const auto decomposition = a.colPivHouseholderQr();
  if (decomposition.rank() == 3) {
    const Eigen::Vector3d plane = decomposition.solve(z);
    out.slope = std::hypot(plane.x(), plane.y());
  }
  return out;
}

TEST(Cost, FeaturesAgreeWithLeastSquaresAndPlainLoops) {
  const auto map = std::make_unique<CostMap>();
  ASSERT_EQ(map->configure(some_cost()), Status::kOk);
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Ground ground = rough_ground(seed, 0.1 * static_cast<double>(seed % 4));
    ASSERT_EQ(map->start(), Status::kOk);
    ASSERT_EQ(map->add(ground.view()), Status::kOk);
    for (std::int32_t row = 0; row < ground.rows; ++row) {
      for (std::int32_t column = 0; column < ground.columns; ++column) {
        if (!ground.known(column, row)) continue;
        const CellFeatures features = map->features(column, row);
        const std::array<std::int32_t, 3> radii{1, 2, 4};
        for (std::size_t w = 0; w < 3; ++w) {
          const WindowFeatures wanted = by_the_book(ground, column, row, radii[w]);
          ASSERT_NEAR(features[w].slope, wanted.slope, 1e-7) << column << ' ' << row;
          ASSERT_NEAR(features[w].height_difference_m, wanted.height_difference_m, 1e-9);
          ASSERT_NEAR(features[w].deviation_m, wanted.deviation_m, 1e-8);
          ASSERT_NEAR(features[w].roughness_per_m, wanted.roughness_per_m, 1e-3);
        }
      }
    }
  }
}

TEST(Cost, IsTheWeightedMeanOfCutShares) {
  const auto map = std::make_unique<CostMap>();
  const CostConfig config = some_cost();
  ASSERT_EQ(map->configure(config), Status::kOk);
  const Ground ground = rough_ground(3, 0.1);
  ASSERT_EQ(map->start(), Status::kOk);
  ASSERT_EQ(map->add(ground.view()), Status::kOk);
  int rows = 0;
  while (!map->advance(3)) ++rows;
  EXPECT_EQ(rows, 17 / 3);
  double low = 1, high = 0;
  for (std::int32_t row = 0; row < ground.rows; ++row) {
    for (std::int32_t column = 0; column < ground.columns; ++column) {
      const auto i = static_cast<std::size_t>(row * ground.columns + column);
      if (!ground.known(column, row)) {
        EXPECT_EQ(map->cost(i), 0.0);
        continue;
      }
      double sum = 0;
      const std::array<std::int32_t, 3> radii{1, 2, 4};
      for (std::size_t w = 0; w < 3; ++w) {
        const WindowFeatures f = by_the_book(ground, column, row, radii[w]);
        sum += config.slope.weight[w] * std::min(f.slope / config.slope.scale[w], 1.0);
        sum += config.height_difference.weight[w] *
               std::min(f.height_difference_m / config.height_difference.scale[w], 1.0);
        sum +=
            config.deviation.weight[w] * std::min(f.deviation_m / config.deviation.scale[w], 1.0);
        sum += config.roughness.weight[w] *
               std::min(f.roughness_per_m / config.roughness.scale[w], 1.0);
      }
      const double wanted = sum / (6 + 3 + 3 + 2);
      ASSERT_NEAR(map->cost(i), wanted, 1e-5);
      ASSERT_NEAR(map->spread(i), 0, 1e-3);
      low = std::min(low, wanted);
      high = std::max(high, wanted);
    }
  }
  EXPECT_LT(low, 0.4);  // both ends occur
  EXPECT_GT(high, 0.8);
}

TEST(Cost, LevelGroundIsFreeAndASlopeIsItsTangent) {
  const auto map = std::make_unique<CostMap>();
  ASSERT_EQ(map->configure(some_cost()), Status::kOk);
  Ground ground{30, 20, std::vector<float>(600, 0.3f),
                std::vector<FilledState>(600, FilledState::kFilled)};
  ASSERT_EQ(map->start(), Status::kOk);
  ASSERT_EQ(map->add(ground.view()), Status::kOk);
  while (!map->advance(100)) {
  }
  for (std::size_t i = 0; i < 600; ++i) ASSERT_EQ(map->cost(i), 0.0);
  for (std::int32_t i = 0; i < 600; ++i) {
    ground.height_m[static_cast<std::size_t>(i)] =
        static_cast<float>(0.003 * (i % 30) - 0.004 * (i / 30));
  }
  ASSERT_EQ(map->start(), Status::kOk);
  ASSERT_EQ(map->add(ground.view()), Status::kOk);
  for (const auto& [c, r] : {std::array{0, 0}, std::array{15, 10}, std::array{29, 19}}) {
    for (const WindowFeatures& f : map->features(c, r)) EXPECT_NEAR(f.slope, 0.5, 1e-5);
  }
}

TEST(Cost, SeveralViewsGiveMeanAndSpread) {
  const auto map = std::make_unique<CostMap>();
  ASSERT_EQ(map->configure(some_cost()), Status::kOk);
  std::array<Ground, 3> grounds{rough_ground(1, 0), rough_ground(2, 0), rough_ground(3, 0)};
  std::vector<std::vector<double>> single;
  for (const Ground& ground : grounds) {
    ASSERT_EQ(map->start(), Status::kOk);
    ASSERT_EQ(map->add(ground.view()), Status::kOk);
    while (!map->advance(4)) {
    }
    std::vector<double>& costs = single.emplace_back();
    for (std::size_t i = 0; i < ground.height_m.size(); ++i) costs.push_back(map->cost(i));
  }
  ASSERT_EQ(map->start(), Status::kOk);
  for (const Ground& ground : grounds) {
    ASSERT_EQ(map->add(ground.view()), Status::kOk);
    while (!map->advance(100)) {
    }
  }
  double widest = 0;
  for (std::size_t i = 0; i < single[0].size(); ++i) {
    const double mean = (single[0][i] + single[1][i] + single[2][i]) / 3;
    double squares = 0;
    for (const auto& costs : single) squares += (costs[i] - mean) * (costs[i] - mean) / 3;
    ASSERT_NEAR(map->cost(i), mean, 1e-6);
    ASSERT_NEAR(map->spread(i), std::sqrt(squares), 1e-3);
    widest = std::max(widest, map->spread(i));
  }
  EXPECT_GT(widest, 0.05);
}

TEST(Cost, RefusesWhatMakesNoSense) {
  const auto map = std::make_unique<CostMap>();
  EXPECT_EQ(map->start(), Status::kUnavailable);
  const Ground ground = rough_ground(1, 0);
  EXPECT_EQ(map->add(ground.view()), Status::kUnavailable);
  const auto refused = [&](auto&& change) {
    CostConfig config = some_cost();
    change(config);
    return map->configure(config) == Status::kInvalid;
  };
  EXPECT_TRUE(refused([](CostConfig& c) { c.radius_cells = {1, 1, 2}; }));
  EXPECT_TRUE(refused([](CostConfig& c) { c.radius_cells = {1, 2.5, 3}; }));
  EXPECT_TRUE(refused([](CostConfig& c) { c.radius_cells = {1, 2, kMaxCostRadius + 1}; }));
  EXPECT_TRUE(refused([](CostConfig& c) { c.radius_cells[1] = std::nan(""); }));
  EXPECT_TRUE(refused([](CostConfig& c) { c.slope.scale[0] = 0; }));
  EXPECT_TRUE(refused([](CostConfig& c) { c.deviation.weight[2] = -1; }));
  EXPECT_TRUE(refused([](CostConfig& c) {
    for (FeatureCost* f : {&c.slope, &c.height_difference, &c.deviation, &c.roughness}) {
      f->weight.fill(0);
    }
  }));
  ASSERT_EQ(map->configure(some_cost()), Status::kOk);
  ASSERT_EQ(map->start(), Status::kOk);
  ASSERT_EQ(map->add(ground.view()), Status::kOk);
  HeightView other = ground.view();
  other.rows -= 1;
  EXPECT_EQ(map->add(other), Status::kInvalid);
  other = ground.view();
  other.columns = kMaxSide + 1;
  EXPECT_EQ(map->add(other), Status::kInvalid);
}

}  // namespace
}  // namespace surefoot::terrain
