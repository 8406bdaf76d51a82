// The experiment on unseen terrain: its sensor against geometry, its simple fills by hand, its
// regression against a law it can represent, its statistics against tables.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>

#include "apps/common/statistics.h"
#include "apps/surefoot-lab/terrain/fields.h"
#include "apps/surefoot-lab/terrain/fill_methods.h"
#include "apps/surefoot-lab/terrain/fine_scan.h"
#include "apps/surefoot-lab/terrain/improved_choice.h"
#include "apps/surefoot-lab/terrain/simple_fills.h"
#include "sim_hal/simulator_error.h"
#include "tests/support/terrain_parts.h"

namespace surefoot::apps {
namespace {

using terrain::Knowledge;
using terrain::TerrainGrid;

// Tables of Student's distribution: t of 2.262, 3.250 and 4.781 with 9 degrees of freedom are
// exceeded with 5, 1 and 0.1 %.
TEST(PairedTTest, AgreesWithTables) {
  const auto p_of = [](double t) {
    // Ten differences with mean m and standard deviation 1 have t = m sqrt(10).
    std::vector<double> a;
    for (int i = 0; i < 10; ++i) {
      a.push_back((i % 2 == 0 ? 1 : -1) * std::sqrt(0.9) + t / std::sqrt(10.0));
    }
    return paired_t_test(a, std::vector<double>(10, 0.0));
  };
  EXPECT_NEAR(p_of(2.262), 0.05, 1e-4);
  EXPECT_NEAR(p_of(-3.250), 0.01, 1e-4);
  EXPECT_NEAR(p_of(4.781), 0.001, 1e-5);
  EXPECT_NEAR(p_of(0), 1, 1e-9);
  EXPECT_EQ(paired_t_test({1, 2}, {0, 1}), 0.0);
  EXPECT_EQ(paired_t_test({1, 2}, {1, 2}), 1.0);
  EXPECT_EQ(paired_t_test({1}, {2}), 1.0);
}

// A wall 100 mm high and 50 mm thick across the way, seen from before only.
FineTerrain wall() {
  FineTerrain terrain;
  terrain.columns = 600;
  terrain.rows = 200;
  terrain.z_m.assign(600 * 200, 0.0f);
  for (std::int32_t j = 0; j < 200; ++j) {
    for (std::int32_t i = 300; i < 350; ++i) terrain.z_m[terrain.index(i, j)] = 0.1f;
  }
  return terrain;
}

TEST(FineScan, ShadowOfAWallIsWhereGeometrySaysAndUnderItsCeiling) {
  const FineTerrain terrain = wall();
  ScanOptions options;
  options.first_x_m = options.last_x_m = -0.1;  // one picture, 0.28 m above the level ground
  options.view_x_rad = 0.1;                     // narrow and fine: no sample is missed
  options.rows = 480;
  const FineScan scan = scan_terrain(terrain, options);
  const auto grid = std::make_unique<TerrainGrid>();
  to_grid(terrain, scan, 10, 0, 1, *grid);
  // Along the middle the ray over the far edge, 0.45 m away and 0.18 m below, meets the ground
  // after another 0.45 / 0.18 * 0.1 = 0.25 m.
  for (std::int32_t column = 0; column < 60; ++column) {
    const std::size_t i = grid->index(column, 10);
    const double x_m = (column + 0.5) * 0.01;
    if (x_m > 0.36 && x_m < 0.595) {
      ASSERT_EQ(grid->knowledge[i], Knowledge::kBounded) << x_m;
      const double ray_m = 0.1 - (x_m - 0.35) * 0.18 / 0.45;
      EXPECT_NEAR(grid->value_m[i], ray_m, 0.004) << x_m;
    } else if (x_m > 0.1 && x_m < 0.345) {
      EXPECT_EQ(grid->knowledge[i], Knowledge::kMeasured) << x_m;
      EXPECT_EQ(grid->value_m[i], x_m < 0.3 ? 0.0f : 0.1f);
    }
  }
}

TEST(FineScan, CeilingsAreNeverBelowTheTruth) {
  FineTerrain terrain = wall();
  for (std::size_t i = 0; i < terrain.z_m.size(); ++i) {
    terrain.z_m[i] += static_cast<float>(0.02 * std::sin(0.05 * static_cast<double>(i % 600)) +
                                         0.02 * std::cos(0.07 * static_cast<double>(i / 600)));
  }
  ScanOptions options;
  options.step_m = 0.3;
  options.columns = 80;
  const FineScan scan = scan_terrain(terrain, options);
  int bounded = 0;
  for (std::size_t i = 0; i < terrain.z_m.size(); ++i) {
    if (scan.ceiling_m[i] == kNoSight_m) continue;
    ++bounded;
    ASSERT_GE(scan.ceiling_m[i], terrain.z_m[i]);
  }
  EXPECT_GT(bounded, 10000);
}

// Five cells in a row: 1 m, three unseen, 0.2 m.
std::unique_ptr<TerrainGrid> ditch(float ceiling_m) {
  auto grid = std::make_unique<TerrainGrid>();
  (void)grid->reset(5, 1, 0.01);
  grid->measure(0, 1.0f);
  for (std::size_t i = 1; i < 4; ++i) grid->bound(i, ceiling_m);
  grid->measure(4, 0.2f);
  return grid;
}

TEST(SimpleFills, AreWhatTheirNamesSay) {
  const auto grid = ditch(0.5f);
  EXPECT_EQ(fill_with_ceilings(*grid), (Heights{1.0f, 0.5f, 0.5f, 0.5f, 0.2f}));
  EXPECT_EQ(fill_with_constant(*grid, 0.7f), (Heights{1.0f, 0.7f, 0.7f, 0.7f, 0.2f}));
  // The first ring is {cell 1: 1 m, cell 3: 0.2 m}, then cell 2 takes the lower of both.
  EXPECT_EQ(fill_with_minimum(*grid), (Heights{1.0f, 0.5f, 0.2f, 0.2f, 0.2f}));
  EXPECT_EQ(fill_with_minimum(*ditch(2.0f)), (Heights{1.0f, 1.0f, 0.2f, 0.2f, 0.2f}));
  const Heights smooth = fill_with_smoothed_minimum(*ditch(2.0f));
  EXPECT_EQ(smooth[0], 1.0f);
  EXPECT_GT(smooth[1], smooth[2]);
  EXPECT_GT(smooth[2], smooth[3]);
  EXPECT_GT(smooth[3], 0.2f);
  for (const float height : fill_with_smoothed_minimum(*ditch(0.3f))) EXPECT_LE(height, 1.0f);
  const Heights painted = fill_by_inpainting(*ditch(0.6f));
  EXPECT_EQ(painted[0], 1.0f);
  EXPECT_EQ(painted[4], 0.2f);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_LE(painted[i], 0.6f);
    EXPECT_GE(painted[i], 0.2f - 1e-6f);
  }
}

// Ground that lies 2 cm below the mean of ceiling and right neighbour's ceiling: linear in what
// the regression sees, so it must be found.
TEST(PriorTraining, FindsALinearLaw) {
  auto scene = std::make_unique<ScannedTerrain>();
  (void)scene->seen.reset(60, 60, 0.01);
  (void)scene->truth.reset(60, 60, 0.01);
  Random random(4);
  for (std::int32_t i = 0; i < 3600; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const auto ceiling = static_cast<float>(random.uniform(0.0, 0.05));
    if (random.below(3) == 0) {
      scene->seen.measure(at, ceiling);
    } else {
      scene->seen.bound(at, ceiling);
    }
    scene->truth.measure(at, 0);
  }
  for (std::int32_t row = 0; row < 60; ++row) {
    for (std::int32_t column = 0; column + 1 < 60; ++column) {
      const float own = scene->seen.value_m[scene->seen.index(column, row)];
      const float next = scene->seen.value_m[scene->seen.index(column + 1, row)];
      scene->truth.value_m[scene->truth.index(column, row)] = 0.5f * (own + next) - 0.04f;
    }
  }
  for (std::int32_t row = 0; row < 60; ++row) {
    scene->truth.value_m[scene->truth.index(59, row)] =
        0.5f * scene->seen.value_m[scene->seen.index(59, row)] +
        0.5f * scene->seen.value_m[scene->seen.index(59, row)] - 0.04f;
  }
  PriorOptions options;
  options.radius = 1;
  options.ridge = 1e-6;
  options.least_samples = 1;
  const terrain::HeightPrior prior = train_prior({scene.get()}, options);
  ASSERT_TRUE(prior.exists());
  EXPECT_LT(prior.residual_m, 1e-3);
  // Point (1, 0) of the 3 x 3 lattice has number 5; inputs are in units of 3 cm.
  EXPECT_NEAR(prior.weights[5], 0.5 * 0.03, 5e-4);
  EXPECT_NEAR(prior.weights[3], 0, 5e-4);
  EXPECT_NEAR(prior.weights[2 * 9], -0.04, 1e-3);
}

// Blocks of centimetres, each of millimetre samples.
FineTerrain fine_blocks(std::uint64_t seed) {
  const std::vector<float> heights = tests::rough_heights(seed, 60, 40);
  FineTerrain terrain;
  terrain.columns = 600;
  terrain.rows = 400;
  for (std::size_t i = 0; i < 600 * 400; ++i) {
    terrain.z_m.push_back(heights[i / 600 / 10 * 60 + i % 600 / 10]);
  }
  return terrain;
}

// Every pose on its own is a witness: what it looked over may not be filled above its rays.
TEST(FillMethods, NoFillStandsAboveWhatAnyPoseLookedOver) {
  const FineTerrain terrain = fine_blocks(5);
  ScanOptions options;
  options.columns = 160;
  options.rows = 120;
  options.step_m = 0.1;
  options.last_x_m = 0.2;
  const auto scene = scan(terrain, 10, 0, 1, options);
  const FillMaterial material = make_material({scene.get()}, 10, improved_config(10));
  FillWorker worker(material);
  std::vector<FineScan> of_pose;
  for (double x_m = options.first_x_m; x_m < options.last_x_m + 1e-6; x_m += options.step_m) {
    ScanOptions one = options;
    one.first_x_m = one.last_x_m = x_m;
    of_pose.push_back(scan_terrain(terrain, one));
  }
  ASSERT_EQ(of_pose.size(), 7u);
  for (const FillMethod method : {FillMethod::kPaper, FillMethod::kImproved,
                                  FillMethod::kConstraintsAsHeights, FillMethod::kClippedInpainting,
                                  FillMethod::kMinimumSpread, FillMethod::kSmoothedMinimumSpread}) {
    const Completion completion = worker.complete(method, *scene);
    int filled = 0, looked_over = 0;
    for (std::int32_t cell = 0; cell < scene->seen.size(); ++cell) {
      const auto i = static_cast<std::size_t>(cell);
      const float height_m = completion.mean[i];
      if (scene->seen.knowledge[i] == Knowledge::kMeasured) {
        ASSERT_EQ(completion.state[i], terrain::FilledState::kMeasured);
        ASSERT_EQ(height_m, scene->seen.value_m[i]);
      } else if (scene->seen.knowledge[i] == Knowledge::kUnknown) {
        ASSERT_EQ(completion.state[i], terrain::FilledState::kUnknown);
      } else {
        ++filled;
        const std::size_t sample = terrain.index(10 * (cell % 60) + 5, 10 * (cell / 60) + 5);
        for (const FineScan& pose : of_pose) {
          looked_over += pose.ceiling_m[sample] < kNoSight_m ? 1 : 0;
          ASSERT_LE(height_m, pose.ceiling_m[sample]) << static_cast<int>(method) << " " << i;
          for (const Heights& draw : completion.draws) ASSERT_LE(draw[i], pose.ceiling_m[sample]);
        }
      }
    }
    EXPECT_GT(filled, 200);
    EXPECT_GT(looked_over, 2 * filled);
  }
}

// Rough ground whose unseen cells lie `drop_m` below their ceilings, more or less by `scatter_m`.
std::unique_ptr<ScannedTerrain> shadowed_ground(std::uint64_t seed, double drop_m,
                                                double scatter_m) {
  auto scene = std::make_unique<ScannedTerrain>();
  (void)scene->seen.reset(60, 60, 0.01);
  (void)scene->truth.reset(60, 60, 0.01);
  const std::vector<float> heights = tests::rough_heights(seed, 60, 60);
  Random random(seed, 8);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    scene->truth.measure(i, heights[i]);
    if (i % 60 % 15 < 9) {
      scene->seen.measure(i, heights[i]);
      continue;
    }
    const double gap_m = std::max(drop_m + scatter_m * random.normal(), 0.0);
    scene->seen.bound(i, heights[i] + static_cast<float>(gap_m));
  }
  return scene;
}

ImprovedChoice choice_of(int pieces, double drop_m, double scatter_m) {
  std::vector<std::unique_ptr<ScannedTerrain>> scenes;
  std::vector<const ScannedTerrain*> library;
  for (int k = 0; k < pieces; ++k) {
    scenes.push_back(shadowed_ground(static_cast<std::uint64_t>(k + 1), drop_m, scatter_m));
    library.push_back(scenes.back().get());
  }
  return choose_improved(library, 10);
}

TEST(ImprovedChoice, TakesThePriorWhereItKnowsTheGround) {
  // A constant: all that there is to learn is learned from a handful of cells.
  const ImprovedChoice choice = choice_of(2, 0.03, 0.0);
  EXPECT_EQ(choice.settings.guide, improved_config(10).guide);
  EXPECT_EQ(choice.settings.patch_cells, improved_config(10).patch_cells);
  EXPECT_LT(choice.log_ratio, -choice.error);
}

TEST(ImprovedChoice, LeavesThePriorOutWhereItsRuleIsNone) {
  // The ceilings are anywhere above the ground: on the other side they are elsewhere.
  const ImprovedChoice choice = choice_of(1, 0.08, 0.06);
  EXPECT_EQ(choice.settings.guide, 0);
  EXPECT_EQ(choice.settings.draws, drawn_config(10).draws);
  EXPECT_GT(choice.error, 0);
}

TEST(ImprovedChoice, NothingUnseenOnASideIsNoPrior) {
  const auto scene = shadowed_ground(1, 0.03, 0);
  for (std::size_t i = 0; i < 30 * 60; ++i) scene->seen.measure(i, scene->truth.value_m[i]);
  const ImprovedChoice choice = choose_improved({scene.get()}, 10);
  EXPECT_EQ(choice.settings.guide, 0);
  EXPECT_EQ(choice.error, 0);
}

TEST(ImprovedChoice, ALibraryThatDoesNotFitIsRefusedWithItsSize) {
  const auto scene = shadowed_ground(1, 0.03, 0);
  const std::vector<const ScannedTerrain*> library(40, scene.get());  // 32 pieces fit
  try {
    (void)make_material(library, 10, improved_config(10));
    FAIL() << "taken";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("library of 40 terrains"), std::string::npos)
        << error.what();
  }
  EXPECT_THROW((void)make_material({}, 10, improved_config(10)), std::runtime_error);
}

TEST(RecordedTerrain, GapsCanBeForgotten) {
  const auto scene = shadowed_ground(3, 0.03, 0);
  (void)scene->truth.reset(60, 60, 0.01);
  for (std::size_t i = 0; i < 3600; ++i) {
    if (i % 7 == 0) {
      scene->truth.bound(i, 0.01f);  // an invention
    } else {
      scene->truth.measure(i, 0.02f);
    }
  }
  const TerrainGrid before = scene->seen;
  forget_gaps(*scene);
  EXPECT_FALSE(scene->bridged);
  for (std::size_t i = 0; i < 3600; ++i) {
    if (i % 7 == 0) {
      ASSERT_EQ(scene->seen.knowledge[i], Knowledge::kUnknown);
    } else {
      ASSERT_EQ(scene->seen.knowledge[i], before.knowledge[i]);
      ASSERT_EQ(scene->seen.value_m[i], before.value_m[i]);
    }
  }
}

TEST(RecordedTerrain, IsScaledCutInTwoAndTurned) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / "surefoot-recorded-terrain.asc";
  std::ofstream out(file);
  out << "ncols 80\nnrows 80\nxllcorner 0\nyllcorner 0\ncellsize 0.04\nNODATA_value -9\n";
  for (int row = 79; row >= 0; --row) {  // the file begins in the north
    for (int column = 0; column < 80; ++column) {
      if (column == 40 && row == 20) {
        out << "-9 ";
      } else {
        out << 0.04 * column + 0.02 * row << ' ';
      }
    }
    out << '\n';
  }
  out.close();
  const std::vector<FineTerrain> pieces = recorded_terrain(file, 0.25);
  ASSERT_EQ(pieces.size(), 4u);
  EXPECT_EQ(pieces[0].columns, 800);
  EXPECT_EQ(pieces[0].rows, 400);
  // z = x + y / 2 in the file's metres, and the scale keeps shapes.
  const auto at = [](const FineTerrain& piece, std::int32_t i, std::int32_t j) {
    return piece.z_m[piece.index(i, j)];
  };
  const float base = at(pieces[0], 100, 100);
  EXPECT_NEAR(at(pieces[0], 200, 100) - base, 0.100, 1e-5);
  EXPECT_NEAR(at(pieces[0], 100, 300) - base, 0.100, 1e-5);
  EXPECT_NEAR(at(pieces[2], 100, 100) - base, 0.200, 1e-5);
  EXPECT_EQ(at(pieces[1], 799 - 100, 399 - 100), base);
  // The gap: cell (40, 20) covers millimetres 400 to 410, 200 to 210.
  EXPECT_FALSE(pieces[0].is_true(pieces[0].index(405, 205)));
  EXPECT_NEAR(at(pieces[0], 405, 205), base + 0.305 + 0.0525, 1e-3);
  EXPECT_TRUE(pieces[0].is_true(pieces[0].index(415, 205)));
  EXPECT_THROW((void)recorded_terrain(file, 0.02), sim::SimulatorError);
  EXPECT_THROW((void)recorded_terrain("/nowhere.asc", 1), sim::SimulatorError);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace surefoot::apps
