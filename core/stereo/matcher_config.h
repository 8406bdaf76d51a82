// What can be tuned about the matching. Recommended values: README.md.
#pragma once

#include <cstdint>

#include "core/base/parameters.h"
#include "core/base/status.h"

namespace surefoot::stereo {

inline constexpr std::uint16_t kMaxDisparities = 256;
// Three path costs of at most 24 bits of the census + the jump penalty fill a byte.
inline constexpr std::uint8_t kMaxMatchCost = 24;
inline constexpr std::uint8_t kMaxJumpPenalty = 255 / 3 - kMaxMatchCost;

// Defaults are none on purpose (core/base/parameters.h).
struct MatcherConfig {
  std::int16_t min_disparity_px = 0;
  std::uint16_t disparities = 0;  // how many are tried, from the least on
  std::uint8_t step_penalty = 0;  // for a change of one pixel between neighbours
  std::uint8_t jump_penalty = 0;  // for a larger one
  std::uint8_t edge_relief = 0;   // how much less a jump costs where the picture changes
  std::uint8_t uniqueness_percent = 0;
  std::uint8_t left_right_tolerance_px = 0;
  std::uint8_t min_contrast = 0;
  std::uint16_t speckle_pixels = 0;
  std::uint8_t speckle_step_px = 0;
  std::uint8_t smooth_radius_px = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.integer("min_disparity_px", self.min_disparity_px, {-256, 255}, "least disparity");
    visit.integer("disparities", self.disparities, {16, kMaxDisparities},
                  "number of disparities, a multiple of 16");
    visit.integer("step_penalty", self.step_penalty, {1, kMaxJumpPenalty},
                  "for neighbours one disparity apart, in bits of the census");
    visit.integer("jump_penalty", self.jump_penalty, {1, kMaxJumpPenalty},
                  "for neighbours farther apart, at least the step penalty");
    visit.integer("edge_relief", self.edge_relief, {0, 64},
                  "sixteenths of a bit that a jump costs less per grey level between the pixels");
    visit.integer("uniqueness_percent", self.uniqueness_percent, {0, 60},
                  "by which the best sum must undercut all but its neighbours");
    visit.integer("left_right_tolerance_px", self.left_right_tolerance_px, {0, 16},
                  "between the views of the left and of the right camera");
    visit.integer("min_contrast", self.min_contrast, {0, 255},
                  "grey levels that the 7 x 7 pixels around must span");
    visit.integer("speckle_pixels", self.speckle_pixels, {0, 10000},
                  "smaller connected areas are dropped");
    visit.integer("speckle_step_px", self.speckle_step_px, {1, 16},
                  "disparity between neighbours that counts as connected");
    visit.integer("smooth_radius_px", self.smooth_radius_px, {0, 4},
                  "of the window whose disparities on the same surface are averaged; 0: none");
  }
};

// kInvalid: a value is outside describe()'s range, disparities is no multiple of 16, the penalties
// are in the wrong order, or disparities leave -256 to 511.
Status validate(const MatcherConfig& config);

}  // namespace surefoot::stereo
