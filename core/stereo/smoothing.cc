#include "core/stereo/smoothing.h"

#include <algorithm>

#include "core/stereo/byte_lanes.h"

namespace surefoot::stereo {

namespace {

void sort(Words& a, Words& b) {
  const Words low = smaller(a, b);
  b = larger(a, b);
  a = low;
}

// Median of nine by nineteen exchanges (Paeth, Graphics Gems).
Words median_of_nine(Words (&p)[9]) {
  sort(p[1], p[2]);
  sort(p[4], p[5]);
  sort(p[7], p[8]);
  sort(p[0], p[1]);
  sort(p[3], p[4]);
  sort(p[6], p[7]);
  sort(p[1], p[2]);
  sort(p[4], p[5]);
  sort(p[7], p[8]);
  sort(p[0], p[3]);
  sort(p[5], p[8]);
  sort(p[4], p[7]);
  sort(p[3], p[6]);
  sort(p[1], p[4]);
  sort(p[2], p[5]);
  sort(p[4], p[7]);
  sort(p[4], p[2]);
  sort(p[6], p[4]);
  sort(p[4], p[2]);
  return p[4];
}

}  // namespace

std::uint32_t median_filter(const DisparityImage& in, DisparityImage& out) {
  const std::size_t width = in.width_px;
  const std::size_t height = in.height_px;
  out.width_px = in.width_px;
  out.height_px = in.height_px;
  std::copy_n(in.values.begin(), in.pixel_count(), out.values.begin());
  const Words missing = all_lanes(kNoDisparity);
  for (std::size_t v = 1; v + 1 < height; ++v) {
    for (std::size_t begin = 1; begin + 1 < width; begin += kWords) {
      // The last group overlaps the one before; pixels done twice come out the same.
      const std::size_t u = std::min(begin, width - 1 - kWords);
      Words around[9];
      for (std::size_t i = 0; i < 9; ++i) {
        around[i] = load_lanes(in.row(v + i / 3 - 1) + u + i % 3 - 1);
      }
      const Words own = around[4];
      const Words median = median_of_nine(around);
      const Words result = own == missing ? missing : median;
      store_lanes(result, out.row(v) + u);
    }
  }
  std::uint32_t dropped = 0;
  for (std::size_t i = 0; i < in.pixel_count(); ++i) {
    if (in.values[i] != kNoDisparity && out.values[i] == kNoDisparity) ++dropped;
  }
  return dropped;
}

void smooth(const DisparityImage& in, std::size_t radius_px, DisparityImage& out) {
  const std::size_t width = in.width_px;
  const std::size_t height = in.height_px;
  const Words missing = all_lanes(kNoDisparity);
  const Words near = all_lanes<std::int16_t>(kSubpixels);
  for (std::size_t v = 0; v < height; ++v) {
    const std::size_t top = v > radius_px ? v - radius_px : 0;
    const std::size_t bottom = std::min(v + radius_px, height - 1);
    std::size_t u = 0;
    for (; u < width; u += kWords) {
      // A group at the border takes a window cut to what all of its pixels have.
      const std::size_t begin = std::min(u, width - kWords);
      const std::size_t left = std::min(begin, radius_px);
      const std::size_t right = std::min(width - kWords - begin, radius_px);
      const Words own = load_lanes(in.row(v) + begin);
      Words sum{};
      Words count{};
      for (std::size_t row = top; row <= bottom; ++row) {
        const std::int16_t* values = in.row(row) + begin - left;
        for (std::size_t i = 0; i <= left + right; ++i) {
          const Words value = load_lanes(values + i);
          const Words difference = value - own;
          // A missing value minus a large disparity would wrap round.
          const Words taken = (value != missing) & (difference <= near) & (difference >= -near);
          sum += difference & taken;
          count -= taken;
        }
      }
      for (std::size_t i = 0; i < kWords; ++i) {
        if (own[i] == kNoDisparity) continue;
        const std::int32_t half = count[i] / 2;
        const std::int32_t rounded = (sum[i] < 0 ? sum[i] - half : sum[i] + half) / count[i];
        out.row(v)[begin + i] = static_cast<std::int16_t>(own[i] + rounded);
      }
    }
  }
}

}  // namespace surefoot::stereo
