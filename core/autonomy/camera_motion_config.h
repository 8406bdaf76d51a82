// What can be tuned about the stereo camera as an odometer.
#pragma once

#include "core/base/parameters.h"
#include "core/estimation/odometry_fusion_config.h"
#include "core/visual_odometry/config.h"

namespace surefoot::autonomy {

// Defaults are none on purpose (core/base/parameters.h); recommended values:
// core/visual_odometry/README.md, core/estimation/README.md.
struct CameraMotionConfig {
  bool present = false;
  visual_odometry::VisualOdometryConfig camera;
  estimation::FusionConfig fusion;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("camera", self.camera);
    visit.group("fusion", self.fusion);
  }
};

}  // namespace surefoot::autonomy
