// Comparison of patches against figure 6 of the paper, written out cell by cell in double.
#include "core/terrain/patch_target.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "tests/support/terrain_parts.h"

namespace surefoot::terrain {
namespace {

struct Cell {
  double height = 0;
  double known = 0;
  double weight = 0;
  double ceiling = kNoCeiling_m;
};

PatchFit by_the_book(const std::vector<Cell>& cells, std::int32_t side,
                     const PatchLibrary::Patch& patch) {
  const auto c = [&](std::int32_t u, std::int32_t v) {
    return static_cast<double>(patch.corner[v * patch.pitch + u]);
  };
  double m = 0;
  double b = 0;
  for (std::int32_t v = 0; v < side; ++v) {
    for (std::int32_t u = 0; u < side; ++u) {
      const Cell& cell = cells[static_cast<std::size_t>(v * side + u)];
      m += cell.known;
      b += cell.known * (cell.height - c(u, v));
    }
  }
  b /= m;
  double s = 0;
  double violation = 0;
  for (std::int32_t v = 0; v < side; ++v) {
    for (std::int32_t u = 0; u < side; ++u) {
      const Cell& cell = cells[static_cast<std::size_t>(v * side + u)];
      s += cell.weight * math::square(c(u, v) - cell.height + b);
      violation += math::square(std::max(c(u, v) + b - cell.ceiling, 0.0));
    }
  }
  return {static_cast<float>(c(side / 2, side / 2) + b), static_cast<float>(s),
          static_cast<float>(violation)};
}

TEST(PatchTarget, AgreesWithFigure6ForEverySize) {
  const auto library = std::make_unique<PatchLibrary>();
  const auto target = std::make_unique<PatchTarget>();
  Random random(5);
  for (std::int32_t side = 3; side <= kMaxPatch_cells; side += 2) {
    tests::fill_library(2, 31, 22, 0.01, side, *library);
    for (int round = 0; round < 20; ++round) {
      target->reset(side);
      std::vector<Cell> cells(static_cast<std::size_t>(side * side));
      for (std::int32_t v = 0; v < side; ++v) {
        for (std::int32_t u = 0; u < side; ++u) {
          Cell& cell = cells[static_cast<std::size_t>(v * side + u)];
          cell.known = random.below(3) == 0 ? 0 : 1;
          cell.height = static_cast<float>(0.5 + 0.02 * random.normal());
          cell.weight = static_cast<float>(cell.known * random.uniform(0.0, 1.0));
          if (cell.known == 0 && random.below(2) == 0) {
            cell.ceiling = static_cast<float>(random.uniform(0.45, 0.55));
          }
          target->set(u, v, static_cast<float>(cell.height), static_cast<float>(cell.known),
                      static_cast<float>(cell.weight), static_cast<float>(cell.ceiling));
        }
      }
      ASSERT_TRUE(target->finish());
      const PatchLibrary::Patch patch = library->draw(random);
      const PatchFit fit = target->fit(patch);
      const PatchFit wanted = by_the_book(cells, side, patch);
      EXPECT_NEAR(fit.height_m, wanted.height_m, 1e-6);
      EXPECT_NEAR(fit.difference, wanted.difference, 1e-5f * wanted.difference + 1e-9f);
      EXPECT_NEAR(fit.violation, wanted.violation, 1e-4f * wanted.violation + 1e-9f);
    }
  }
}

TEST(PatchTarget, APatchOfTheSameShapeFitsAtAnyLevel) {
  const auto library = std::make_unique<PatchLibrary>();
  tests::fill_library(1, 9, 9, 0.01, 9, *library);
  Random random(1);
  const PatchLibrary::Patch patch = library->draw(random);
  PatchTarget target;
  target.reset(9);
  for (std::int32_t v = 0; v < 9; ++v) {
    for (std::int32_t u = 0; u < 9; ++u) {
      const float height = patch.corner[v * patch.pitch + u] + 0.25f;
      target.set(u, v, height, u == 4 && v == 4 ? 0.0f : 1.0f, 1, kNoCeiling_m);
    }
  }
  ASSERT_TRUE(target.finish());
  const PatchFit fit = target.fit(patch);
  EXPECT_NEAR(fit.height_m, patch.corner[4 * patch.pitch + 4] + 0.25f, 1e-6f);
  EXPECT_LT(fit.difference, 1e-11f);
  EXPECT_EQ(fit.violation, 0.0f);
}

TEST(PatchTarget, SaysWhenNothingAroundIsKnown) {
  PatchTarget target;
  target.reset(5);
  EXPECT_FALSE(target.finish());
  target.set(0, 4, 0.1f, 1, 1, kNoCeiling_m);
  EXPECT_TRUE(target.finish());
}

}  // namespace
}  // namespace surefoot::terrain
