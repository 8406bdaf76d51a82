#include "core/registration/registration_config.h"

namespace surefoot::registration {

Status validate(const RegistrationConfig& config) {
  RangeCheck check;
  RegistrationConfig::describe(config, check);
  std::int32_t steps = 0;
  for (const std::int32_t iterations : config.max_iterations) steps += iterations;
  const bool valid = check.good && config.min_pairs <= config.max_pairs && steps > 0;
  return valid ? Status::kOk : Status::kInvalid;
}

}  // namespace surefoot::registration
