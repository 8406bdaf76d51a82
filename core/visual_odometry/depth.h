// The disparities of corners, from the right picture or from a disparity picture that there is
// anyway.
#pragma once

#include "core/stereo/images.h"
#include "core/visual_odometry/config.h"
#include "core/visual_odometry/features.h"

namespace surefoot::visual_odometry {

// Searches the corner's row of the right picture for its patch: every whole disparity, then its
// fraction together with the slopes of the surface. Left without depth: a corner whose patch is not
// there, or alike in two places. Cost: at most disparities x kComparePixels per corner, three sums.
void find_depths(const stereo::GreyView& right, const VisualOdometryConfig& config,
                 Features& features);

// Takes them from the corner's pixel, the slopes from its neighbours.
void read_depths(const stereo::DisparityImage& disparities, const VisualOdometryConfig& config,
                 Features& features);

}  // namespace surefoot::visual_odometry
