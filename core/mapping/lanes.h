// Four floats at a time, in the compiler's own vector notation: SSE2 and NEON, or four scalars
// where there is neither. Only operations that give the same bits everywhere: +, -, comparison.
#pragma once

#include <cstdint>
#include <cstring>

namespace surefoot::mapping {

using Lanes = float __attribute__((vector_size(16)));
using LaneMask = std::int32_t __attribute__((vector_size(16)));  // -1: true, 0: false

inline constexpr std::int32_t kLanes = 4;

inline Lanes load_lanes(const float* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}
inline void store_lanes(Lanes lanes, float* to) { std::memcpy(to, &lanes, sizeof(lanes)); }
inline LaneMask load_mask(const std::int32_t* from) {
  LaneMask mask;
  std::memcpy(&mask, from, sizeof(mask));
  return mask;
}
inline void store_mask(LaneMask mask, std::int32_t* to) { std::memcpy(to, &mask, sizeof(mask)); }
inline Lanes all_lanes(float value) { return Lanes{value, value, value, value}; }

inline LaneMask bits(Lanes lanes) {
  LaneMask mask;
  std::memcpy(&mask, &lanes, sizeof(mask));
  return mask;
}
inline Lanes from_bits(LaneMask mask) {
  Lanes lanes;
  std::memcpy(&lanes, &mask, sizeof(lanes));
  return lanes;
}

// As the scalar a < b ? a : b. No lane is NaN, and no lane is -0 (height_filter.h).
inline Lanes smaller(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes larger(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes magnitude(Lanes a) { return from_bits(bits(a) & 0x7FFFFFFF); }

}  // namespace surefoot::mapping
