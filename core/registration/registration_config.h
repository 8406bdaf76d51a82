// What a registration can be told. Keys and ranges: README.md.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/parameters.h"
#include "core/base/status.h"
#include "core/math/elementary.h"
#include "core/registration/cloud.h"

namespace surefoot::registration {

inline constexpr int kMaxIterations = 64;  // of one level
inline constexpr std::int32_t kMaxPairs = 4096;

struct RegistrationConfig {
  double cell_m = 0.025;  // finest cells, of both clouds
  // Steps of each level at most, finest first. 0 leaves the level out.
  std::array<std::int32_t, kLevels> max_iterations{8, 10, 15, 15};
  std::int32_t max_pairs = 2500;      // source surfels used per step, taken evenly
  std::int32_t min_pairs = 30;        // fewer: kNotFound
  double min_overlap = 0.15;          // share of the source surfels with a partner; less: kNotFound
  double max_normal_angle_rad = 0.8;  // between partners
  double surface_error = 0.03;        // what a surfel misses of the surface, in cells
  // Of the sensor's own making, not noise: a pattern in the picture that moves with the camera must
  // not be taken for ground that does not.
  double normal_error_rad = 0.0;
  double outlier_sigma = 5.0;  // residuals well beyond it have no weight
  // A direction counts as observed when the clouds hold this many times the information about it
  // that the noise of the normals alone would feign.
  double min_information_ratio = 1.3;
  double gate_sigma = 4.0;  // corrections beyond that many sigma of the prior: kOutOfRange

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("cell_m", self.cell_m, {0.001, 10.0}, "finest cells, of both clouds");
    constexpr const char* kSteps = "steps of the level at most; 0 leaves it out";
    visit.integer("max_iterations_1", self.max_iterations[0], {0, kMaxIterations}, kSteps);
    visit.integer("max_iterations_2", self.max_iterations[1], {0, kMaxIterations}, kSteps);
    visit.integer("max_iterations_4", self.max_iterations[2], {0, kMaxIterations}, kSteps);
    visit.integer("max_iterations_8", self.max_iterations[3], {0, kMaxIterations}, kSteps);
    visit.integer("max_pairs", self.max_pairs, {6, kMaxPairs}, "source surfels used per step");
    visit.integer("min_pairs", self.min_pairs, {6, kMaxPairs}, "fewer give no result");
    visit.real("min_overlap", self.min_overlap, {0.0, 1.0},
               "share of the source surfels that must have a partner");
    visit.real("max_normal_angle_rad", self.max_normal_angle_rad, {0.1, 0.5 * math::kPi},
               "between the normals of partners");
    visit.real("surface_error", self.surface_error, {0.0, 1.0},
               "what a surfel misses of the surface, in cells");
    visit.real("normal_error_rad", self.normal_error_rad, {0.0, 1.0},
               "systematic, of a normal: less is no structure");
    visit.real("outlier_sigma", self.outlier_sigma, {1.0, 100.0},
               "residuals well beyond it have no weight");
    visit.real("min_information_ratio", self.min_information_ratio, {1.0, 1000.0},
               "of a direction that counts as observed, to what noisy normals feign");
    visit.real("gate_sigma", self.gate_sigma, {1.0, 1000.0},
               "corrections beyond that many sigma of the prior are refused");
  }
};

// kInvalid: a value is not finite or outside describe()'s range, max_pairs below min_pairs, or
// every level is left out.
Status validate(const RegistrationConfig& config);

}  // namespace surefoot::registration
