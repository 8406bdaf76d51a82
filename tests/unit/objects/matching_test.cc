#include "core/objects/matching.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/base/random.h"
#include "tests/support/samples.h"

namespace surefoot::objects {
namespace {

constexpr double kGate_m = 0.7;
constexpr std::size_t kThings = 10;

// Most matches, then least cost: exhaustive over subsets of objects.
std::vector<std::uint16_t> optimal(const std::vector<std::vector<double>>& cost) {
  const std::size_t n = cost.size();
  const std::size_t subsets = std::size_t{1} << n;
  const double miss = 100;
  std::vector<std::vector<double>> best(n + 1, std::vector<double>(subsets, 1e9));
  std::vector<std::vector<std::uint16_t>> pick(n + 1,
                                               std::vector<std::uint16_t>(subsets, kNoObject));
  for (std::size_t used = 0; used < subsets; ++used) best[n][used] = 0;
  for (std::size_t piece = n; piece-- > 0;) {
    for (std::size_t used = 0; used < subsets; ++used) {
      best[piece][used] = best[piece + 1][used] + miss;
      for (std::size_t i = 0; i < n; ++i) {
        if ((used >> i & 1u) != 0 || cost[piece][i] >= kGate_m) continue;
        const double total = cost[piece][i] + best[piece + 1][used | (std::size_t{1} << i)];
        if (total >= best[piece][used]) continue;
        best[piece][used] = total;
        pick[piece][used] = static_cast<std::uint16_t>(i);
      }
    }
  }
  std::vector<std::uint16_t> result(n);
  std::size_t used = 0;
  for (std::size_t piece = 0; piece < n; ++piece) {
    result[piece] = pick[piece][used];
    if (result[piece] != kNoObject) used |= std::size_t{1} << result[piece];
  }
  return result;
}

TEST(Matching, GreedyIsOptimalInAllButAFewScenes) {
  Random random(5);
  const int scenes = tests::samples(1000, 10);
  int same = 0;
  const auto candidates = std::make_unique<Candidates>();
  const auto found = std::make_unique<Assignment>();
  for (int scene = 0; scene < scenes; ++scene) {
    // Things at least 0.5 m apart (else they were one), moved by up to 5 cm: 1.5 m/s and noise at
    // 75 scans a second.
    std::vector<Vector2> things;
    while (things.size() < kThings) {
      const double x = random.uniform(-2.5, 2.5);
      const double y = random.uniform(-2.5, 2.5);
      bool apart = true;
      for (const Vector2& t : things) apart = apart && (t - Vector2(x, y)).norm() > 0.5;
      if (apart) things.emplace_back(x, y);
    }
    std::vector<std::vector<double>> cost(kThings, std::vector<double>(kThings));
    candidates->clear();
    for (std::size_t p = 0; p < kThings; ++p) {
      const double dx = random.uniform(-0.05, 0.05);
      const double dy = random.uniform(-0.05, 0.05);
      for (std::size_t i = 0; i < kThings; ++i) {
        cost[p][i] = (things[p] + Vector2(dx, dy) - things[i]).norm();
        if (cost[p][i] >= kGate_m) continue;
        ASSERT_EQ(
            candidates->push_back({static_cast<float>(cost[p][i]), static_cast<std::uint16_t>(p),
                                   static_cast<std::uint16_t>(i)}),
            Status::kOk);
      }
    }
    match_nearest(*candidates, *found);
    const std::vector<std::uint16_t> wanted = optimal(cost);
    bool equal = true;
    for (std::size_t p = 0; p < kThings; ++p) equal = equal && (*found)[p] == wanted[p];
    same += equal;
  }
  std::printf("greedy equals optimal in %d of %d scenes\n", same, scenes);
  EXPECT_GT(same, 0.99 * scenes);
}

TEST(Matching, TiesGoToTheLowerIndices) {
  Candidates candidates;
  Assignment found;
  for (std::uint16_t p = 3; p-- > 0;) {
    for (std::uint16_t i = 2; i-- > 0;) {
      ASSERT_EQ(candidates.push_back({0.5F, p, i}), Status::kOk);
    }
  }
  match_nearest(candidates, found);
  EXPECT_EQ(found[0], 0);
  EXPECT_EQ(found[1], 1);
  EXPECT_EQ(found[2], kNoObject);
}

}  // namespace
}  // namespace surefoot::objects
