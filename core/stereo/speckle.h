// Removes connected areas of disparities that are too small to be a surface.
#pragma once

#include <array>
#include <cstdint>

#include "core/stereo/images.h"

namespace surefoot::stereo {

class SpeckleFilter {
 public:
  // Pixels are connected to those above, below and beside that differ by at most `step` (1/64 px).
  // Areas of fewer than `least_pixels` lose their disparities. Returns how many pixels did. Cost:
  // O(pixels).
  std::uint32_t run(std::uint32_t least_pixels, std::int16_t step, DisparityImage& image);

 private:
  std::int32_t root(std::int32_t pixel);
  void join(std::int32_t a, std::int32_t b);

  // Union-find over pixels: the parent, or of a root minus the size of its area.
  std::array<std::int32_t, kMaxPixels> parents_{};
};

}  // namespace surefoot::stereo
