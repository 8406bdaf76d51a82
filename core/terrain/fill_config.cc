#include "core/terrain/fill_config.h"

namespace surefoot::terrain {

Status validate(const FillConfig& config) {
  RangeCheck check;
  FillConfig::describe(config, check);
  return check.good && config.patch_cells % 2 == 1 ? Status::kOk : Status::kInvalid;
}

}  // namespace surefoot::terrain
