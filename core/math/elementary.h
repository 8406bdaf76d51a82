// Elementary functions with the same bits on every CPU: range reduction and polynomials from
// + - * / and sqrt only, no libm. Accuracy (measured against libm, tests/unit/math): see README.md.
//
// Domain errors do not exist: each function states what it returns outside its domain. Arguments
// must be finite unless said otherwise; a NaN argument is a programmer's error.
#pragma once

#include <cstdint>

namespace surefoot::math {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kTwoPi = 6.28318530717958647693;

// [rad]. |x| <= 1e6; larger arguments are programmer's errors (an angle that large is a bug).
double sin(double x);
double cos(double x);
struct SinCos {
  double sin;
  double cos;
};
SinCos sin_cos(double x);
double tan(double x);

// [rad] in [-pi, pi]; atan2(0, 0) = 0.
double atan2(double y, double x);
double atan(double x);
// Arguments beyond [-1, 1] are clamped: they come from rounding. [rad]
double asin(double x);
double acos(double x);

// exp underflows to 0 below -745 and is clamped to the largest double above 709.7.
double exp(double x);
// x > 0; log of a value <= 0 is a programmer's error.
double log(double x);

double sqrt(double x);  // x >= 0, correctly rounded; negative arguments are programmer's errors

// The equivalent angle in (-pi, pi]. |x| <= 1e6.
double wrap_angle(double x);

template <class T>
constexpr T clamp(T value, T low, T high) {
  return value < low ? low : (high < value ? high : value);
}

constexpr double magnitude(double x) { return x < 0 ? -x : x; }

template <class T>
constexpr T square(T value) {
  return value * value;
}

// The largest whole number not above the value; |value| < 2^31.
constexpr std::int32_t floor_of(double value) {
  const auto whole = static_cast<std::int32_t>(value);
  return static_cast<double>(whole) > value ? whole - 1 : whole;
}

// Finite: neither infinite nor NaN, without calling libm.
constexpr bool is_finite(double x) { return x - x == 0.0; }

}  // namespace surefoot::math
