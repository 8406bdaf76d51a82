#include "core/terrain/fill_config.h"

#include <span>

#include "core/stereo/range_check.h"

namespace surefoot::terrain {

namespace {

struct FillRangeCheck : stereo::RangeCheck {
  template <class Enum>
  void choice(const char*, const Enum& value, std::span<const char* const> names, const char*) {
    good = good && static_cast<std::size_t>(value) < names.size();
  }
};

}  // namespace

Status validate(const FillConfig& config) {
  FillRangeCheck check;
  FillConfig::describe(config, check);
  return check.good && config.patch_cells % 2 == 1 ? Status::kOk : Status::kInvalid;
}

}  // namespace surefoot::terrain
