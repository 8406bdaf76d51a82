// Sixteen bytes of numbers at a time, in the compiler's own vector notation: SSE2 and NEON, or
// scalars where there is neither. Only operations that give the same bits everywhere; sums and
// differences of whole numbers wrap around. Parts of numbers are taken as they lie in memory, the
// lowest first, which holds for all targets.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

namespace surefoot {

static_assert(std::endian::native == std::endian::little);

// A comparison gives lanes of whole numbers of the same size, -1: true, 0: false.
using Lanes = float __attribute__((vector_size(16)));
using LaneMask = std::int32_t __attribute__((vector_size(16)));
using DoubleLanes = double __attribute__((vector_size(16)));
using DoubleMask = std::int64_t __attribute__((vector_size(16)));
using ShortLanes = std::int16_t __attribute__((vector_size(16)));
using UnsignedShortLanes = std::uint16_t __attribute__((vector_size(16)));
using ByteLanes = std::int8_t __attribute__((vector_size(16)));
using UnsignedByteLanes = std::uint8_t __attribute__((vector_size(16)));

inline constexpr std::int32_t kLanes = 4;
inline constexpr std::int32_t kDoubleLanes = 2;
inline constexpr std::int32_t kShortLanes = 8;
inline constexpr std::int32_t kByteLanes = 16;

template <class Number>
struct LanesOf {};
template <>
struct LanesOf<float> {
  using Type = Lanes;
};
template <>
struct LanesOf<double> {
  using Type = DoubleLanes;
};
template <>
struct LanesOf<std::int16_t> {
  using Type = ShortLanes;
};
template <>
struct LanesOf<std::uint16_t> {
  using Type = UnsignedShortLanes;
};
template <>
struct LanesOf<std::int8_t> {
  using Type = ByteLanes;
};
template <>
struct LanesOf<std::uint8_t> {
  using Type = UnsignedByteLanes;
};

template <class Number>
typename LanesOf<Number>::Type load_lanes(const Number* from) {
  typename LanesOf<Number>::Type lanes;
  std::memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}
template <class Number>
void store_lanes(typename LanesOf<Number>::Type lanes, Number* to) {
  std::memcpy(to, &lanes, sizeof(lanes));
}
// By themselves: the sum below would lose -0.
inline Lanes all_lanes(float a) { return Lanes{a, a, a, a}; }
inline DoubleLanes all_lanes(double a) { return DoubleLanes{a, a}; }
template <class Number>
typename LanesOf<Number>::Type all_lanes(Number a) {
  return typename LanesOf<Number>::Type{} + a;
}

template <class To, class From>
To as_lanes(From lanes) {
  static_assert(sizeof(To) == sizeof(From));
  To result;
  std::memcpy(&result, &lanes, sizeof(result));
  return result;
}
inline LaneMask bits(Lanes lanes) { return as_lanes<LaneMask>(lanes); }
inline Lanes from_bits(LaneMask mask) { return as_lanes<Lanes>(mask); }
inline DoubleMask bits(DoubleLanes lanes) { return as_lanes<DoubleMask>(lanes); }
inline DoubleLanes from_bits(DoubleMask mask) { return as_lanes<DoubleLanes>(mask); }

// A bit for each lane, the first one's lowest.
inline std::uint32_t lane_bits(LaneMask mask) {
  LaneMask sum = mask & LaneMask{1, 2, 4, 8};
  sum |= __builtin_shufflevector(sum, sum, 2, 3, 0, 1);
  return static_cast<std::uint32_t>(sum[0] | sum[1]);
}

inline bool any(DoubleMask mask) { return (mask[0] | mask[1]) != 0; }

// Two floats, exactly.
inline DoubleLanes load_widened(const float* from) {
  return DoubleLanes{static_cast<double>(from[0]), static_cast<double>(from[1])};
}
// No lane below 0.
inline Lanes square_root(Lanes a) {
  return Lanes{__builtin_sqrtf(a[0]), __builtin_sqrtf(a[1]), __builtin_sqrtf(a[2]),
               __builtin_sqrtf(a[3])};
}

// As the scalar a < b ? a : b. Where no lane is NaN or -0, the order of a and b does not
// matter.
template <class Numbers>
Numbers smaller(Numbers a, Numbers b) {
  return a < b ? a : b;
}
template <class Numbers>
Numbers larger(Numbers a, Numbers b) {
  return a > b ? a : b;
}

inline Lanes sum(Lanes a, Lanes b) { return a + b; }
inline ShortLanes sum(ShortLanes a, ShortLanes b) {
  return as_lanes<ShortLanes>(as_lanes<UnsignedShortLanes>(a) + as_lanes<UnsignedShortLanes>(b));
}
inline ByteLanes sum(ByteLanes a, ByteLanes b) { return a + b; }
inline Lanes difference(Lanes a, Lanes b) { return a - b; }
inline ShortLanes difference(ShortLanes a, ShortLanes b) {
  return as_lanes<ShortLanes>(as_lanes<UnsignedShortLanes>(a) - as_lanes<UnsignedShortLanes>(b));
}
inline Lanes magnitude(Lanes a) { return from_bits(bits(a) & 0x7FFFFFFF); }
// |a - b|, which fits always.
inline Lanes distance(Lanes a, Lanes b) { return magnitude(a - b); }
inline UnsignedShortLanes distance(ShortLanes a, ShortLanes b) {
  return as_lanes<UnsignedShortLanes>(difference(larger(a, b), smaller(a, b)));
}

// The lower halves of all numbers.
inline ShortLanes lower_halves(LaneMask first, LaneMask last) {
  return __builtin_shufflevector(as_lanes<ShortLanes>(first), as_lanes<ShortLanes>(last), 0, 2, 4,
                                 6, 8, 10, 12, 14);
}
inline ByteLanes lower_halves(ShortLanes first, ShortLanes last) {
  return __builtin_shufflevector(as_lanes<ByteLanes>(first), as_lanes<ByteLanes>(last), 0, 2, 4, 6,
                                 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
}
// The first eight of sixteen masks, each twice as wide.
inline ShortLanes first_masks(ByteLanes a) {
  return as_lanes<ShortLanes>(
      __builtin_shufflevector(a, a, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7));
}

}  // namespace surefoot
