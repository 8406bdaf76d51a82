#include "core/registration/registration_config.h"

#include "core/math/elementary.h"

namespace surefoot::registration {
namespace {

bool within(double value, double low, double high) {
  return math::is_finite(value) && value >= low && value <= high;
}

}  // namespace

Status validate(const RegistrationConfig& config) {
  bool valid = within(config.cell_m, 0.001, 10.0) && config.max_pairs >= 1 &&
               config.max_pairs <= kMaxPairs && config.min_pairs >= 6 &&
               config.min_pairs <= config.max_pairs && within(config.min_overlap, 0.0, 1.0) &&
               within(config.max_normal_angle_rad, 0.1, 0.5 * math::kPi) &&
               within(config.surface_error, 0.0, 1.0) && within(config.outlier_sigma, 1.0, 100.0) &&
               within(config.min_information_ratio, 1.0, 1000.0) &&
               within(config.gate_sigma, 1.0, 1000.0);
  std::int32_t steps = 0;
  for (const std::int32_t iterations : config.max_iterations) {
    valid = valid && iterations >= 0 && iterations <= kMaxIterations;
    steps += iterations;
  }
  return valid && steps > 0 ? Status::kOk : Status::kInvalid;
}

}  // namespace surefoot::registration
