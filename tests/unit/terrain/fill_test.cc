// Fill-Terrain against the paper's figure 6 written out plainly, and what holds for every fill.
#include "core/terrain/fill.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/hash.h"
#include "tests/support/samples.h"
#include "tests/support/terrain_parts.h"

namespace surefoot::terrain {
namespace {

constexpr double kCell_m = 0.01;

struct Bench {
  std::unique_ptr<TerrainGrid> grid = std::make_unique<TerrainGrid>();
  std::unique_ptr<PatchLibrary> library = std::make_unique<PatchLibrary>();
  std::unique_ptr<TerrainFiller> filler = std::make_unique<TerrainFiller>();
  HeightPrior prior = tests::some_prior(kCell_m);

  // Starts a fill of scene `seed`.
  Status start(const FillConfig& config, std::uint64_t seed, std::int32_t columns = 34,
               std::int32_t rows = 28) {
    tests::make_scene(seed, columns, rows, kCell_m, *grid);
    tests::fill_library(3, 40, 30, kCell_m, config.patch_cells, *library);
    const Status status = filler->configure(config);
    return ok(status) ? filler->start(*grid, *library, prior, 0) : status;
  }
  void finish() {
    while (!filler->advance(1'000'000)) {
    }
  }
  std::uint64_t digest() const {
    Fnv64 hash;
    const FilledTerrain& filled = filler->result();
    for (std::int32_t i = 0; i < grid->size(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      hash.byte(static_cast<std::uint8_t>(filled.state[at]));
      hash.word(std::bit_cast<std::uint32_t>(filled.height_m[at]), 4);
      hash.word(std::bit_cast<std::uint32_t>(filled.spread_m[at]), 4);
    }
    return hash.value();
  }
};

// One draw without prior and smoothing, in double, on a plain array. Candidates are those that the
// header promises for a cell and a draw.
std::vector<double> by_the_book(const TerrainGrid& grid, const PatchLibrary& library,
                                const FillConfig& config) {
  const std::int32_t side = config.patch_cells;
  const double deviation = config.weight_deviation * side;
  std::vector<double> height(grid.value_m.begin(), grid.value_m.begin() + grid.size());
  std::vector<bool> known;
  std::vector<bool> respected;
  for (std::int32_t i = 0; i < grid.size(); ++i) {
    known.push_back(grid.knowledge[static_cast<std::size_t>(i)] == Knowledge::kMeasured);
    respected.push_back(grid.knowledge[static_cast<std::size_t>(i)] == Knowledge::kBounded);
  }
  const bool back = config.order == FillOrder::kFarFirst;
  for (std::int32_t x = 0; x < grid.columns; ++x) {
    const std::int32_t column = back ? grid.columns - 1 - x : x;
    for (std::int32_t row = 0; row < grid.rows; ++row) {
      const std::size_t own = grid.index(column, row);
      if (grid.knowledge[own] != Knowledge::kBounded) continue;
      Fnv64 hash;
      for (const std::int64_t word :
           {static_cast<std::int64_t>(config.seed),
            static_cast<std::int64_t>(grid.first.ix + column),
            static_cast<std::int64_t>(grid.first.iy + row), std::int64_t{0}}) {
        hash.word(static_cast<std::uint64_t>(word), 4);
      }
      Random random(hash.value());
      double best_s = 1e300, best_v = 1e300, best_score = 1e300;
      double h_similar = 0, h_least = 0, h_score = 0;
      bool any_valid = false;
      for (int k = 0; k < config.samples; ++k) {
        const PatchLibrary::Patch patch = library.draw(random);
        double m = 0, b = 0, s = 0, v = 0;
        const auto visit = [&](auto&& use) {
          for (std::int32_t dy = -(side / 2); dy <= side / 2; ++dy) {
            for (std::int32_t dx = -(side / 2); dx <= side / 2; ++dx) {
              if (!grid.contains(column + dx, row + dy)) continue;
              const double c =
                  static_cast<double>(patch.corner[(dy + side / 2) * patch.pitch + dx + side / 2]);
              use(grid.index(column + dx, row + dy), c, dx * dx + dy * dy);
            }
          }
        };
        visit([&](std::size_t i, double c, int) {
          m += known[i] ? 1 : 0;
          b += known[i] ? height[i] - c : 0;
        });
        b /= m;
        visit([&](std::size_t i, double c, int square) {
          const double w = std::exp(-square / (2 * deviation * deviation));
          if (known[i]) s += w * math::square(c - height[i] + b);
          if (respected[i]) {
            v += math::square(std::max(c + b - static_cast<double>(grid.value_m[i]), 0.0));
          }
        });
        const double h = static_cast<double>(patch.corner[side / 2 * patch.pitch + side / 2]) + b;
        if (v == 0 && s < best_s) {
          any_valid = true;
          best_s = s;
          h_similar = h;
        }
        if (v < best_v) {
          best_v = v;
          h_least = h;
        }
        const double score = config.rule == SightRule::kNone ? s : s + config.penalty * v;
        if (score < best_score) {
          best_score = score;
          h_score = h;
        }
      }
      height[own] = config.rule == SightRule::kReject ? (any_valid ? h_similar : h_least) : h_score;
      if (config.rule == SightRule::kPenalty) {
        height[own] = std::min(height[own], static_cast<double>(grid.value_m[own]));
        respected[own] = false;
      }
      known[own] = true;
    }
  }
  return height;
}

void compare_with_the_book(SightRule rule, FillOrder order) {
  int cells = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Bench bench;
    FillConfig config = tests::some_fill();
    config.rule = rule;
    config.order = order;
    config.draws = 1;
    config.guide = 0;
    config.seed = static_cast<std::uint32_t>(seed);
    ASSERT_EQ(bench.start(config, seed), Status::kOk);
    bench.finish();
    const std::vector<double> wanted = by_the_book(*bench.grid, *bench.library, config);
    for (std::int32_t cell = 0; cell < bench.grid->size(); ++cell) {
      const auto i = static_cast<std::size_t>(cell);
      if (bench.grid->knowledge[i] != Knowledge::kBounded) continue;
      ++cells;
      ASSERT_NEAR(bench.filler->result().height_m[i], wanted[i], 2e-6) << seed << " cell " << i;
    }
  }
  EXPECT_GT(cells, 500);
}

TEST(Fill, AgreesWithFigure6WithoutCeilings) {
  compare_with_the_book(SightRule::kNone, FillOrder::kRaster);
}
TEST(Fill, AgreesWithFigure6WithRejection) {
  compare_with_the_book(SightRule::kReject, FillOrder::kRaster);
}
TEST(Fill, AgreesWithThePenaltyFromTheFarRim) {
  compare_with_the_book(SightRule::kPenalty, FillOrder::kFarFirst);
}

TEST(Fill, MeasuredStayFilledAreUnderCeilingsUnknownStayUnknown) {
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(tests::samples(12, 3)); ++seed) {
    Bench bench;
    FillConfig config = tests::some_fill();
    config.smoothing_sweeps = seed % 3 == 0 ? 3 : 0;
    config.smoothing_hold = 2;
    ASSERT_EQ(bench.start(config, seed), Status::kOk);
    bench.finish();
    const FilledTerrain& filled = bench.filler->result();
    int measured = 0, unseen = 0, unknown = 0;
    for (std::int32_t cell = 0; cell < bench.grid->size(); ++cell) {
      const auto i = static_cast<std::size_t>(cell);
      switch (bench.grid->knowledge[i]) {
        case Knowledge::kMeasured:
          ++measured;
          ASSERT_EQ(filled.state[i], FilledState::kMeasured);
          ASSERT_EQ(std::bit_cast<std::uint32_t>(filled.height_m[i]),
                    std::bit_cast<std::uint32_t>(bench.grid->value_m[i]));
          ASSERT_EQ(filled.spread_m[i], 0.0f);
          break;
        case Knowledge::kBounded:
          ++unseen;
          ASSERT_EQ(filled.state[i], FilledState::kFilled);
          ASSERT_LE(filled.height_m[i], bench.grid->value_m[i]);
          ASSERT_GE(filled.spread_m[i], 0.0f);
          break;
        case Knowledge::kUnknown:
          ++unknown;
          ASSERT_EQ(filled.state[i], FilledState::kUnknown);
          ASSERT_EQ(filled.height_m[i], 0.0f);
          break;
      }
    }
    EXPECT_EQ(bench.filler->counts().measured, measured);
    EXPECT_EQ(bench.filler->counts().unseen, unseen);
    EXPECT_EQ(bench.filler->counts().unknown, unknown);
    EXPECT_GT(unseen, 50);
    EXPECT_GT(unknown, 3);
    for (std::int32_t draw = 0; draw < config.draws; ++draw) {
      const HeightView view = bench.filler->draw(draw);
      for (std::int32_t row = 0; row < bench.grid->rows; ++row) {
        for (std::int32_t column = 0; column < bench.grid->columns; ++column) {
          const std::size_t i = bench.grid->index(column, row);
          const float height = view.height_m[row * view.pitch + column];
          if (filled.state[i] != FilledState::kUnknown) {
            ASSERT_LE(height, bench.grid->value_m[i]);
          }
        }
      }
    }
  }
}

TEST(Fill, ResultDoesNotDependOnHowTheWorkWasSpread) {
  FillConfig config = tests::some_fill();
  config.smoothing_sweeps = 2;
  config.smoothing_hold = 2;
  Bench whole;
  ASSERT_EQ(whole.start(config, 3), Status::kOk);
  whole.finish();
  for (const std::int64_t work : {std::int64_t{1}, std::int64_t{37}, std::int64_t{5000}}) {
    Bench bench;
    ASSERT_EQ(bench.start(config, 3), Status::kOk);
    std::int64_t calls = 0;
    while (!bench.filler->advance(work)) ++calls;
    EXPECT_EQ(bench.digest(), whole.digest()) << work;
    // A call overshoots by less than a cell, and the whole is what was announced.
    EXPECT_LE(calls, bench.filler->total_work() / work + 1);
    EXPECT_GE(calls, bench.filler->total_work() / (work + bench.filler->cell_work()) - 1);
  }
}

// A robot's window as it fills it: by ticks of 10,000 units, of fewer, or of another number each.
TEST(Fill, AWindowInTicksHasTheBitsOfTheWholeAtOnce) {
  FillConfig config = tests::some_fill();
  config.patch_cells = 3;
  config.guide = 3;
  Bench bench;
  ASSERT_EQ(bench.start(config, 1), Status::kOk);
  tests::make_shadowed_window(kCell_m, *bench.grid);
  const auto fill = [&](auto&& work_of) {
    EXPECT_EQ(bench.filler->start(*bench.grid, *bench.library, bench.prior, 0), Status::kOk);
    std::int64_t ticks = 0;
    for (bool done = false; !done; ++ticks) done = bench.filler->advance(work_of(ticks));
    EXPECT_EQ(bench.filler->counts().unseen, tests::kWindowUnseen);
    return std::pair{ticks, bench.digest()};
  };
  const auto whole = fill([](std::int64_t) { return std::int64_t{1} << 40; });
  EXPECT_EQ(whole.first, 1);
  const auto ticks = fill([](std::int64_t) { return std::int64_t{10'000}; });
  EXPECT_GT(ticks.first, 30);
  EXPECT_EQ(ticks.second, whole.second);
  EXPECT_EQ(fill([](std::int64_t) { return std::int64_t{700}; }).second, whole.second);
  Random random(6);
  const auto uneven = fill([&](std::int64_t) { return std::int64_t{1 + random.below(20'000)}; });
  EXPECT_EQ(uneven.second, whole.second);
}

TEST(Fill, StartsAfreshWhateverWasDoneBefore) {
  Bench first;
  ASSERT_EQ(first.start(tests::some_fill(), 5), Status::kOk);
  first.finish();
  Bench again;
  ASSERT_EQ(again.start(tests::some_fill(), 6, 60, 50), Status::kOk);
  again.finish();
  ASSERT_EQ(again.start(tests::some_fill(), 7), Status::kOk);
  (void)again.filler->advance(3000);  // broken off
  ASSERT_EQ(again.start(tests::some_fill(), 5), Status::kOk);
  again.finish();
  EXPECT_EQ(again.digest(), first.digest());
}

TEST(Fill, MeanAndSpreadAreThoseOfTheDraws) {
  Bench bench;
  ASSERT_EQ(bench.start(tests::some_fill(), 8), Status::kOk);
  bench.finish();
  double widest = 0;
  for (std::int32_t cell = 0; cell < bench.grid->size(); ++cell) {
    const auto i = static_cast<std::size_t>(cell);
    if (bench.grid->knowledge[i] != Knowledge::kBounded) continue;
    double sum = 0;
    double squares = 0;
    for (std::int32_t draw = 0; draw < 4; ++draw) {
      const HeightView view = bench.filler->draw(draw);
      const double h = static_cast<double>(
          view.height_m[cell / view.columns * view.pitch + cell % view.columns]);
      sum += h / 4;
      squares += h * h / 4;
    }
    const double spread = std::sqrt(std::max(squares - sum * sum, 0.0));
    ASSERT_NEAR(bench.filler->result().height_m[i], sum, 1e-7);
    ASSERT_NEAR(bench.filler->result().spread_m[i], spread, 1e-6);
    widest = std::max(widest, spread);
  }
  EXPECT_GT(widest, 0.001);
}

// A cell that stays unseen keeps its height when the window has moved and its surroundings have
// not changed.
TEST(Fill, ACellMeetsTheSameCandidatesInAMovedWindow) {
  Bench bench;
  const FillConfig config = tests::some_fill();
  ASSERT_EQ(bench.start(config, 1), Status::kOk);
  const std::vector<float> heights = tests::rough_heights(77, 60, 40);
  std::vector<float> found;
  for (const std::int32_t shift : {0, 7}) {
    ASSERT_EQ(bench.grid->reset(40, 30, kCell_m, {shift - 12, shift + 4}), Status::kOk);
    for (std::int32_t row = 0; row < 30; ++row) {
      for (std::int32_t column = 0; column < 40; ++column) {
        bench.grid->measure(bench.grid->index(column, row),
                            heights[static_cast<std::size_t>((row + shift) * 60 + column + shift)]);
      }
    }
    const std::size_t hole = bench.grid->index(25 - shift, 19 - shift);
    bench.grid->knowledge[hole] = Knowledge::kUnknown;
    bench.grid->bound(hole, 0.2f);
    ASSERT_EQ(bench.filler->start(*bench.grid, *bench.library, bench.prior, 0), Status::kOk);
    bench.finish();
    found.push_back(bench.filler->result().height_m[hole]);
  }
  EXPECT_EQ(found[0], found[1]);
}

TEST(Fill, WithoutAnythingAroundThePriorDecides) {
  Bench bench;
  ASSERT_EQ(bench.start(tests::some_fill(), 1), Status::kOk);
  ASSERT_EQ(bench.grid->reset(40, 40, kCell_m), Status::kOk);
  bench.grid->measure(0, 0.1f);
  const std::size_t far = bench.grid->index(30, 30);
  bench.grid->bound(far, 0.05f);
  ASSERT_EQ(bench.filler->start(*bench.grid, *bench.library, bench.prior, 0), Status::kOk);
  bench.finish();
  EXPECT_EQ(bench.filler->counts().no_patch, 1);
  // The prior sees the lone ceiling: all inputs but the constant are zero.
  EXPECT_NEAR(bench.filler->result().height_m[far], 0.05 - 0.01, 1e-7);
}

TEST(Fill, SaysWhyItCannotStart) {
  Bench bench;
  FillConfig config = tests::some_fill();
  EXPECT_EQ(bench.filler->start(*bench.grid, *bench.library, bench.prior, 0),
            Status::kUnavailable);  // not configured
  EXPECT_TRUE(bench.filler->advance(10));
  ASSERT_EQ(bench.start(config, 1), Status::kOk);

  const auto empty = std::make_unique<PatchLibrary>();
  EXPECT_EQ(bench.filler->start(*bench.grid, *empty, bench.prior, 0), Status::kUnavailable);
  EXPECT_TRUE(bench.filler->done());  // nothing is under way
  EXPECT_EQ(bench.filler->start(*bench.grid, *bench.library, {}, 0), Status::kUnavailable);

  const auto other = std::make_unique<PatchLibrary>();
  tests::fill_library(1, 20, 20, kCell_m, 5, *other);  // patches of another size
  EXPECT_EQ(bench.filler->start(*bench.grid, *other, bench.prior, 0), Status::kOutOfRange);
  tests::fill_library(1, 20, 20, 0.005, 7, *other);  // finer cells
  EXPECT_EQ(bench.filler->start(*bench.grid, *other, bench.prior, 0), Status::kOutOfRange);
  HeightPrior coarse = bench.prior;
  coarse.cell_m = 0.02;
  EXPECT_EQ(bench.filler->start(*bench.grid, *bench.library, coarse, 0), Status::kOutOfRange);
  HeightPrior broken = bench.prior;
  broken.weights[3] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(bench.filler->start(*bench.grid, *bench.library, broken, 0), Status::kInvalid);
  EXPECT_EQ(bench.filler->start(*bench.grid, *bench.library, bench.prior, std::nan("")),
            Status::kInvalid);

  ASSERT_EQ(bench.grid->reset(10, 10, kCell_m), Status::kOk);
  bench.grid->bound(5, 0.1f);
  EXPECT_EQ(bench.filler->start(*bench.grid, *bench.library, bench.prior, 0), Status::kNotFound);

  config.patch_cells = 6;
  EXPECT_EQ(bench.filler->configure(config), Status::kInvalid);
  config = tests::some_fill();
  config.draws = kMaxDraws + 1;
  EXPECT_EQ(bench.filler->configure(config), Status::kInvalid);
  config = tests::some_fill();
  config.penalty = std::nan("");
  EXPECT_EQ(bench.filler->configure(config), Status::kInvalid);
  config = tests::some_fill();
  config.rule = static_cast<SightRule>(3);
  EXPECT_EQ(bench.filler->configure(config), Status::kInvalid);
}

TEST(Fill, NothingUnseenIsDoneAtOnce) {
  Bench bench;
  ASSERT_EQ(bench.start(tests::some_fill(), 1), Status::kOk);
  ASSERT_EQ(bench.grid->reset(10, 10, kCell_m), Status::kOk);
  for (std::size_t i = 0; i < 100; ++i) bench.grid->measure(i, 0.25f);
  ASSERT_EQ(bench.filler->start(*bench.grid, *bench.library, bench.prior, 0), Status::kOk);
  EXPECT_TRUE(bench.filler->done());
  EXPECT_EQ(bench.filler->result().state[99], FilledState::kMeasured);
  EXPECT_EQ(bench.filler->result().height_m[99], 0.25f);
}

// The largest grid, seen askew: all keys of the order stay within their table.
TEST(Fill, EveryDirectionOfViewFillsTheLargestGrid) {
  Bench bench;
  FillConfig config = tests::some_fill();
  config.samples = 1;
  config.draws = 1;
  ASSERT_EQ(bench.start(config, 1), Status::kOk);
  for (const double view_rad : {0.0, 0.8, 2.4, 3.14159, -2.3, -0.7}) {
    ASSERT_EQ(bench.grid->reset(kMaxSide, kMaxSide, kCell_m), Status::kOk);
    for (std::size_t i = 0; i < kMaxCells; ++i) bench.grid->bound(i, 0.1f);
    for (std::size_t i = 0; i < kMaxCells; i += 97) bench.grid->measure(i, 0.0f);
    ASSERT_EQ(bench.filler->start(*bench.grid, *bench.library, bench.prior, view_rad), Status::kOk);
    bench.finish();
    for (std::size_t i = 0; i < kMaxCells; ++i) {
      ASSERT_NE(bench.filler->result().state[i], FilledState::kUnknown) << view_rad;
    }
  }
}

}  // namespace
}  // namespace surefoot::terrain
