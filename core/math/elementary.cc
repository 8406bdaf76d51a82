#include "core/math/elementary.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/assert.h"

// Numbers below are carried as an unevaluated sum hi + lo wherever one rounding more would cost the
// last bit. The error-free sum is Knuth's, the error-free product Dekker's and Veltkamp's.

namespace surefoot::math {
namespace {

struct Pair {
  double hi;
  double lo;
};

// Below this magnitude sin, tan and asin equal their argument to the last bit.
constexpr double kTiny = 0x1p-27;
constexpr double kMaxAngle_rad = 1e6;
constexpr Pair kHalfPi = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};
constexpr Pair kWholePi = {0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};

Pair two_sum(double a, double b) {
  const double sum = a + b;
  const double b_part = sum - a;
  const double a_part = sum - b_part;
  return {sum, (a - a_part) + (b - b_part)};
}

// For |a| >= |b| or a = 0.
Pair fast_two_sum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

// Splits into halves of 26 bits, whose products are exact. |x| < 2^996.
Pair split(double x) {
  const double scaled = x * 0x1.0000002p+27;
  const double hi = scaled - (scaled - x);
  return {hi, x - hi};
}

Pair two_product(double a, double b) {
  const double product = a * b;
  const Pair as = split(a);
  const Pair bs = split(b);
  const double rest = ((as.hi * bs.hi - product) + as.hi * bs.lo + as.lo * bs.hi) + as.lo * bs.lo;
  return {product, rest};
}

Pair divide(Pair numerator, Pair denominator) {
  const double quotient = numerator.hi / denominator.hi;
  const Pair back = two_product(quotient, denominator.hi);
  const double rest =
      ((numerator.hi - back.hi) - back.lo) + (numerator.lo - quotient * denominator.lo);
  return {quotient, rest / denominator.hi};
}

// a - factor * b, for a factor of few bits.
Pair subtract_multiple(Pair a, double factor, Pair b) {
  const Pair product = two_product(factor, b.hi);
  const Pair sum = two_sum(a.hi, -product.hi);
  return {sum.hi, sum.lo + ((a.lo - product.lo) - factor * b.lo)};
}

// To the nearest integer, ties to even; |x| < 2^51. No instruction or libm call is needed for it.
double nearest_integer(double x) {
  constexpr double kShift = 0x1.8p+52;
  return (x + kShift) - kShift;
}

template <std::size_t kTerms>
double polynomial(double x, const std::array<double, kTerms>& coefficients) {
  double value = coefficients[kTerms - 1];
  for (std::size_t i = kTerms - 1; i-- > 0;) value = value * x + coefficients[i];
  return value;
}

// x - quadrants * pi/2 for |quadrants| < 2^20. pi/2 comes in parts of 33 bits, so that the first
// three products are exact; the sum of the parts is good to 2^-157, far below the closest approach
// of a double to a multiple of pi/2 (about 2^-62 in this range).
Pair subtract_quadrants(double x, double quadrants) {
  constexpr std::array<double, 4> kHalfPiParts = {0x1.921fb544p+0, 0x1.0b4611a6p-34,
                                                  0x1.3198a2ep-69, 0x1.b839a252049c1p-104};
  const double first = x - quadrants * kHalfPiParts[0];
  const Pair second = two_sum(first, -(quadrants * kHalfPiParts[1]));
  const Pair third = two_sum(second.hi, -(quadrants * kHalfPiParts[2]));
  const double rest = (second.lo + third.lo) - quadrants * kHalfPiParts[3];
  return two_sum(third.hi, rest);
}

struct Reduced {
  Pair angle;          // [rad] in [-pi/4, pi/4], a rounding more at the ends
  unsigned quadrants;  // modulo 4
};

Reduced reduce(double x) {
  SUREFOOT_ASSERT(x >= -kMaxAngle_rad && x <= kMaxAngle_rad);
  constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
  const double quadrants = nearest_integer(x * kTwoOverPi);
  const auto count = static_cast<std::int32_t>(quadrants);
  return {subtract_quadrants(x, quadrants), static_cast<unsigned>(count) & 3u};
}

constexpr double inverse_factorial(int n) {
  double product = 1;
  for (int i = 2; i <= n; ++i) product *= i;  // exact up to 18!
  return 1 / product;
}

struct SinCosPair {
  Pair sin;
  Pair cos;
};

// At i / 16 rad.
constexpr std::array<SinCosPair, 14> kSinCos = {{
    {{0, 0}, {0x1p+0, 0}},
    {{0x1.ffaaaeeed4edbp-5, -0x1.2d16d32684b69p-59}, {0x1.ff0015549f4d3p-1, 0x1.328387b99426fp-55}},
    {{0x1.feaaeee86ee36p-4, -0x1.afcb2bcc6f03bp-59}, {0x1.fc015527d5bd3p-1, 0x1.b68f35094efb8p-55}},
    {{0x1.7dc102fbaf2b5p-3, 0x1.5ab50e23c97c3p-59}, {0x1.f706bdf9ece1cp-1, -0x1.698c80c36dcb4p-55}},
    {{0x1.faaeed4f31577p-3, -0x1.15d88508e32b8p-57}, {0x1.f01549f7deea1p-1, 0x1.d3c1e99e5cafdp-55}},
    {{0x1.3ad129769d3d8p-2, 0x1.03d550487839ap-63}, {0x1.e733ea0193d4p-1, -0x1.6428b3546ce13p-55}},
    {{0x1.7710255764214p-2, -0x1.6ead7314bb6cep-57}, {0x1.dc6b7eb995912p-1, 0x1.4b364776dcd35p-58}},
    {{0x1.b1d8305321617p-2, -0x1.ae242cb99f519p-56}, {0x1.cfc6cfa52ad9fp-1, 0x1.8b5b5508f2a0dp-55}},
    {{0x1.eaee8744b05fp-2, -0x1.789b43c9b027dp-58}, {0x1.c1528065b7d5p-1, -0x1.892111312e828p-55}},
    {{0x1.110d0c4b69c3bp-1, 0x1.d918998809981p-55}, {0x1.b11d04162a4c6p-1, 0x1.1dd561efbc0c2p-56}},
    {{0x1.2b91dea88421ep-1, -0x1.fa371db216abp-55}, {0x1.9f368ed912f85p-1, -0x1.1d200c5791606p-55}},
    {{0x1.44eb381cf386bp-1, -0x1.3ed6c1e6a5505p-55}, {0x1.8bb105a5dc9p-1, 0x1.863e03e9474c1p-55}},
    {{0x1.5cffc16bf8f0dp-1, 0x1.96cb370eb578ap-55}, {0x1.769fec655211fp-1, -0x1.827d5cf8c68c5p-57}},
    {{0x1.73b7680dea578p-1, -0x1.2248306dc12a2p-56}, {0x1.6018526f563dfp-1, 0x1.46ca5e0e432dp-55}},
}};

// On the reduced range, by the addition theorems from the nearest tabulated angle; the rest of at
// most 1/32 rad by Taylor series, first omitted terms x^10 / 11! and x^10 / 10! below 2^-71.
SinCosPair sin_cos_reduced(Pair angle) {
  constexpr std::array<double, 4> kSinSeries = {-inverse_factorial(3), inverse_factorial(5),
                                                -inverse_factorial(7), inverse_factorial(9)};
  constexpr std::array<double, 4> kCosSeries = {-inverse_factorial(2), inverse_factorial(4),
                                                -inverse_factorial(6), inverse_factorial(8)};
  const double sign = angle.hi < 0 ? -1 : 1;
  const double index = nearest_integer(16 * sign * angle.hi);
  const double x = sign * angle.hi - index / 16;  // exact
  const double square = x * x;
  const double sin_rest = sign * angle.lo + x * square * polynomial(square, kSinSeries);
  const double cos_rest = square * polynomial(square, kCosSeries) - x * (sign * angle.lo);
  const auto& [s, c] = kSinCos[static_cast<std::size_t>(index)];
  const Pair cx = two_product(c.hi, x);
  const Pair sx = two_product(s.hi, x);
  const Pair sine = fast_two_sum(s.hi, cx.hi);
  const Pair cosine = fast_two_sum(c.hi, -sx.hi);
  const double sine_lo =
      sine.lo + (cx.lo + (s.lo + c.lo * x + (c.hi * sin_rest + s.hi * cos_rest)));
  const double cosine_lo =
      cosine.lo - (sx.lo - (c.lo - s.lo * x + (c.hi * cos_rest - s.hi * sin_rest)));
  return {fast_two_sum(sign * sine.hi, sign * sine_lo), fast_two_sum(cosine.hi, cosine_lo)};
}

// atan(i / 16).
constexpr std::array<Pair, 17> kArcTangents = {{
    {0, 0},
    {0x1.ff55bb72cfdeap-5, -0x1.c934d86d23f1dp-60},
    {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
    {0x1.7b97b4bce5b02p-3, 0x1.347b0b4f881cap-58},
    {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
    {0x1.362773707ebccp-2, -0x1.963a544b672d8p-57},
    {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
    {0x1.a64eec3cc23fdp-2, -0x1.24dec1b50b7ffp-56},
    {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
    {0x1.0657e94db30d0p-1, -0x1.d5b495f6349e6p-56},
    {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
    {0x1.345f01cce37bbp-1, 0x1.1021137c71102p-55},
    {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
    {0x1.5d58987169b18p-1, 0x1.0028e4bc5e7cap-57},
    {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
    {0x1.819d0b7158a4dp-1, -0x1.bf76229d3b917p-56},
    {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
}};

// The angle of the point (x, y) for 0 <= y <= x, x > 0: turned back by the nearest tabulated angle,
// then the arc tangent's series on |t| <= 1/32, first omitted term t^12 / 13 below 2^-63.
Pair angle_below_diagonal(Pair y, Pair x) {
  constexpr std::array<double, 5> kSeries = {-1.0 / 3, 1.0 / 5, -1.0 / 7, 1.0 / 9, -1.0 / 11};
  const double index = nearest_integer(16 * (y.hi / x.hi));
  const double tangent = index / 16;
  const Pair t = divide(subtract_multiple(y, tangent, x), subtract_multiple(x, -tangent, y));
  const double square = t.hi * t.hi;
  const double cubic = t.hi * square * polynomial(square, kSeries);
  const Pair tabulated = kArcTangents[static_cast<std::size_t>(index)];
  const Pair sum = fast_two_sum(tabulated.hi, t.hi);
  return {sum.hi, sum.lo + (tabulated.lo + (t.lo + cubic))};
}

double add(Pair a, double sign, Pair b) {
  const Pair sum = two_sum(a.hi, sign * b.hi);
  return sum.hi + (sum.lo + (a.lo + sign * b.lo));
}

// The angle in [0, pi] of the point (+-x, y), x and y >= 0 and not both 0, away from over- and
// underflow.
double angle_above_axis(Pair y, Pair x, bool x_is_negative) {
  if (y.hi > x.hi) return add(kHalfPi, x_is_negative ? 1 : -1, angle_below_diagonal(x, y));
  const Pair angle = angle_below_diagonal(y, x);
  return x_is_negative ? add(kWholePi, -1, angle) : angle.hi + angle.lo;
}

// sqrt(1 - x^2) for |x| <= 1.
Pair other_leg(double x) {
  const Pair square = two_product(x, x);
  const Pair rest = two_sum(1.0, -square.hi);
  if (rest.hi <= 0) return {0, 0};
  const double root = sqrt(rest.hi);
  const Pair back = two_product(root, root);
  const double correction = ((rest.hi - back.hi) - back.lo) + (rest.lo - square.lo);
  return fast_two_sum(root, correction / (2 * root));
}

constexpr double power_of_two(std::int64_t exponent) {  // [-1022, 1023]
  return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52u);
}

}  // namespace

double sqrt(double x) {
  SUREFOOT_ASSERT(x >= 0);
  return __builtin_sqrt(x);
}

SinCos sin_cos(double x) {
  const Reduced reduced = reduce(x);
  const auto [s, c] = sin_cos_reduced(reduced.angle);
  switch (reduced.quadrants) {
    case 0: return {magnitude(x) < kTiny ? x : s.hi, c.hi};
    case 1: return {c.hi, -s.hi};
    case 2: return {-s.hi, -c.hi};
    default: return {-c.hi, s.hi};
  }
}

double sin(double x) { return sin_cos(x).sin; }

double cos(double x) { return sin_cos(x).cos; }

double tan(double x) {
  const Reduced reduced = reduce(x);
  if (magnitude(x) < kTiny) return x;
  const auto [s, c] = sin_cos_reduced(reduced.angle);
  const Pair quotient = reduced.quadrants % 2 == 0 ? divide(s, c) : divide({-c.hi, -c.lo}, s);
  return quotient.hi + quotient.lo;
}

double atan2(double y, double x) {
  constexpr double kNegligible = 0x1p-64;
  if (x == 0 && y == 0) return 0;
  const bool y_is_negative = std::bit_cast<std::int64_t>(y) < 0;
  const double sign = y_is_negative ? -1 : 1;
  double length_x = magnitude(x);
  double length_y = magnitude(y);
  if (length_x <= length_y * kNegligible) return sign * kHalfPi.hi;
  if (length_y <= length_x * kNegligible) return x < 0 ? sign * kPi : y / x;
  const double longer = length_x < length_y ? length_y : length_x;
  const double scale = longer > 0x1p+700 ? 0x1p-400 : (longer < 0x1p-700 ? 0x1p+400 : 1);
  length_x *= scale;
  length_y *= scale;
  return sign * angle_above_axis({length_y, 0}, {length_x, 0}, x < 0);
}

double atan(double x) { return atan2(x, 1.0); }

double asin(double x) {
  const double clamped = clamp(x, -1.0, 1.0);
  if (magnitude(clamped) < kTiny) return clamped;
  const double angle = angle_above_axis({magnitude(clamped), 0}, other_leg(clamped), false);
  return clamped < 0 ? -angle : angle;
}

double acos(double x) {
  const double clamped = clamp(x, -1.0, 1.0);
  return angle_above_axis(other_leg(clamped), {magnitude(clamped), 0}, clamped < 0);
}

// exp(x) = 2^k exp(r) with |r| <= ln(2) / 2; first omitted term of the series below 2^-57.
double exp(double x) {
  constexpr double kLargest = 0x1.62e42fefa39efp+9;    // exp of the next double overflows
  constexpr double kSmallest = -0x1.74910d52d3052p+9;  // half of the smallest subnormal
  constexpr double kInverseLn2 = 0x1.71547652b82fep+0;
  constexpr double kLn2Hi = 0x1.62e42fefa38p-1;  // 42 bits: times k is exact
  constexpr double kLn2Lo = 0x1.ef35793c7673p-45;
  constexpr std::array<double, 13> kSeries = {
      inverse_factorial(2),  inverse_factorial(3),  inverse_factorial(4),  inverse_factorial(5),
      inverse_factorial(6),  inverse_factorial(7),  inverse_factorial(8),  inverse_factorial(9),
      inverse_factorial(10), inverse_factorial(11), inverse_factorial(12), inverse_factorial(13),
      inverse_factorial(14)};
  if (x > kLargest) return std::numeric_limits<double>::max();
  if (x < kSmallest) return 0;
  const double k = nearest_integer(x * kInverseLn2);
  const Pair r = two_sum(x - k * kLn2Hi, -(k * kLn2Lo));
  const double quadratic = r.hi * r.hi * polynomial(r.hi, kSeries);
  const Pair linear = fast_two_sum(1.0, r.hi);
  const double mantissa = linear.hi + (linear.lo + (quadratic + (r.lo + r.lo * r.hi)));
  // In two steps: 2^k itself may lie beyond the range of normal numbers.
  const auto exponent = static_cast<std::int64_t>(k);
  const std::int64_t half = exponent / 2;
  return mantissa * power_of_two(half) * power_of_two(exponent - half);
}

// log(2^k m) = k ln 2 + 2 atanh(s), s = (m - 1) / (m + 1), m in [sqrt(1/2), sqrt(2)];
// first omitted term of the series below 2^-60.
double log(double x) {
  constexpr double kSqrt2 = 0x1.6a09e667f3bcdp+0;
  constexpr double kLn2Hi = 0x1.62e42fefa38p-1;
  constexpr double kLn2Lo = 0x1.ef35793c7673p-45;
  constexpr std::array<double, 10> kSeries = {2.0 / 3,  2.0 / 5,  2.0 / 7,  2.0 / 9,  2.0 / 11,
                                              2.0 / 13, 2.0 / 15, 2.0 / 17, 2.0 / 19, 2.0 / 21};
  SUREFOOT_ASSERT(x > 0);
  const bool subnormal = x < std::numeric_limits<double>::min();
  const auto bits = std::bit_cast<std::uint64_t>(subnormal ? x * 0x1p+54 : x);
  auto exponent = static_cast<std::int32_t>(bits >> 52u) - (subnormal ? 1023 + 54 : 1023);
  double m = std::bit_cast<double>((bits & 0x000fffffffffffffull) | 0x3ff0000000000000ull);
  if (m > kSqrt2) {
    m *= 0.5;
    ++exponent;
  }
  const double k = exponent;
  const Pair s = divide({m - 1, 0}, two_sum(m, 1));
  const double square = s.hi * s.hi;
  const double cubic = s.hi * square * polynomial(square, kSeries);
  const Pair sum = fast_two_sum(k * kLn2Hi, 2 * s.hi);
  return sum.hi + (sum.lo + (k * kLn2Lo + (2 * s.lo + cubic)));
}

double wrap_angle(double x) {
  SUREFOOT_ASSERT(x >= -kMaxAngle_rad && x <= kMaxAngle_rad);
  if (x > -kPi && x <= kPi) return x;
  constexpr double kInverseTwoPi = 0x1.45f306dc9c883p-3;
  double quadrants = 4 * nearest_integer(x * kInverseTwoPi);
  double angle = subtract_quadrants(x, quadrants).hi;
  // Near the cut the quotient's rounding may have chosen the neighbouring turn.
  if (angle > kPi) quadrants += 4;
  if (angle <= -kPi) quadrants -= 4;
  angle = subtract_quadrants(x, quadrants).hi;
  return clamp(angle, -kPi, kPi);
}

}  // namespace surefoot::math
