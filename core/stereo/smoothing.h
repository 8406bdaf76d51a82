// Clean-up of the disparities once they are found: the median of the neighbours, then the mean of
// those on the same surface.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/stereo/images.h"

namespace surefoot::stereo {

inline constexpr std::size_t kMaxSmoothRadius_px = 4;

// Median of 3 x 3; a missing one counts as less than all others. A pixel without disparity stays
// so; one of whose neighbourhood most are missing loses its own: their number is returned. Border
// pixels are copied. Width at least 10, height at least 3. Cost: O(pixels).
std::uint32_t median_filter(const DisparityImage& in, DisparityImage& out);

// Mean over the window of those that differ from the pixel by at most one pixel of disparity, to
// 1/64 px. Cost: O(pixels * window).
void smooth(const DisparityImage& in, std::size_t radius_px, DisparityImage& out);

}  // namespace surefoot::stereo
