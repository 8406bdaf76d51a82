#include "core/terrain/patch_target.h"

#include "core/math/lanes.h"

namespace surefoot::terrain {

namespace {

float total(Lanes lanes) { return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]); }

}  // namespace

void PatchTarget::reset(std::int32_t patch_cells) {
  SUREFOOT_ASSERT(patch_cells >= 3 && patch_cells <= kMaxPatch_cells && patch_cells % 2 == 1);
  side_ = patch_cells;
  height_m_.fill(0);
  known_.fill(0);
  weight_.fill(0);
  ceiling_m_.fill(kNoCeiling_m);
}

bool PatchTarget::finish() {
  Lanes count = all_lanes(0.0f);
  Lanes sum = all_lanes(0.0f);
  for (std::int32_t i = 0; i < side_ * kRowFloats; i += kLanes) {
    const Lanes known = load_lanes(&known_[static_cast<std::size_t>(i)]);
    count += known;
    sum += known * load_lanes(&height_m_[static_cast<std::size_t>(i)]);
  }
  known_count_ = total(count);
  if (!(known_count_ > 0)) return false;
  mean_m_ = total(sum) / known_count_;
  return true;
}

template <std::int32_t kRowLanes>
PatchFit PatchTarget::fit_rows(const PatchLibrary::Patch& patch) const {
  Lanes sum = all_lanes(0.0f);
  const float* from = patch.corner;
  for (std::int32_t row = 0; row < side_; ++row, from += patch.pitch) {
    const float* known = &known_[table_index(0, row, kRowFloats)];
    for (std::int32_t k = 0; k < kRowLanes; ++k) {
      sum += load_lanes(known + k * kLanes) * load_lanes(from + k * kLanes);
    }
  }
  const float bias_m = mean_m_ - total(sum) / known_count_;
  const Lanes bias = all_lanes(bias_m);
  const Lanes zero = all_lanes(0.0f);
  Lanes difference = zero;
  Lanes violation = zero;
  from = patch.corner;
  for (std::int32_t row = 0; row < side_; ++row, from += patch.pitch) {
    const auto begin = table_index(0, row, kRowFloats);
    for (std::int32_t k = 0; k < kRowLanes; ++k) {
      const std::size_t i = begin + static_cast<std::size_t>(k * kLanes);
      const Lanes shifted = load_lanes(from + k * kLanes) + bias;
      const Lanes off = shifted - load_lanes(&height_m_[i]);
      difference += load_lanes(&weight_[i]) * (off * off);
      const Lanes above = larger(shifted - load_lanes(&ceiling_m_[i]), zero);
      violation += above * above;
    }
  }
  const std::int32_t middle = side_ / 2;
  return {patch.corner[middle * patch.pitch + middle] + bias_m, total(difference),
          total(violation)};
}

PatchFit PatchTarget::fit(const PatchLibrary::Patch& patch) const {
  if (side_ <= 4) return fit_rows<1>(patch);
  if (side_ <= 8) return fit_rows<2>(patch);
  if (side_ <= 12) return fit_rows<3>(patch);
  return fit_rows<4>(patch);
}

}  // namespace surefoot::terrain
