// A picture of depth with the pose it was taken from: what a slow task keeps a copy of while it
// works on it.
#pragma once

#include <algorithm>

#include "core/autonomy/pose_history.h"
#include "core/mapping/depth_image.h"
#include "hal/api/depth_camera_port.h"

namespace surefoot::autonomy {

struct PosedPicture {
  hal::DepthFrame frame{};
  PastPose pose;
  bool has_noise = false;
  mapping::DepthNoise factors{};  // meaningful where has_noise

  // Of each pixel; null: all have the sensor's.
  const mapping::DepthNoise* noise() const { return has_noise ? &factors : nullptr; }

  void assign(const hal::DepthFrame& from, const mapping::DepthNoise* noise,
              const PastPose& taken_from) {
    frame.assign(from);
    pose = taken_from;
    has_noise = noise != nullptr;
    if (!has_noise) return;
    std::copy_n(noise->factors.begin(), std::min(from.pixel_count(), factors.factors.size()),
                factors.factors.begin());
  }

  // Writes every page, so that no later call meets one for the first time.
  void touch() {
    frame.depth.fill(0);
    has_noise = false;
    factors.factors.fill(0);
  }
};

}  // namespace surefoot::autonomy
