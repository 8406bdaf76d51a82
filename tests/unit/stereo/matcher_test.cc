// Matching on pictures whose disparity is known, and on those that have none.
#include "core/stereo/matcher.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "core/base/random.h"
#include "tests/support/samples.h"
#include "tests/support/stereo_scene.h"
#include "tests/support/stereo_setup.h"

namespace surefoot::stereo {
namespace {

using Picture = std::vector<std::uint8_t>;

class MatcherTest : public testing::Test {
 protected:
  static constexpr std::uint16_t kWidth = 160;
  static constexpr std::uint16_t kHeight = 60;

  static MatcherConfig config() {
    MatcherConfig config = tests::recommended_matcher();
    config.disparities = 32;
    return config;
  }
  Status match(const Picture& left, const Picture& right, std::uint16_t width = kWidth,
               std::uint16_t height = kHeight) {
    return matcher_->match({left.data(), width, height}, {right.data(), width, height}, *out_,
                           &report_);
  }
  static Picture random_picture(std::uint64_t seed, std::uint16_t width = kWidth) {
    Random random(seed);
    Picture picture(static_cast<std::size_t>(width) * kHeight);
    for (std::uint8_t& grey : picture) grey = static_cast<std::uint8_t>(40 + random.below(160));
    return picture;
  }
  // What the right camera sees when everything in `left` has this disparity.
  static Picture shifted(const Picture& left, int disparity) {
    Picture right(left.size());
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const int from = std::clamp(u + disparity, 0, kWidth - 1);
        right[static_cast<std::size_t>(v * kWidth + u)] =
            left[static_cast<std::size_t>(v * kWidth + from)];
      }
    }
    return right;
  }
  void expect_nothing() {
    EXPECT_EQ(report_.matched, 0u);
    for (std::size_t i = 0; i < out_->pixel_count(); ++i) ASSERT_EQ(out_->values[i], kNoDisparity);
  }

  std::unique_ptr<Matcher> matcher_ = std::make_unique<Matcher>();
  std::unique_ptr<DisparityImage> out_ = std::make_unique<DisparityImage>();
  MatchReport report_;
};

TEST_F(MatcherTest, FindsEveryWholeDisparity) {
  for (const int least : {0, 7, -20}) {
    MatcherConfig settings = config();
    settings.min_disparity_px = static_cast<std::int16_t>(least);
    ASSERT_TRUE(ok(matcher_->configure(settings)));
    for (int disparity = least; disparity < least + 32; ++disparity) {
      const Picture left = random_picture(static_cast<std::uint64_t>(disparity + 100));
      ASSERT_TRUE(ok(match(left, shifted(left, disparity))));
      const int first = std::max(least + 31, 0) + 3;
      const int end = kWidth - std::max(0, -least) - 3;
      for (int v = 3; v < kHeight - 3; ++v) {
        for (int u = first; u < end; ++u) {
          const int other = u - disparity;
          if (other < 3 || other >= kWidth - 3 || u + disparity >= kWidth + disparity - 3) continue;
          ASSERT_NEAR(out_->row(static_cast<std::size_t>(v))[u], disparity * kSubpixels,
                      kSubpixels / 4)
              << "disparity " << disparity << " at " << u << ", " << v;
        }
      }
    }
  }
}

TEST_F(MatcherTest, UniformPicturesHaveNoDisparity) {
  ASSERT_TRUE(ok(matcher_->configure(config())));
  for (const std::uint8_t grey : {std::uint8_t{0}, std::uint8_t{128}, std::uint8_t{255}}) {
    const Picture picture(static_cast<std::size_t>(kWidth) * kHeight, grey);
    ASSERT_TRUE(ok(match(picture, picture)));
    expect_nothing();
    EXPECT_EQ(report_.no_contrast, report_.tried);
  }
}

TEST_F(MatcherTest, FaintNoiseAloneHasNoDisparity) {
  ASSERT_TRUE(ok(matcher_->configure(config())));
  Random random(5);
  Picture left(static_cast<std::size_t>(kWidth) * kHeight);
  Picture right(left.size());
  for (std::uint8_t& grey : left) grey = static_cast<std::uint8_t>(100 + random.below(6));
  for (std::uint8_t& grey : right) grey = static_cast<std::uint8_t>(100 + random.below(6));
  ASSERT_TRUE(ok(match(left, right)));
  expect_nothing();
}

TEST_F(MatcherTest, UnrelatedPicturesGiveLittle) {
  ASSERT_TRUE(ok(matcher_->configure(config())));
  ASSERT_TRUE(ok(match(random_picture(1), random_picture(2))));
  EXPECT_LT(report_.matched, report_.tried / 10);
}

TEST_F(MatcherTest, SaturatedPartsHaveNoDisparity) {
  ASSERT_TRUE(ok(matcher_->configure(config())));
  Picture left = random_picture(3);
  for (int v = 0; v < kHeight; ++v) {
    std::fill_n(left.begin() + v * kWidth + 80, 40, std::uint8_t{255});
  }
  ASSERT_TRUE(ok(match(left, shifted(left, 10))));
  EXPECT_GT(report_.no_contrast, 0u);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 84; u < 115; ++u) {
      ASSERT_EQ(out_->row(static_cast<std::size_t>(v))[u], kNoDisparity);
    }
  }
  EXPECT_NEAR(out_->row(30)[60], 10 * kSubpixels, kSubpixels / 4);
}

TEST_F(MatcherTest, SwappedPicturesGiveLittle) {
  ASSERT_TRUE(ok(matcher_->configure(config())));
  const Picture left = random_picture(4);
  ASSERT_TRUE(ok(match(shifted(left, 12), left)));
  EXPECT_LT(report_.matched, report_.tried / 10);
}

TEST_F(MatcherTest, BrightnessOfOneCameraDoesNotMatter) {
  ASSERT_TRUE(ok(matcher_->configure(config())));
  const Picture left = random_picture(6);
  Picture right = shifted(left, 9);
  for (std::uint8_t& grey : right) grey = static_cast<std::uint8_t>(grey * 3 / 4 + 20);
  ASSERT_TRUE(ok(match(left, right)));
  EXPECT_GT(report_.matched, report_.tried * 9 / 10);
  EXPECT_NEAR(out_->row(30)[90], 9 * kSubpixels, kSubpixels / 4);
}

// Which of the repetitions is taken cannot be known; a place between them would be wrong.
TEST_F(MatcherTest, RepeatedPatternGivesARepetition) {
  ASSERT_TRUE(ok(matcher_->configure(config())));
  Random random(10);
  Picture left(static_cast<std::size_t>(kWidth) * kHeight);
  Picture right(left.size());
  for (std::size_t i = 0; i < left.size(); ++i) {
    const std::uint32_t grey = 50 + 20 * static_cast<std::uint32_t>(i % kWidth % 8);
    left[i] = static_cast<std::uint8_t>(grey + random.below(5));
    right[i] = static_cast<std::uint8_t>(grey + random.below(5));
  }
  ASSERT_TRUE(ok(match(left, right)));
  EXPECT_GT(report_.ambiguous, 0u);
  for (std::size_t i = 0; i < out_->pixel_count(); ++i) {
    if (out_->values[i] == kNoDisparity) continue;
    const int beside = (out_->values[i] + kSubpixels / 2) % (8 * kSubpixels);
    ASSERT_LT(beside, kSubpixels) << out_->values[i];
  }
}

TEST_F(MatcherTest, PicturesNarrowerThanTheDisparitiesGiveNone) {
  MatcherConfig settings = config();
  settings.disparities = 256;
  ASSERT_TRUE(ok(matcher_->configure(settings)));
  const Picture left = random_picture(7);
  ASSERT_TRUE(ok(match(left, shifted(left, 9))));
  EXPECT_EQ(report_.tried, 0u);
  expect_nothing();
}

TEST_F(MatcherTest, EveryPixelIsCountedOnce) {
  ASSERT_TRUE(ok(matcher_->configure(config())));
  const Picture left = random_picture(8);
  Picture right = shifted(left, 14);
  const Picture other = random_picture(9);
  std::copy(other.begin() + kWidth * 20, other.begin() + kWidth * 35, right.begin() + kWidth * 20);
  ASSERT_TRUE(ok(match(left, right)));
  EXPECT_EQ(report_.tried, report_.matched + report_.no_contrast + report_.ambiguous +
                               report_.one_sided + report_.outliers + report_.speckles);
}

TEST_F(MatcherTest, RefusesWhatItCannotMatch) {
  const Picture picture = random_picture(1, 1040);
  EXPECT_EQ(match(picture, picture), Status::kInvalid);  // not configured
  ASSERT_TRUE(ok(matcher_->configure(config())));
  out_->width_px = 7;
  EXPECT_EQ(match(picture, picture, 15, 20), Status::kInvalid);
  EXPECT_EQ(match(picture, picture, 20, 15), Status::kInvalid);
  EXPECT_EQ(match(picture, picture, 1040, 20), Status::kInvalid);
  EXPECT_EQ(matcher_->match({picture.data(), 64, 20}, {picture.data(), 63, 20}, *out_),
            Status::kInvalid);
  EXPECT_EQ(out_->width_px, 7);
}

TEST_F(MatcherTest, SmallestPictures) {
  MatcherConfig settings = config();
  settings.disparities = 16;
  ASSERT_TRUE(ok(matcher_->configure(settings)));
  const Picture picture = random_picture(1);
  EXPECT_TRUE(ok(match(picture, picture, 16, 16)));
  EXPECT_TRUE(ok(match(picture, picture, 17, 16)));
  EXPECT_TRUE(ok(match(picture, picture, 31, 16)));
}

TEST_F(MatcherTest, RefusesBadConfiguration) {
  const auto refused = [&](auto change) {
    MatcherConfig settings = config();
    change(settings);
    return matcher_->configure(settings) == Status::kInvalid;
  };
  EXPECT_TRUE(refused([](MatcherConfig& c) { c.disparities = 24; }));
  EXPECT_TRUE(refused([](MatcherConfig& c) { c.disparities = 0; }));
  EXPECT_TRUE(refused([](MatcherConfig& c) { c.disparities = 272; }));
  EXPECT_TRUE(refused([](MatcherConfig& c) { c.jump_penalty = 62; }));
  EXPECT_TRUE(refused([](MatcherConfig& c) { c.jump_penalty = 4; }));
  EXPECT_TRUE(refused([](MatcherConfig& c) { c.step_penalty = 0; }));
  EXPECT_TRUE(refused([](MatcherConfig& c) { c.uniqueness_percent = 100; }));
  EXPECT_FALSE(refused([](MatcherConfig&) {}));
}

// The largest penalties and the least similar pictures: no path cost may leave its byte.
TEST_F(MatcherTest, ExtremeSettingsStayInRange) {
  for (const std::uint16_t disparities : std::initializer_list<std::uint16_t>{16, 256}) {
    MatcherConfig settings = config();
    settings.disparities = disparities;
    settings.step_penalty = kMaxJumpPenalty;
    settings.jump_penalty = kMaxJumpPenalty;
    settings.edge_relief = 0;
    settings.uniqueness_percent = 0;
    settings.left_right_tolerance_px = 16;
    settings.min_contrast = 0;
    ASSERT_TRUE(ok(matcher_->configure(settings)));
    constexpr std::uint16_t kWide = 400;
    Picture left(static_cast<std::size_t>(kWide) * kHeight);
    for (std::size_t i = 0; i < left.size(); ++i) {
      left[i] = (i % kWide / 3 + i / kWide / 3) % 2 == 0 ? 0 : 255;
    }
    Picture right = left;
    for (std::uint8_t& grey : right) grey = static_cast<std::uint8_t>(255 - grey);
    ASSERT_TRUE(ok(match(left, right, kWide, kHeight)));
    for (std::size_t i = 0; i < out_->pixel_count(); ++i) {
      const std::int16_t value = out_->values[i];
      ASSERT_TRUE(value == kNoDisparity || (value >= 0 && value < disparities * kSubpixels));
    }
  }
}

TEST_F(MatcherTest, RenderedStonesAreMatched) {
  const int seeds = tests::samples(4, 1);
  for (int seed = 1; seed <= seeds; ++seed) {
    tests::StereoSceneOptions options;
    options.seed = static_cast<std::uint64_t>(seed);
    const tests::StereoScene scene = tests::render_stereo_scene(options);
    ASSERT_TRUE(ok(matcher_->configure(tests::recommended_matcher())));
    ASSERT_TRUE(ok(matcher_->match(scene.left_view(), scene.right_view(), *out_, &report_)));
    const tests::DisparityQuality quality = tests::judge_disparities(
        out_->values.data(), kSubpixels, scene.disparity_px, scene.width_px, 64);
    EXPECT_GT(quality.density, 0.97);
    EXPECT_LT(quality.wrong, 0.012);
    EXPECT_LT(quality.rms_px, 0.26);
  }
}

}  // namespace
}  // namespace surefoot::stereo
