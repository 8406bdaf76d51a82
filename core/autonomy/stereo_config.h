// What can be tuned about the stereo camera: when it takes a pair, how the pair is matched, how
// sure its points are.
#pragma once

#include <cstdint>

#include "core/base/parameters.h"
#include "core/stereo/matcher_config.h"
#include "core/stereo/point_cloud.h"

namespace surefoot::autonomy {

// Defaults are none on purpose (core/base/parameters.h); recommended values: docs/robots.md.
struct StereoConfig {
  bool present = false;
  // When: as soon as the trunk is steady after a shift, and at least every period.
  double period_s = 0;
  double least_interval_s = 0;
  double steady_rate_rad_s = 0;
  double steady_speed_m_s = 0;
  // How
  std::uint8_t shrink = 1;
  stereo::MatcherConfig matcher;
  double least_valid_share = 0;
  // The window of the matcher widens what stands in front: its rim is left out.
  std::uint8_t rim_px = 0;
  double rim_step_px = 0;
  stereo::DisparityNoise noise;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("period_s", self.period_s, {0.1, 60.0}, "between pairs, at most while steady");
    visit.real("least_interval_s", self.least_interval_s, {0.1, 60.0}, "between pairs");
    visit.real("steady_rate_rad_s", self.steady_rate_rad_s, {0.001, 10.0},
               "the trunk turns no faster during an exposure");
    visit.real("steady_speed_m_s", self.steady_speed_m_s, {0.001, 10.0},
               "the trunk moves no faster during an exposure");
    visit.integer("shrink", self.shrink, {1, 4}, "pixels of the camera per matched pixel");
    visit.group("matcher", self.matcher);
    visit.real("least_valid_share", self.least_valid_share, {0.0, 1.0},
               "of the pixels that must have a disparity in range: else nothing is mapped");
    visit.integer("rim_px", self.rim_px, {0, 8},
                  "breadth of the rim of what stands in front that is left out");
    visit.real("rim_step_px", self.rim_step_px, {0.1, 100.0},
               "difference of disparity that makes it stand in front");
    stereo::DisparityNoise::describe(self.noise, visit);
  }
};

}  // namespace surefoot::autonomy
