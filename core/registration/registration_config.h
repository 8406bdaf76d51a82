// What a registration can be told. Keys and ranges: README.md.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/status.h"
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
  double outlier_sigma = 5.0;         // residuals well beyond it have no weight
  // A direction counts as observed when the clouds hold this many times the information about it
  // that the noise of the normals alone would feign.
  double min_information_ratio = 1.3;
  double gate_sigma = 4.0;  // corrections beyond that many sigma of the prior: kOutOfRange
};

// kInvalid: a value is not finite or outside its range.
Status validate(const RegistrationConfig& config);

}  // namespace surefoot::registration
