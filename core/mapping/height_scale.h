// Two ways to keep heights while they are filtered. What differs is the size of a number and thus
// how many are handled at a time; every comparison has the same outcome.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/mapping/height_filter.h"

namespace surefoot::mapping {

// In metres, +-kNowhere_m where there is none.
class MetreScale {
 public:
  using Number = float;
  using Magnitude = float;  // of a difference of sums
  static constexpr std::int32_t kCount = kLanes;
  static constexpr Number kNowhereHigh = kNowhere_m;
  static constexpr Number kNowhereLow = -kNowhere_m;

  struct Heights {
    Lanes low;     // kNowhereHigh where there is none
    Lanes high;    // kNowhereLow where there is none
    LaneMask fit;  // -1: can be kept so
  };
  static Heights read(const float* heights_m, const std::int8_t*) {
    const Lanes low = load_lanes(heights_m);
    return {low, swap(low, kNowhereHigh), LaneMask{-1, -1, -1, -1}};
  }
  // The other "nowhere" for `nowhere`.
  static Lanes swap(Lanes a, Number nowhere) {
    constexpr auto kSign = static_cast<std::int32_t>(0x80000000U);
    return from_bits(bits(a) ^ ((a == all_lanes(nowhere)) & kSign));
  }
  static Number difference_limit(double metres) { return static_cast<float>(metres); }
  static Magnitude magnitude_limit(double metres) { return static_cast<float>(metres); }
  static float height_m(Number height) { return height; }
  static float magnitude_m(Magnitude magnitude) { return magnitude; }

  // The lowest bytes of code(x) and of the lanes that follow.
  template <class Code>
  static ByteLanes bytes(std::int32_t x, const Code& code) {
    return lower_halves(lower_halves(code(x), code(x + kCount)),
                        lower_halves(code(x + 2 * kCount), code(x + 3 * kCount)));
  }
};

// In whole steps of on_filter_grid() from a base, for ground that rises less than kSpan_m: half the
// memory and twice the lanes. The sum of four heights and the difference of two such sums fit, too.
class StepScale {
 public:
  using Number = std::int16_t;
  using Magnitude = std::uint16_t;
  static constexpr std::int32_t kCount = kShortLanes;
  static constexpr Number kNowhereHigh = 32767;
  static constexpr Number kNowhereLow = -32768;
  static constexpr float kSpan_m = 0.999F;
  static constexpr float kMaxHeight_m = 100.0F;

  // base_m: the middle of the span, on the filter's grid.
  explicit StepScale(float base_m = 0) : base_m_(base_m), shift_m_(514.0F - base_m) {}
  static bool can_hold(float lowest_m, float highest_m) {
    return highest_m - lowest_m < kSpan_m && lowest_m > -kMaxHeight_m && highest_m < kMaxHeight_m;
  }

  struct Heights {
    ShortLanes low;
    ShortLanes high;
    ShortLanes fit;
  };
  // holes: -1 where the height is kNowhere_m.
  Heights read(const float* heights_m, const std::int8_t* holes) const {
    const ShortLanes low =
        lower_halves(to_steps(heights_m), to_steps(heights_m + kLanes)) ^ kNowhereLow;
    const ShortLanes hole = first_masks(load_lanes(holes));
    return {low, low ^ hole, (low >= -kMostSteps) & ((low < kMostSteps) | hole)};
  }
  static ShortLanes swap(ShortLanes a, Number nowhere) { return a ^ (a == all_lanes(nowhere)); }
  // Compared with whole numbers of steps, a limit counts as the one below.
  static Number difference_limit(double metres) {
    return static_cast<Number>(std::min(steps(metres), 32767.0));
  }
  static Magnitude magnitude_limit(double metres) {
    return static_cast<Magnitude>(std::min(steps(metres), 65535.0));
  }
  float height_m(Number height) const {
    return height == kNowhereLow ? -kNowhere_m : base_m_ + magnitude_of(height);
  }
  static float magnitude_m(Magnitude magnitude) { return magnitude_of(magnitude); }

  template <class Code>
  static ByteLanes bytes(std::int32_t x, const Code& code) {
    return lower_halves(code(x), code(x + kCount));
  }

 private:
  static constexpr std::int16_t kMostSteps = 8192;  // from the base
  static constexpr float kStep_m = 1.0F / 16384;

  static float magnitude_of(std::int32_t steps) { return static_cast<float>(steps) * kStep_m; }
  static double steps(double metres) {
    return static_cast<double>(static_cast<float>(metres)) / static_cast<double>(kStep_m);
  }
  LaneMask to_steps(const float* heights_m) const {
    const Lanes shifted = load_lanes(heights_m) + shift_m_;
    return bits(larger(smaller(shifted, all_lanes(most_m_)), all_lanes(least_m_)));
  }

  float base_m_;
  // From 512 to 1024 the last bit of a float is worth a step: its lower half counts them from 512.
  // The base is moved to 514. (g++ takes one instruction for the lesser of two variables, but four
  // where one is a constant.)
  float shift_m_;
  float least_m_ = 512.0F;
  float most_m_ = 516.0F - kStep_m;
};

}  // namespace surefoot::mapping
