// Applies describe()'s ranges. Written so that a NaN fails.
#pragma once

#include "core/base/parameters.h"

namespace surefoot::stereo {

struct RangeCheck {
  template <class Integer>
  void integer(const char*, const Integer& value, Range range, const char*) {
    real(nullptr, static_cast<double>(value), range, nullptr);
  }
  void real(const char*, double value, Range range, const char*) {
    good = good && value >= range.low && value <= range.high;
  }
  bool good = true;
};

}  // namespace surefoot::stereo
