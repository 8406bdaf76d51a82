#include "core/objects/segmentation.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <set>
#include <vector>

#include "core/base/random.h"
#include "tests/support/samples.h"
#include "tests/unit/objects/config.h"

namespace surefoot::objects {
namespace {

class Segmentation : public testing::Test {
 protected:
  Segmentation() { segmenter_->reset(config_); }
  void add(double x, double y) {
    ASSERT_EQ(points_->push_back({{x, y}, 1.0F, 1.0F, kNoBeam}), Status::kOk);
  }
  void segment() { segmenter_->segment(*points_, Vector2::Zero(), *pieces_); }

  // Components by flooding over all pairs.
  std::vector<std::size_t> oracle() const {
    const std::size_t n = points_->size();
    std::vector<std::size_t> label(n, n);
    for (std::size_t i = 0; i < n; ++i) {
      if (label[i] != n) continue;
      std::vector<std::size_t> open{i};
      label[i] = i;
      while (!open.empty()) {
        const std::size_t a = open.back();
        open.pop_back();
        for (std::size_t b = 0; b < n; ++b) {
          const Vector2 off = (*points_)[a].p_O_m - (*points_)[b].p_O_m;
          if (label[b] != n || off.squaredNorm() >= config_.merge_m * config_.merge_m) continue;
          label[b] = i;
          open.push_back(b);
        }
      }
    }
    return label;
  }

  ObjectsConfig config_ = test::config();
  std::unique_ptr<SurfacePoints> points_ = std::make_unique<SurfacePoints>();
  std::unique_ptr<Pieces> pieces_ = std::make_unique<Pieces>();
  std::unique_ptr<Segmenter> segmenter_ = std::make_unique<Segmenter>();
};

TEST_F(Segmentation, IsSingleLinkage) {
  Random random(3);
  for (int sample = 0; sample < tests::samples(300, 10); ++sample) {
    points_->clear();
    const double side = random.uniform(1.0, 30.0);
    const std::uint32_t count = random.below(400);
    for (std::uint32_t i = 0; i < count; ++i) {
      const double x = random.uniform(-side, side);
      const double y = random.uniform(-side, side);
      add(x, y);
    }
    segment();
    const std::vector<std::size_t> wanted = oracle();
    std::map<std::uint32_t, std::size_t> match;
    std::set<std::size_t> used;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const auto [at, fresh] = match.emplace(segmenter_->component(i), wanted[i]);
      if (fresh) {
        ASSERT_TRUE(used.insert(wanted[i]).second) << "two for one";
      }
      ASSERT_EQ(at->second, wanted[i]);
    }
  }
}

TEST_F(Segmentation, LinksJustBelowTheDistanceAndNotAtIt) {
  add(10, 0);
  add(10.499, 0);
  add(20, 0);
  add(20.5, 0);
  segment();
  EXPECT_EQ(segmenter_->component(0), segmenter_->component(1));
  EXPECT_NE(segmenter_->component(2), segmenter_->component(3));
  EXPECT_EQ(pieces_->size(), 1u);
  EXPECT_EQ(segmenter_->counters().lone_points, 2u);
}

TEST_F(Segmentation, CutsAWallTheSameWayFromAnySide) {
  const auto cuts = [&](double phase) {
    points_->clear();
    for (int i = 0; i < 600; ++i) add(-30 + 0.1 * i + phase, 5.2);
    segment();
    std::set<int> starts;
    for (const Piece& piece : *pieces_) {
      EXPECT_TRUE(piece.cut);
      EXPECT_LE(piece.extent_m(), 3.0);
      EXPECT_LE(piece.points_O_m.size(), kMaxObjectPoints);
      starts.insert(static_cast<int>(std::floor(piece.centre_O_m[0] / 3)));
    }
    EXPECT_EQ(starts.size(), pieces_->size());
    return starts;
  };
  EXPECT_EQ(cuts(0.0), cuts(0.04));
  EXPECT_EQ(cuts(0.0).size(), 20u);
}

TEST_F(Segmentation, KeepsTheNearestPiecesWhenThereAreTooMany) {
  for (int i = 0; i < 800; ++i) {
    add(2.0 + 1.0 * i, 0);
    add(2.1 + 1.0 * i, 0);
  }
  segment();
  EXPECT_TRUE(pieces_->full());
  EXPECT_EQ(segmenter_->counters().dropped, 800u - kMaxPieces);
  for (const Piece& piece : *pieces_) EXPECT_LT(piece.centre_O_m[0], 2.2 + kMaxPieces);
}

TEST_F(Segmentation, HandlesNothingAndEverythingInOnePlace) {
  segment();
  EXPECT_TRUE(pieces_->empty());
  for (std::size_t i = 0; i < kMaxSurfacePoints; ++i) add(1, 1);
  segment();
  ASSERT_EQ(pieces_->size(), 1u);
  EXPECT_EQ((*pieces_)[0].count, kMaxSurfacePoints);
  EXPECT_EQ((*pieces_)[0].points_O_m.size(), 1u);
}

}  // namespace
}  // namespace surefoot::objects
