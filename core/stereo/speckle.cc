#include "core/stereo/speckle.h"

namespace surefoot::stereo {

namespace {

bool connected(std::int16_t a, std::int16_t b, std::int32_t step) {
  if (a == kNoDisparity || b == kNoDisparity) return false;
  const std::int32_t difference = a - b;
  return difference <= step && -difference <= step;
}

}  // namespace

// Every look-up halves its way to the root, and the smaller area joins the larger: the ways stay
// shorter than 20 steps.
std::uint32_t SpeckleFilter::root(std::uint32_t pixel) {
  while (parents_[pixel] != pixel) {
    parents_[pixel] = parents_[parents_[pixel]];
    pixel = parents_[pixel];
  }
  return pixel;
}

void SpeckleFilter::join(std::uint32_t a, std::uint32_t b) {
  a = root(a);
  b = root(b);
  if (a == b) return;
  if (sizes_[a] < sizes_[b]) {
    const std::uint32_t other = a;
    a = b;
    b = other;
  }
  parents_[b] = a;
  sizes_[a] += sizes_[b];
}

std::uint32_t SpeckleFilter::run(std::uint32_t least_pixels, std::int16_t step,
                                 DisparityImage& image) {
  if (least_pixels < 2) return 0;
  const std::size_t width = image.width_px;
  std::uint32_t pixel = 0;
  for (std::size_t v = 0; v < image.height_px; ++v) {
    const std::int16_t* row = image.row(v);
    for (std::size_t u = 0; u < width; ++u, ++pixel) {
      parents_[pixel] = pixel;
      sizes_[pixel] = 1;
      const bool beside = u > 0 && connected(row[u], row[u - 1], step);
      if (beside) {
        const std::uint32_t area = root(pixel - 1);
        parents_[pixel] = area;
        ++sizes_[area];
      }
      if (v > 0 && connected(row[u], row[u - width], step)) {
        join(pixel, pixel - static_cast<std::uint32_t>(width));
      }
    }
  }
  std::uint32_t dropped = 0;
  for (pixel = 0; pixel < image.pixel_count(); ++pixel) {
    if (image.values[pixel] == kNoDisparity || sizes_[root(pixel)] >= least_pixels) continue;
    image.values[pixel] = kNoDisparity;
    ++dropped;
  }
  return dropped;
}

}  // namespace surefoot::stereo
