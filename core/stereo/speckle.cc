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
std::int32_t SpeckleFilter::root(std::int32_t pixel) {
  for (;;) {
    const auto at = static_cast<std::size_t>(pixel);
    const std::int32_t parent = parents_[at];
    if (parent < 0) return pixel;
    const std::int32_t above = parents_[static_cast<std::size_t>(parent)];
    if (above >= 0) parents_[at] = above;
    pixel = parent;
  }
}

void SpeckleFilter::join(std::int32_t a, std::int32_t b) {
  a = root(a);
  b = root(b);
  if (a == b) return;
  std::int32_t& size_a = parents_[static_cast<std::size_t>(a)];
  std::int32_t& size_b = parents_[static_cast<std::size_t>(b)];
  if (size_a <= size_b) {  // both negative
    size_a += size_b;
    size_b = a;
  } else {
    size_b += size_a;
    size_a = b;
  }
}

std::uint32_t SpeckleFilter::run(std::uint32_t least_pixels, std::int16_t step,
                                 DisparityImage& image) {
  if (least_pixels < 2) return 0;
  const std::int32_t width = image.width_px;
  std::int32_t pixel = 0;
  for (std::size_t v = 0; v < image.height_px; ++v) {
    const std::int16_t* row = image.row(v);
    for (std::int32_t u = 0; u < width; ++u, ++pixel) {
      std::int32_t& parent = parents_[static_cast<std::size_t>(pixel)];
      parent = -1;
      if (u > 0 && connected(row[u], row[u - 1], step)) {
        parent = root(pixel - 1);
        --parents_[static_cast<std::size_t>(parent)];
      }
      if (v > 0 && connected(row[u], row[u - width], step)) join(pixel, pixel - width);
    }
  }
  std::uint32_t dropped = 0;
  const auto least = static_cast<std::int32_t>(least_pixels);
  for (pixel = 0; pixel < static_cast<std::int32_t>(image.pixel_count()); ++pixel) {
    std::int16_t& value = image.values[static_cast<std::size_t>(pixel)];
    if (value == kNoDisparity || -parents_[static_cast<std::size_t>(root(pixel))] >= least) {
      continue;
    }
    value = kNoDisparity;
    ++dropped;
  }
  return dropped;
}

}  // namespace surefoot::stereo
