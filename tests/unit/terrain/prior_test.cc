// The learned height: its inputs cell by cell, and how they turn with the view.
#include "core/terrain/height_prior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "tests/support/terrain_parts.h"

namespace surefoot::terrain {
namespace {

TEST(HeightPrior, InputsAreDifferencesToTheOwnCeilingAndWhatWasSeen) {
  const auto grid = std::make_unique<TerrainGrid>();
  tests::make_scene(2, 20, 16, 0.01, *grid);
  for (const std::int32_t stride : {1, 2}) {
    PriorStencil stencil;
    const std::size_t points = stride == 1 ? 49 : 49 + 16;
    stencil.set(3, stride, 0);
    ASSERT_EQ(stencil.points(), points);
    ASSERT_EQ(prior_points(3, stride), points);
    std::vector<float> inputs(2 * points + 1);
    int compared = 0;
    for (std::int32_t row = 0; row < grid->rows; ++row) {
      for (std::int32_t column = 0; column < grid->columns; ++column) {
        const std::size_t own = grid->index(column, row);
        if (grid->knowledge[own] != Knowledge::kBounded) continue;
        stencil.gather(*grid, column, row, inputs);
        std::vector<std::pair<std::int32_t, std::int32_t>> offsets;
        for (std::int32_t v = -3; v <= 3; ++v) {
          for (std::int32_t u = -3; u <= 3; ++u) offsets.emplace_back(u * stride, v * stride);
        }
        for (std::int32_t v = -2; v <= 2 && stride == 2; ++v) {
          for (std::int32_t u = -2; u <= 2; ++u) {
            if (u % 2 != 0 || v % 2 != 0) offsets.emplace_back(u, v);
          }
        }
        for (std::size_t k = 0; k < points; ++k) {
          float value = 0;
          float seen = 0;
          const std::int32_t c = column + offsets[k].first;
          const std::int32_t r = row + offsets[k].second;
          if (c >= 0 && r >= 0 && c < 20 && r < 16) {
            const auto i = static_cast<std::size_t>(r * 20 + c);
            if (grid->knowledge[i] == Knowledge::kMeasured) seen = 1;
            if (grid->knowledge[i] != Knowledge::kUnknown) {
              value = std::fmin(4.0f,
                                std::fmax(-4.0f, (grid->value_m[i] - grid->value_m[own]) / 0.03f));
            }
          }
          EXPECT_EQ(inputs[k], value);
          EXPECT_EQ(inputs[points + k], seen);
          ++compared;
        }
        EXPECT_EQ(inputs[2 * points], 1.0f);
      }
    }
    EXPECT_GT(compared, 1000);
  }
}

// The same ground, turned with the view by a quarter, gives the same inputs.
TEST(HeightPrior, StencilTurnsWithTheView) {
  constexpr std::int32_t kSide = 21;
  const auto grid = std::make_unique<TerrainGrid>();
  const auto turned = std::make_unique<TerrainGrid>();
  tests::make_scene(4, kSide, kSide, 0.01, *grid);
  ASSERT_EQ(turned->reset(kSide, kSide, 0.01), Status::kOk);
  for (std::int32_t row = 0; row < kSide; ++row) {
    for (std::int32_t column = 0; column < kSide; ++column) {
      // A quarter counter-clockwise about the middle: (c, r) -> (-r, c).
      const std::size_t from = grid->index(column, row);
      const std::size_t to = turned->index(kSide - 1 - row, column);
      turned->knowledge[to] = grid->knowledge[from];
      turned->value_m[to] = grid->value_m[from];
    }
  }
  PriorStencil straight;
  PriorStencil left;
  straight.set(4, 1, 0);
  left.set(4, 1, 0.5 * math::kPi);
  std::vector<float> a(2 * 81 + 1);
  std::vector<float> b(2 * 81 + 1);
  int compared = 0;
  for (std::int32_t row = 0; row < kSide; ++row) {
    for (std::int32_t column = 0; column < kSide; ++column) {
      if (grid->knowledge[grid->index(column, row)] != Knowledge::kBounded) continue;
      straight.gather(*grid, column, row, a);
      left.gather(*turned, kSide - 1 - row, column, b);
      EXPECT_EQ(a, b) << column << ' ' << row;
      ++compared;
    }
  }
  EXPECT_GT(compared, 20);
}

// Ground that mirrors left and right gives the mirrored stencil the same inputs.
TEST(HeightPrior, MirroredStencilSwapsLeftAndRight) {
  const auto grid = std::make_unique<TerrainGrid>();
  const auto other = std::make_unique<TerrainGrid>();
  tests::make_scene(5, 24, 18, 0.01, *grid);
  ASSERT_EQ(other->reset(24, 18, 0.01), Status::kOk);
  for (std::int32_t row = 0; row < 18; ++row) {
    for (std::int32_t column = 0; column < 24; ++column) {
      other->knowledge[other->index(column, 17 - row)] = grid->knowledge[grid->index(column, row)];
      other->value_m[other->index(column, 17 - row)] = grid->value_m[grid->index(column, row)];
    }
  }
  PriorStencil straight;
  PriorStencil mirrored;
  straight.set(3, 2, 0);
  mirrored.set(3, 2, 0, true);
  std::vector<float> a(2 * straight.points() + 1);
  std::vector<float> b(a.size());
  int compared = 0;
  for (std::int32_t row = 0; row < 18; ++row) {
    for (std::int32_t column = 0; column < 24; ++column) {
      if (grid->knowledge[grid->index(column, row)] != Knowledge::kBounded) continue;
      straight.gather(*grid, column, row, a);
      mirrored.gather(*other, column, 17 - row, b);
      EXPECT_EQ(a, b);
      ++compared;
    }
  }
  EXPECT_GT(compared, 20);
}

TEST(HeightPrior, PredictsBelowTheCeilingOnly) {
  HeightPrior prior = tests::some_prior(0.01, 1);
  std::vector<float> inputs(prior.inputs());
  Random random(6);
  double drop = 0;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    inputs[k] = static_cast<float>(random.uniform(-1, 1));
    drop += static_cast<double>(inputs[k]) * static_cast<double>(prior.weights[k]);
  }
  prior.weights[2 * prior.points()] -= 0.05f;  // surely down
  drop -= 0.05 * static_cast<double>(inputs.back());
  inputs.back() = 1;
  drop = 0;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    drop += static_cast<double>(inputs[k]) * static_cast<double>(prior.weights[k]);
  }
  ASSERT_LT(drop, 0);
  EXPECT_NEAR(predict(prior, inputs, 0.2f), 0.2 + drop, 1e-6);
  for (float& weight : prior.weights) weight = -weight;
  EXPECT_EQ(predict(prior, inputs, 0.2f), 0.2f);
}

TEST(HeightPrior, BrokenOnesAreRefused) {
  HeightPrior prior = tests::some_prior(0.01);
  EXPECT_EQ(validate(prior), Status::kOk);
  EXPECT_EQ(validate(HeightPrior{}), Status::kOk);  // none at all is no error
  EXPECT_FALSE(HeightPrior{}.exists());
  prior.weights[7] = std::nanf("");
  EXPECT_EQ(validate(prior), Status::kInvalid);
  prior = tests::some_prior(0.01);
  prior.radius = kMaxPriorRadius + 1;
  EXPECT_EQ(validate(prior), Status::kInvalid);
  prior = tests::some_prior(0.01);
  prior.cell_m = 0;
  EXPECT_EQ(validate(prior), Status::kInvalid);
  prior = tests::some_prior(0.01);
  prior.stride = 0;
  EXPECT_EQ(validate(prior), Status::kInvalid);
}

}  // namespace
}  // namespace surefoot::terrain
