// The patch library: what it refuses, what it remembers, and that patches are drawn evenly.
#include "core/terrain/patch_library.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <vector>

namespace surefoot::terrain {
namespace {

std::vector<float> numbered(std::int32_t columns, std::int32_t rows, float first) {
  std::vector<float> heights(static_cast<std::size_t>(columns * rows));
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] = first + static_cast<float>(i);
  return heights;
}

TEST(PatchLibrary, RefusesWhatDoesNotFitAndStaysAsItWas) {
  const auto library = std::make_unique<PatchLibrary>();
  const std::vector<float> good = numbered(8, 6, 0);
  EXPECT_EQ(library->add({}, 8, 6, 0.01, good), Status::kUnavailable);
  EXPECT_EQ(library->reset(0.01, 4), Status::kInvalid);
  EXPECT_EQ(library->reset(0.01, 17), Status::kInvalid);
  EXPECT_EQ(library->reset(std::numeric_limits<double>::infinity(), 5), Status::kInvalid);
  ASSERT_EQ(library->reset(0.01, 5), Status::kOk);
  EXPECT_EQ(library->patches(), 0u);
  ASSERT_EQ(library->add({}, 8, 6, 0.01, good), Status::kOk);
  EXPECT_EQ(library->patches(), 8u);  // 4 x 2 places of a 5 x 5 patch
  std::vector<float> bad = good;
  bad[40] = std::nanf("");
  EXPECT_EQ(library->add({}, 8, 6, 0.01, bad), Status::kInvalid);
  EXPECT_EQ(library->add({}, 8, 7, 0.01, good), Status::kInvalid);
  EXPECT_EQ(library->add({}, 8, 6, 0.005, good), Status::kOutOfRange);
  EXPECT_EQ(library->add({}, 8, 4, 0.01, good), Status::kOutOfRange);
  EXPECT_EQ(library->add({}, 8, -6, 0.01, good), Status::kOutOfRange);
  EXPECT_EQ(library->pieces(), 1u);
  EXPECT_EQ(library->patches(), 8u);
}

TEST(PatchLibrary, IsFullByPiecesAndByCells) {
  const auto library = std::make_unique<PatchLibrary>();
  ASSERT_EQ(library->reset(0.01, 3), Status::kOk);
  const std::vector<float> small = numbered(3, 3, 0);
  for (std::size_t k = 0; k < kMaxPieces; ++k) {
    ASSERT_EQ(library->add({}, 3, 3, 0.01, small), Status::kOk);
  }
  EXPECT_EQ(library->add({}, 3, 3, 0.01, small), Status::kExhausted);
  ASSERT_EQ(library->reset(0.01, 3), Status::kOk);
  const std::vector<float> large(200 * 200, 0.5f);
  for (std::size_t k = 0; k < kMaxLibraryCells / large.size(); ++k) {
    ASSERT_EQ(library->add({}, 200, 200, 0.01, large), Status::kOk);
  }
  EXPECT_EQ(library->add({}, 3, 3, 0.01, small), Status::kExhausted);
}

TEST(PatchLibrary, RemembersWhereAPieceCameFrom) {
  const auto library = std::make_unique<PatchLibrary>();
  ASSERT_EQ(library->reset(0.01, 3), Status::kOk);
  Provenance provenance;
  provenance.source = {'r', 'o', 'c', 'k', 's'};
  provenance.seed = 42;
  ASSERT_EQ(library->add(provenance, 4, 5, 0.01, numbered(4, 5, 7)), Status::kOk);
  ASSERT_EQ(library->add(provenance, 4, 5, 0.01, numbered(4, 5, 8)), Status::kOk);
  EXPECT_STREQ(library->piece(0).provenance.source.data(), "rocks");
  EXPECT_EQ(library->piece(0).provenance.seed, 42u);
  EXPECT_NE(library->piece(0).digest, library->piece(1).digest);
  EXPECT_EQ(library->height_m(library->piece(1), 3, 4), 8 + 19.0f);
}

TEST(PatchLibrary, DrawsEveryPatchEquallyOften) {
  const auto library = std::make_unique<PatchLibrary>();
  ASSERT_EQ(library->reset(0.01, 3), Status::kOk);
  ASSERT_EQ(library->add({}, 5, 4, 0.01, numbered(5, 4, 0)), Status::kOk);    // 6 patches
  ASSERT_EQ(library->add({}, 3, 3, 0.01, numbered(3, 3, 100)), Status::kOk);  // 1
  ASSERT_EQ(library->add({}, 4, 5, 0.01, numbered(4, 5, 200)), Status::kOk);  // 6
  std::map<float, int> count;
  Random random(3);
  constexpr int kDraws = 13000;
  for (int k = 0; k < kDraws; ++k) {
    const PatchLibrary::Patch patch = library->draw(random);
    ++count[patch.corner[0]];
    EXPECT_EQ(patch.corner[2 * patch.pitch + 2] - patch.corner[0],
              static_cast<float>(2 * patch.pitch + 2));
  }
  ASSERT_EQ(count.size(), 13u);
  for (const auto& [corner, times] : count) EXPECT_NEAR(times, 1000, 150) << corner;
  EXPECT_EQ(count.count(100), 1u);
  EXPECT_EQ(count.count(7), 1u);    // the last of the first piece
  EXPECT_EQ(count.count(209), 1u);  // the last of the last
}

}  // namespace
}  // namespace surefoot::terrain
