#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>

#include "core/math/elementary.h"
#include "tests/unit/math/ulp.h"

namespace surefoot::math {
namespace {

constexpr double kSubnormal = std::numeric_limits<double>::denorm_min();
constexpr double kHuge = std::numeric_limits<double>::max();

// Equal including the sign of zero.
void expect_bits(double got, double want) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(got), std::bit_cast<std::uint64_t>(want))
      << got << " instead of " << want;
}

TEST(SpecialValues, OddFunctionsKeepZeroAndSubnormals) {
  for (const double x : {0.0, -0.0, kSubnormal, -kSubnormal, 1e-310, -1e-200}) {
    expect_bits(sin(x), x);
    expect_bits(tan(x), x);
    expect_bits(asin(x), x);
    EXPECT_EQ(atan(x), x);
    expect_bits(wrap_angle(x), x);
    expect_bits(cos(x), 1.0);
    expect_bits(exp(x), 1.0);
  }
}

TEST(SpecialValues, OddFunctionsAreOddAndEvenOnesEven) {
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const double x = Magnitudes{-40, 18}(random);
    expect_bits(sin(-x), -sin(x));
    expect_bits(cos(-x), cos(x));
    expect_bits(tan(-x), -tan(x));
    expect_bits(atan(-x), -atan(x));
    const double y = Uniform{-1, 1}(random);
    expect_bits(asin(-y), -asin(y));
  }
}

TEST(SpecialValues, Atan2OnTheAxes) {
  expect_bits(atan2(0.0, 0.0), 0.0);
  expect_bits(atan2(-0.0, -0.0), 0.0);
  expect_bits(atan2(0.0, 2.0), 0.0);
  expect_bits(atan2(0.0, -2.0), kPi);
  expect_bits(atan2(-0.0, -2.0), -kPi);
  expect_bits(atan2(3.0, 0.0), kPi / 2);
  expect_bits(atan2(-3.0, -0.0), -kPi / 2);
  expect_bits(atan2(1.0, 1.0), kPi / 4);
  expect_bits(atan2(kHuge, kHuge), kPi / 4);
  expect_bits(atan2(kSubnormal, kSubnormal), kPi / 4);
  expect_bits(atan2(kSubnormal, kHuge), 0.0);
  expect_bits(atan2(kHuge, kSubnormal), kPi / 2);
  expect_bits(atan2(kSubnormal, -kHuge), kPi);
  expect_bits(atan2(kHuge, -kSubnormal), kPi / 2);
}

TEST(SpecialValues, Atan2StaysWithinItsRange) {
  Random random(2);
  for (int i = 0; i < 100000; ++i) {
    const double y = Magnitudes{-60, 60}(random);
    const double x = Magnitudes{-60, 60}(random);
    const double angle = atan2(y, x);
    ASSERT_LE(angle, kPi);
    ASSERT_GE(angle, -kPi);
    ASSERT_EQ(angle > 0, y > 0);
  }
}

TEST(SpecialValues, ArgumentsBeyondOneAreClamped) {
  expect_bits(asin(1.0), kPi / 2);
  expect_bits(asin(1.0 + 1e-15), kPi / 2);
  expect_bits(asin(-7.0), -kPi / 2);
  expect_bits(acos(1.0), 0.0);
  expect_bits(acos(1.5), 0.0);
  expect_bits(acos(-1.0), kPi);
  expect_bits(acos(-1.0 - 1e-15), kPi);
  expect_bits(acos(0.0), kPi / 2);
}

TEST(SpecialValues, ExpAtTheEndsOfItsRange) {
  expect_bits(exp(0.0), 1.0);
  EXPECT_EQ(exp(-745.1), kSubnormal);
  expect_bits(exp(-745.2), 0.0);
  expect_bits(exp(-1e300), 0.0);
  EXPECT_LT(exp(709.7), kHuge);
  EXPECT_EQ(exp(709.8), kHuge);
  EXPECT_EQ(exp(1e300), kHuge);
  EXPECT_TRUE(is_finite(exp(0x1.62e42fefa39efp+9)));
}

TEST(SpecialValues, LogOfPowersOfTwoAndOfTheEnds) {
  expect_bits(log(1.0), 0.0);
  for (int k = -1074; k <= 1023; ++k) {
    const double x = std::ldexp(1.0, k);
    EXPECT_LE(ulp_error(log(x), std::log(static_cast<long double>(x))), 0.55) << k;
  }
  EXPECT_LE(ulp_error(log(kHuge), std::log(static_cast<long double>(kHuge))), 0.55);
}

TEST(SpecialValues, ExpAndLogAreMonotonicNearTheirSeams) {
  // Where the reduction changes to the next power of two.
  for (int k = -20; k <= 20; ++k) {
    double x = (k + 0.5) * 0.69314718055994530942;
    for (int step = 0; step < 200; ++step) {
      const double next = std::nextafter(x, 1e9);
      ASSERT_LE(exp(x), exp(next));
      x = next;
    }
    double y = std::ldexp(1.4142135623730950488, k) - std::ldexp(50.0, k - 52);
    for (int step = 0; step < 200; ++step) {
      const double next = std::nextafter(y, 1e9);
      ASSERT_LE(log(y), log(next));
      y = next;
    }
  }
}

TEST(SpecialValues, WrapAngleKeepsTheHalfOpenRange) {
  expect_bits(wrap_angle(kPi), kPi);
  expect_bits(wrap_angle(-kPi), kPi);
  EXPECT_EQ(wrap_angle(1.0), 1.0);
  EXPECT_NEAR(wrap_angle(kTwoPi), 0.0, 1e-15);
  Random random(3);
  for (int i = 0; i < 100000; ++i) {
    const double near_cut =
        static_cast<double>(2 * static_cast<int>(random.below(300000)) + 1) * kPi;
    double x = near_cut;
    for (int step = 0; step < 3; ++step) {
      if (x > 1e6) break;
      const double wrapped = wrap_angle(x);
      ASSERT_LE(wrapped, kPi);
      ASSERT_GE(wrapped, -kPi);
      x = std::nextafter(x, 2e6);
    }
  }
}

TEST(SpecialValues, SinAndCosKeepTheUnitCircle) {
  Random random(4);
  for (int i = 0; i < 100000; ++i) {
    const SinCos r = sin_cos(Uniform{-100, 100}(random));
    ASSERT_LE(std::fabs(r.sin), 1.0);
    ASSERT_LE(std::fabs(r.cos), 1.0);
    ASSERT_NEAR(r.sin * r.sin + r.cos * r.cos, 1.0, 3e-16);
  }
}

TEST(SpecialValues, SmallHelpers) {
  static_assert(clamp(5, 0, 3) == 3 && clamp(-1, 0, 3) == 0 && clamp(2, 0, 3) == 2);
  static_assert(square(-3) == 9);
  EXPECT_TRUE(is_finite(kHuge));
  EXPECT_FALSE(is_finite(std::numeric_limits<double>::infinity()));
  EXPECT_FALSE(is_finite(std::numeric_limits<double>::quiet_NaN()));
}

TEST(SpecialValuesDeathTest, BrokenPreconditionsStopTheProgram) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_DEATH(static_cast<void>(sin(1.1e6)), "assertion failed");
  EXPECT_DEATH(static_cast<void>(cos(nan)), "assertion failed");
  EXPECT_DEATH(static_cast<void>(wrap_angle(-1.1e6)), "assertion failed");
  EXPECT_DEATH(static_cast<void>(log(0.0)), "assertion failed");
  EXPECT_DEATH(static_cast<void>(sqrt(-1e-300)), "assertion failed");
}

}  // namespace
}  // namespace surefoot::math
