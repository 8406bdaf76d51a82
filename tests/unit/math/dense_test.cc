// Dense comparison with libm's long double functions. The bounds are those of core/math/README.md.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/math/elementary.h"
#include "tests/support/samples.h"
#include "tests/unit/math/ulp.h"

namespace surefoot::math {
namespace {

constexpr int kSamples = tests::samples(2'000'000, 20'000);

template <class Function, class Oracle, class Argument>
void expect_within(const char* name, double bound_ulp, Function function, Oracle oracle,
                   Argument argument) {
  const Worst worst = worst_error(function, oracle, argument, kSamples);
  std::printf("%-22s %.4f ulp at %.17g\n", name, worst.ulp, worst.argument);
  EXPECT_LE(worst.ulp, bound_ulp) << name << " at " << worst.argument;
}

#define SUREFOOT_DENSE(name, bound_ulp, range)                       \
  expect_within(                                                     \
      #name " " #range, bound_ulp, [](double x) { return name(x); }, \
      [](long double x) { return std::name(x); }, range)

TEST(Dense, Sin) {
  SUREFOOT_DENSE(sin, 0.51, (Uniform{-4, 4}));
  SUREFOOT_DENSE(sin, 0.51, (Uniform{-1e6, 1e6}));
  SUREFOOT_DENSE(sin, 0.51, (Magnitudes{-1074, 18}));
  SUREFOOT_DENSE(sin, 0.51, QuadrantBorders{});
}

TEST(Dense, Cos) {
  SUREFOOT_DENSE(cos, 0.51, (Uniform{-4, 4}));
  SUREFOOT_DENSE(cos, 0.51, (Uniform{-1e6, 1e6}));
  SUREFOOT_DENSE(cos, 0.51, (Magnitudes{-1074, 18}));
  SUREFOOT_DENSE(cos, 0.51, QuadrantBorders{});
}

TEST(Dense, Tan) {
  SUREFOOT_DENSE(tan, 0.51, (Uniform{-4, 4}));
  SUREFOOT_DENSE(tan, 0.51, (Uniform{-1e6, 1e6}));
  SUREFOOT_DENSE(tan, 0.51, (Magnitudes{-1074, 18}));
  SUREFOOT_DENSE(tan, 0.51, QuadrantBorders{});
}

TEST(Dense, Atan) {
  SUREFOOT_DENSE(atan, 0.51, (Uniform{-4, 4}));
  SUREFOOT_DENSE(atan, 0.51, (Magnitudes{-1074, 1023}));
}

TEST(Dense, AsinAcos) {
  SUREFOOT_DENSE(asin, 0.52, (Uniform{-1, 1}));
  SUREFOOT_DENSE(asin, 0.52, (Magnitudes{-1074, -1}));
  SUREFOOT_DENSE(asin, 0.52, NearOne{-1});
  SUREFOOT_DENSE(acos, 0.52, (Uniform{-1, 1}));
  SUREFOOT_DENSE(acos, 0.52, (Magnitudes{-1074, -1}));
  SUREFOOT_DENSE(acos, 0.52, NearOne{-1});
}

TEST(Dense, Exp) {
  SUREFOOT_DENSE(exp, 0.65, (Uniform{-1, 1}));
  SUREFOOT_DENSE(exp, 0.65, (Uniform{-708, 709.78}));
  SUREFOOT_DENSE(exp, 0.65, (Magnitudes{-1074, 8}));
  // Subnormal results are rounded twice.
  SUREFOOT_DENSE(exp, 1.0, (Uniform{-745.2, -708}));
}

TEST(Dense, Log) {
  SUREFOOT_DENSE(log, 0.55, (Uniform{0.4, 2.5}));
  SUREFOOT_DENSE(log, 0.55, NearOne{1});
  SUREFOOT_DENSE(log, 0.55, NearOne{-0.5});
  const auto positive = [](Random& random) { return std::fabs(Magnitudes{-1074, 1023}(random)); };
  SUREFOOT_DENSE(log, 0.55, positive);
}

TEST(Dense, Sqrt) {
  const auto positive = [](Random& random) { return std::fabs(Magnitudes{-1074, 1023}(random)); };
  // Two oracle errors of 2^-12 ulp at most on top of correct rounding.
  SUREFOOT_DENSE(sqrt, 0.5005, positive);
}

template <class Argument>
void expect_atan2_within(const char* name, double bound_ulp, Argument argument) {
  Random random(77);
  double worst = 0;
  for (int i = 0; i < kSamples; ++i) {
    const double y = argument(random);
    const double x = argument(random);
    const long double want = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    const double error = ulp_error(atan2(y, x), want);
    if (!(error <= worst)) worst = error;
  }
  std::printf("%-22s %.4f ulp\n", name, worst);
  EXPECT_LE(worst, bound_ulp) << name;
}

TEST(Dense, Atan2) {
  expect_atan2_within("atan2 near", 0.51, Uniform{-3, 3});
  expect_atan2_within("atan2 magnitudes", 0.51, Magnitudes{-3, 3});
  expect_atan2_within("atan2 all", 0.51, Magnitudes{-1074, 1023});
  expect_atan2_within("atan2 subnormal", 0.51, Magnitudes{-1074, -1020});
  expect_atan2_within("atan2 huge", 0.51, Magnitudes{1000, 1023});
}

// x - 2 pi k in parts of 2 pi of 40 bits, whose products with k are exact in a long double.
long double wrap_oracle(long double x) {
  constexpr long double kParts[] = {0x1.921fb54442p+2L, 0x1.a308d3131ap-39L, -0x1.d747f23e32p-81L};
  const long double k = std::rint(x / (kParts[0] + kParts[1]));
  return ((x - k * kParts[0]) - k * kParts[1]) - k * kParts[2];
}

TEST(Dense, WrapAngle) {
  const auto wrap = [](double x) { return wrap_angle(x); };
  expect_within("wrap_angle near", 0.51, wrap, wrap_oracle, Uniform{-20, 20});
  expect_within("wrap_angle far", 0.51, wrap, wrap_oracle, Uniform{-1e6, 1e6});
}

TEST(Dense, SinCosAgreesWithSinAndCos) {
  Random random(8);
  for (int i = 0; i < kSamples / 10; ++i) {
    const double x = Uniform{-1e3, 1e3}(random);
    const SinCos both = sin_cos(x);
    ASSERT_EQ(both.sin, sin(x));
    ASSERT_EQ(both.cos, cos(x));
  }
}

}  // namespace
}  // namespace surefoot::math
