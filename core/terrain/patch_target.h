// The surroundings of one cell to be filled, laid out for quick comparison with many patches.
#pragma once

#include <array>
#include <cstdint>

#include "core/terrain/patch_library.h"

namespace surefoot::terrain {

inline constexpr std::int32_t kRowFloats = 16;  // room of a patch's row; a multiple of the lanes
inline constexpr float kNoCeiling_m = 1e6f;

// How well a patch fits. b is figure 6's bias, the mean of A - C over the known cells.
struct PatchFit {
  float height_m = 0;    // of the middle cell: C + b
  float difference = 0;  // s: sum of W B (C + b - A)^2 [m^2]
  float violation = 0;   // v: sum of max(C + b - ceiling, 0)^2 over cells with a ceiling [m^2]
};

class PatchTarget {
 public:
  // patch_cells odd, 3..15.
  void reset(std::int32_t patch_cells);
  // Row `row` of the surroundings, column by column: height and weight of known cells (weight 0:
  // not known), ceilings to be respected (kNoCeiling_m: none).
  void set(std::int32_t column, std::int32_t row, float height_m, float known, float weight,
           float ceiling_m) {
    const auto i = table_index(column, row, kRowFloats);
    height_m_[i] = height_m;
    known_[i] = known;
    weight_[i] = weight;
    ceiling_m_[i] = ceiling_m;
  }
  // After the last set(). False: nothing around is known, no patch can be compared.
  bool finish();

  PatchFit fit(const PatchLibrary::Patch& patch) const;

 private:
  template <std::int32_t kRowLanes>
  PatchFit fit_rows(const PatchLibrary::Patch& patch) const;

  std::int32_t side_ = 0;
  float known_count_ = 0;
  float mean_m_ = 0;  // of the known heights
  alignas(16) std::array<float, kMaxPatch_cells * kRowFloats> height_m_{};
  alignas(16) std::array<float, kMaxPatch_cells * kRowFloats> known_{};
  alignas(16) std::array<float, kMaxPatch_cells * kRowFloats> weight_{};
  alignas(16) std::array<float, kMaxPatch_cells * kRowFloats> ceiling_m_{};
};

}  // namespace surefoot::terrain
