// What matching needs beyond core/math/lanes.h: whole numbers of eight and of 16 bits.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/math/lanes.h"

namespace surefoot::stereo {

using Bytes = UnsignedByteLanes;
using Words = ShortLanes;

inline constexpr std::size_t kBytes = kByteLanes;
inline constexpr std::size_t kWords = kShortLanes;

// All bits set where a < b.
inline Bytes mask_less(Bytes a, Bytes b) { return std::bit_cast<Bytes>(a < b); }
inline Bytes mask_equal(Bytes a, Bytes b) { return std::bit_cast<Bytes>(a == b); }

// Lanes 0 to 7 and 8 to 15 as 16-bit numbers.
inline Words widen_low(Bytes v) {
  return std::bit_cast<Words>(
      __builtin_shufflevector(v, Bytes{}, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23));
}
inline Words widen_high(Bytes v) {
  return std::bit_cast<Words>(__builtin_shufflevector(v, Bytes{}, 8, 24, 9, 25, 10, 26, 11, 27, 12,
                                                      28, 13, 29, 14, 30, 15, 31));
}

// Each lane's neighbour: the lane before it (the last of `before` in front) and the one after.
// Shifts against zero, because only those are one instruction on every CPU.
inline Bytes lanes_before(Bytes before, Bytes v) {
  return __builtin_shufflevector(Bytes{}, v, 0, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28,
                                 29, 30) |
         __builtin_shufflevector(before, Bytes{}, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26,
                                 27, 28, 29, 30);
}
inline Bytes lanes_after(Bytes v, Bytes after) {
  return __builtin_shufflevector(v, Bytes{}, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15,
                                 16) |
         __builtin_shufflevector(Bytes{}, after, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15,
                                 16);
}

// Folds all lanes onto the first by an operation on vectors; the others then hold anything.
template <class Operation>
inline Bytes fold(Bytes v, Operation&& of) {
  v = of(v, __builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7));
  v = of(v, __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3, 8, 9, 10, 11, 12, 13, 14, 15));
  v = of(v, __builtin_shufflevector(v, v, 2, 3, 0, 1, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
  return of(v, __builtin_shufflevector(v, Bytes{}, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14,
                                       15, 16));
}
inline Bytes first_everywhere(Bytes v) {
  return __builtin_shufflevector(v, v, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
}

inline std::uint8_t smallest(Bytes v) {
  return fold(v, [](Bytes a, Bytes b) { return smaller(a, b); })[0];
}
inline Bytes smallest_everywhere(Bytes v) {
  return first_everywhere(fold(v, [](Bytes a, Bytes b) { return smaller(a, b); }));
}
inline std::uint8_t largest(Bytes v) {
  return fold(v, [](Bytes a, Bytes b) { return larger(a, b); })[0];
}
// Modulo 256.
inline std::uint8_t sum_of(Bytes v) {
  return fold(v, [](Bytes a, Bytes b) { return a + b; })[0];
}

}  // namespace surefoot::stereo
