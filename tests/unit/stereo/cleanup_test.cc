// Median, speckles and smoothing against what they are defined to be, pixel by pixel.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "core/base/random.h"
#include "core/stereo/smoothing.h"
#include "core/stereo/speckle.h"

namespace surefoot::stereo {
namespace {

std::unique_ptr<DisparityImage> random_disparities(std::uint64_t seed, std::uint16_t width,
                                                   std::uint16_t height, int range,
                                                   std::uint32_t missing_percent) {
  Random random(seed);
  auto image = std::make_unique<DisparityImage>();
  image->width_px = width;
  image->height_px = height;
  for (std::size_t i = 0; i < image->pixel_count(); ++i) {
    const auto value = static_cast<std::int16_t>(
        static_cast<int>(random.below(static_cast<std::uint32_t>(range))) - range / 4);
    const bool missing = random.below(100) < missing_percent;
    image->values[i] = missing ? kNoDisparity : value;
  }
  return image;
}

TEST(Median, EqualsSorting) {
  auto out = std::make_unique<DisparityImage>();
  for (const std::uint16_t width : std::initializer_list<std::uint16_t>{16, 17, 23, 64}) {
    const auto in = random_disparities(width, width, 20, 2000, 40);
    std::uint32_t expected_drops = 0;
    const std::uint32_t dropped = median_filter(*in, *out);
    for (std::size_t v = 0; v < 20; ++v) {
      for (std::size_t u = 0; u < width; ++u) {
        const std::int16_t own = in->row(v)[u];
        if (u == 0 || v == 0 || u + 1 == width || v == 19) {
          ASSERT_EQ(out->row(v)[u], own);
          continue;
        }
        std::vector<std::int16_t> around;
        for (std::size_t i = 0; i < 9; ++i) around.push_back(in->row(v + i / 3 - 1)[u + i % 3 - 1]);
        std::nth_element(around.begin(), around.begin() + 4, around.end());
        ASSERT_EQ(out->row(v)[u], own == kNoDisparity ? kNoDisparity : around[4]);
        if (own != kNoDisparity && around[4] == kNoDisparity) ++expected_drops;
      }
    }
    EXPECT_EQ(dropped, expected_drops);
  }
}

TEST(Smooth, IsTheMeanOfTheSameSurface) {
  auto out = std::make_unique<DisparityImage>();
  for (const std::size_t radius : {1u, 2u, 4u}) {
    const auto in = random_disparities(radius, 40, 24, 200, 30);
    // The largest disparities beside missing ones: differences must not wrap round.
    for (std::size_t i = 0; i < in->pixel_count(); i += 3) {
      if (in->values[i] != kNoDisparity) in->values[i] = 510 * kSubpixels;
    }
    *out = *in;
    smooth(*in, radius, *out);
    for (std::size_t v = radius; v + radius < 24; ++v) {
      for (std::size_t u = 8; u < 32; ++u) {  // whole groups away from the borders
        const int own = in->row(v)[u];
        if (own == kNoDisparity) {
          ASSERT_EQ(out->row(v)[u], kNoDisparity);
          continue;
        }
        double sum = 0;
        double count = 0;
        for (std::size_t y = v - radius; y <= v + radius; ++y) {
          for (std::size_t x = u - radius; x <= u + radius; ++x) {
            const int value = in->row(y)[x];
            if (value == kNoDisparity || std::abs(value - own) > kSubpixels) continue;
            sum += value;
            ++count;
          }
        }
        ASSERT_NEAR(out->row(v)[u], sum / count, 0.5001);
      }
    }
  }
}

// Areas by repeated relabelling.
std::vector<int> areas_of(const DisparityImage& image, int step) {
  const int width = image.width_px;
  const int height = image.height_px;
  std::vector<int> label(image.pixel_count());
  for (std::size_t i = 0; i < label.size(); ++i) label[i] = static_cast<int>(i);
  bool changed = true;
  while (changed) {
    changed = false;
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        const auto here = static_cast<std::size_t>(v * width + u);
        const auto join = [&](std::size_t there) {
          const int a = image.values[here];
          const int b = image.values[there];
          if (a == kNoDisparity || b == kNoDisparity || std::abs(a - b) > step) return;
          const int least = std::min(label[here], label[there]);
          changed = changed || label[here] != least || label[there] != least;
          label[here] = least;
          label[there] = least;
        };
        if (u + 1 < width) join(here + 1);
        if (v + 1 < height) join(here + static_cast<std::size_t>(width));
      }
    }
  }
  return label;
}

TEST(Speckles, AreTheSmallAreas) {
  auto filter = std::make_unique<SpeckleFilter>();
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const auto in = random_disparities(seed, 48, 40, 220, 15);
    const std::vector<int> label = areas_of(*in, kSubpixels);
    std::vector<std::uint32_t> sizes(label.size());
    for (const int l : label) ++sizes[static_cast<std::size_t>(l)];
    for (const std::uint32_t least : {2u, 10u, 100u}) {
      auto out = std::make_unique<DisparityImage>(*in);
      std::uint32_t expected = 0;
      const std::uint32_t dropped = filter->run(least, kSubpixels, *out);
      for (std::size_t i = 0; i < label.size(); ++i) {
        const bool small = sizes[static_cast<std::size_t>(label[i])] < least;
        if (small && in->values[i] != kNoDisparity) ++expected;
        ASSERT_EQ(out->values[i], small ? kNoDisparity : in->values[i]);
      }
      EXPECT_EQ(dropped, expected);
    }
  }
}

TEST(Speckles, NoneAreLookedForBelowTwo) {
  auto filter = std::make_unique<SpeckleFilter>();
  const auto in = random_disparities(1, 20, 20, 4000, 10);
  auto out = std::make_unique<DisparityImage>(*in);
  EXPECT_EQ(filter->run(1, kSubpixels, *out), 0u);
  EXPECT_EQ(out->values, in->values);
}

}  // namespace
}  // namespace surefoot::stereo
