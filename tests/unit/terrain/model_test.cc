// The terrain model as a library and as a prior.
#include "core/terrain/terrain_model.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace surefoot::terrain {
namespace {

double height_m(std::size_t row, std::size_t column) {
  return 0.001 * static_cast<double>(row) - 0.0001 * static_cast<double>(column);
}

std::unique_ptr<TerrainModel> model_of(std::size_t rows) {
  auto model = std::make_unique<TerrainModel>();
  model->cell_m = 0.01;
  model->seed = 901;
  EXPECT_EQ(model->rows.resize(rows), Status::kOk);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < kModelColumns; ++column) {
      model->rows[row].heights_m[column] = height_m(row, column);
    }
  }
  model->prior_residual_m = 0.012;
  for (std::size_t k = 0; k < kModelPriorPoints; ++k) {
    model->prior_heights[k] = 0.001 * static_cast<double>(k);
    model->prior_measured[k] = -0.002 * static_cast<double>(k);
  }
  model->prior_constant = -0.02;
  return model;
}

TEST(TerrainModel, ItsRowsAreOnePieceOfTheLibrary) {
  const auto scratch = std::make_unique<ModelHeights>();
  const auto library = std::make_unique<PatchLibrary>();
  ASSERT_EQ(make_library(*model_of(40), 5, *scratch, *library), Status::kOk);
  ASSERT_EQ(library->pieces(), 1u);
  EXPECT_EQ(library->cell_m(), 0.01);
  EXPECT_EQ(library->patches(), 96u * 36u);
  const Piece& piece = library->piece(0);
  EXPECT_STREQ(piece.provenance.source.data(), "terrain model");
  EXPECT_EQ(piece.provenance.seed, 901u);
  ASSERT_EQ(piece.columns, 100);
  ASSERT_EQ(piece.rows, 40);
  for (std::int32_t row = 0; row < 40; ++row) {
    for (std::int32_t column = 0; column < 100; ++column) {
      ASSERT_EQ(library->height_m(piece, column, row),
                static_cast<float>(
                    height_m(static_cast<std::size_t>(row), static_cast<std::size_t>(column))));
    }
  }
  // Made again it replaces what was there.
  ASSERT_EQ(make_library(*model_of(kModelRows), 3, *scratch, *library), Status::kOk);
  EXPECT_EQ(library->pieces(), 1u);
  EXPECT_EQ(library->patches(), 98u * 98u);
}

TEST(TerrainModel, TooFewRowsOrAWrongSizeAreRefused) {
  const auto scratch = std::make_unique<ModelHeights>();
  const auto library = std::make_unique<PatchLibrary>();
  EXPECT_EQ(make_library(*model_of(0), 3, *scratch, *library), Status::kOutOfRange);
  EXPECT_EQ(make_library(*model_of(4), 5, *scratch, *library), Status::kOutOfRange);
  EXPECT_EQ(make_library(*model_of(5), 5, *scratch, *library), Status::kOk);
  EXPECT_EQ(make_library(*model_of(40), 4, *scratch, *library), Status::kInvalid);
  const auto coarse = model_of(40);
  coarse->cell_m = 2.0;
  EXPECT_EQ(make_library(*coarse, 3, *scratch, *library), Status::kInvalid);
}

TEST(TerrainModel, ItsPriorIsLaidOutForGather) {
  const auto model = model_of(1);
  const HeightPrior prior = make_prior(*model);
  EXPECT_EQ(validate(prior), Status::kOk);
  EXPECT_TRUE(prior.exists());
  ASSERT_EQ(prior.points(), kModelPriorPoints);
  EXPECT_EQ(prior.cell_m, 0.01);
  EXPECT_EQ(prior.residual_m, 0.012);
  // One input at a time: each weight acts on its own.
  const float ceiling_m = 1.0f;
  const auto predicted = [&](std::size_t input) {
    std::vector<float> inputs(prior.inputs(), 0.0f);
    inputs[input] = -1.0f;
    return predict(prior, inputs, ceiling_m);
  };
  const float nothing = predict(prior, std::vector<float>(prior.inputs(), 0.0f), ceiling_m);
  for (const std::size_t k : {std::size_t{1}, std::size_t{84}, kModelPriorPoints - 1}) {
    EXPECT_NEAR(nothing - predicted(k), 0.001 * static_cast<double>(k), 1e-6) << k;
  }
  EXPECT_FLOAT_EQ(prior.weights[kModelPriorPoints + 7], -0.014f);
  EXPECT_FLOAT_EQ(prior.weights[2 * kModelPriorPoints], -0.02f);
}

}  // namespace
}  // namespace surefoot::terrain
