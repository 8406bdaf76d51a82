// Error measurement for the elementary functions: arguments drawn over a range, the oracle computed
// in long double (64 bits of mantissa on x86-64, 113 on aarch64), whose own error is below
// 0.001 ulp of a double.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/base/random.h"

namespace surefoot::math {

// |got - want| in units of the last place of want as a double.
inline double ulp_error(double got, long double want) {
  int exponent = 0;
  std::frexp(want, &exponent);  // |want| in [2^(e-1), 2^e)
  const long double unit = std::ldexp(1.0L, std::max(exponent - 53, -1074));
  return static_cast<double>(std::fabs((static_cast<long double>(got) - want) / unit));
}

struct Worst {
  double ulp = 0;
  double argument = 0;
};

// Argument generators.

inline double mantissa(Random& random) {
  const std::uint64_t high = random.next_u32();
  const std::uint64_t low = random.next_u32();
  return 1.0 + static_cast<double>(((high << 32u) | low) >> 12u) * 0x1p-52;
}

struct Uniform {
  double low;
  double high;
  double operator()(Random& random) const { return low + (high - low) * (mantissa(random) - 1.0); }
};

// Every binary magnitude from 2^low to 2^(high + 1) alike, both signs.
struct Magnitudes {
  int low;
  int high;
  double operator()(Random& random) const {
    const double value = mantissa(random);
    const auto exponent =
        low + static_cast<int>(random.below(static_cast<std::uint32_t>(high - low + 1)));
    const double sign = random.below(2) == 0 ? 1.0 : -1.0;
    return sign * std::ldexp(value, exponent);
  }
};

// The doubles next to multiples of pi/4 up to 1e6: where quadrants change and results cancel.
struct QuadrantBorders {
  double operator()(Random& random) const {
    constexpr long double kQuarterPi = 0.785398163397448309615660845819875721L;
    const auto multiple = static_cast<std::int64_t>(random.below(2'540'000)) - 1'270'000;
    const auto offset = static_cast<std::int64_t>(random.below(9)) - 4;
    const auto border = static_cast<double>(static_cast<long double>(multiple) * kQuarterPi);
    const double near = std::bit_cast<double>(std::bit_cast<std::int64_t>(border) + offset);
    return std::fabs(near) <= 1e6 ? near : 0.5;
  }
};

// 1 minus (or plus) anything down to the last bit.
struct NearOne {
  double sign;
  double operator()(Random& random) const {
    const int exponent = -static_cast<int>(1 + random.below(53));
    return 1.0 + sign * std::ldexp(mantissa(random) - 1.0, exponent);
  }
};

template <class Function, class Oracle, class Argument>
Worst worst_error(Function function, Oracle oracle, Argument argument, int samples) {
  Random random(20240607);
  Worst worst;
  for (int i = 0; i < samples; ++i) {
    const double x = argument(random);
    const double error = ulp_error(function(x), oracle(static_cast<long double>(x)));
    if (!(error <= worst.ulp)) worst = {error, x};
  }
  return worst;
}

}  // namespace surefoot::math
