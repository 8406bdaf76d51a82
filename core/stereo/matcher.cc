#include "core/stereo/matcher.h"

#include <algorithm>

#include "core/stereo/byte_lanes.h"
#include "core/stereo/smoothing.h"

namespace surefoot::stereo {

namespace {

constexpr std::int16_t kAmbiguous = -1;
constexpr std::int16_t kFlat = -2;
constexpr std::int16_t kNoSum = 256;  // above all
constexpr Bytes kFirstRanks = {255, 254, 253, 252, 251, 250, 249, 248,
                               247, 246, 245, 244, 243, 242, 241, 240};

// Bits in which two bytes differ, counted in nibbles.
inline Bytes nibble_counts(Bytes difference) {
  const Bytes pairs = difference - ((difference >> 1) & 0x55);
  return (pairs & 0x33) + ((pairs >> 2) & 0x33);
}

using CensusPixel = std::array<Bytes, kCensusPlanes>;
using CensusPointers = std::array<const std::uint8_t*, kCensusPlanes>;

// Hamming distances of one left pixel to sixteen right ones.
inline Bytes match_costs(const CensusPixel& left, const CensusPointers& right, std::size_t at) {
  const Bytes nibbles = nibble_counts(left[0] ^ load_lanes(right[0] + at)) +
                        nibble_counts(left[1] ^ load_lanes(right[1] + at)) +
                        nibble_counts(left[2] ^ load_lanes(right[2] + at));
  return (nibbles & 0x0F) + (nibbles >> 4);
}

// What every path does at a pixel, for sixteen disparities:
// L(d) = C(d) + min(L'(d), L'(d - 1) + P1, L'(d + 1) + P1, min L' + P2) - min L'. No sum leaves the
// byte: L <= 24 + P2 <= 85, and the guards are 255 - P1.
struct Step {
  Bytes penalty;  // P1
  Bytes least;    // min L'
  Bytes jump;     // min L' + P2

  Bytes extend(Bytes same, Bytes one_less, Bytes one_more, Bytes match) const {
    const Bytes beside = smaller(one_less, one_more) + penalty;
    return smaller(smaller(same, beside), jump) - least + match;
  }
};

}  // namespace

Status validate(const MatcherConfig& config) {
  RangeCheck check;
  MatcherConfig::describe(config, check);
  const std::int32_t last = config.min_disparity_px + config.disparities - 1;
  const bool fits = check.good && last < 511 && config.disparities % kBytes == 0;
  return fits && config.step_penalty <= config.jump_penalty ? Status::kOk : Status::kInvalid;
}

Status Matcher::configure(const MatcherConfig& config) {
  if (!ok(validate(config))) return Status::kInvalid;
  config_ = config;
  configured_ = true;
  stride_ = config.disparities + kPad;
  last_px_ = config.min_disparity_px + config.disparities - 1;
  first_column_ = static_cast<std::size_t>(std::max(last_px_, 0));
  uniqueness_ = (config.uniqueness_percent << 16) / (100 - config.uniqueness_percent);
  for (std::int32_t change = 0; change < 256; ++change) {
    const std::int32_t relieved = config.jump_penalty - change * config.edge_relief / 16;
    jump_costs_[static_cast<std::size_t>(change)] =
        static_cast<std::uint8_t>(std::max<std::int32_t>(
            relieved, std::min<std::int32_t>(config.step_penalty + 4, config.jump_penalty)));
  }
  return Status::kOk;
}

// Guards between pixels, and free entry from above the picture.
void Matcher::prepare(std::size_t columns) {
  const auto guard = static_cast<std::uint8_t>(255 - config_.step_penalty);
  for (PathRow& row : down_) {
    std::fill_n(row.costs.begin(), columns * stride_, std::uint8_t{0});
    for (std::size_t i = 0; i < columns + 1; ++i) {
      std::fill_n(row.costs.data() + i * stride_, kPad, guard);
    }
    std::fill_n(row.least.begin(), columns, std::uint8_t{0});
  }
  from_left_.costs.fill(guard);
  from_right_.costs.fill(guard);
  above_ = 0;
  report_ = {};
}

// Costs of matching, and the path from above.
void Matcher::aggregate_down(std::size_t columns) {
  const std::size_t disparities = config_.disparities;
  const PathRow& above = down_[above_];
  PathRow& here = down_[1 - above_];
  const std::uint8_t* grey = left_.grey(0) + first_column_;
  const std::uint8_t* grey_above = left_.grey(-1) + first_column_;
  for (std::size_t column = 0; column < columns; ++column) {
    const std::size_t u = first_column_ + column;
    const auto first_right = static_cast<std::size_t>(static_cast<std::int32_t>(u) - last_px_);
    const CensusPixel left{all_lanes(left_.planes()[0][u]), all_lanes(left_.planes()[1][u]),
                           all_lanes(left_.planes()[2][u])};
    const CensusPointers right{right_.planes()[0].data() + first_right,
                               right_.planes()[1].data() + first_right,
                               right_.planes()[2].data() + first_right};
    const std::uint8_t* from = above.costs.data() + column * stride_ + kPad;
    std::uint8_t* to = here.costs.data() + column * stride_ + kPad;
    const Bytes least = all_lanes(above.least[column]);
    const Step step{all_lanes(config_.step_penalty), least,
                    least + jump(grey_above[column], grey[column])};
    std::uint8_t* costs = costs_.data() + column * disparities;
    std::uint8_t* sums = sums_.data() + column * disparities;
    Bytes low = all_lanes<std::uint8_t>(255);
    for (std::size_t k = 0; k < disparities; k += kBytes) {
      const Bytes match = match_costs(left, right, k);
      const Bytes cost = step.extend(load_lanes(from + k), load_lanes(from + k - 1),
                                     load_lanes(from + k + 1), match);
      low = smaller(low, cost);
      store_lanes(match, costs + k);
      store_lanes(cost, to + k);
      store_lanes(cost, sums + k);
    }
    here.least[column] = smallest(low);
  }
  above_ = 1 - above_;
}

// One pixel of a path along the row, in place: every chunk is read before it is overwritten.
void Matcher::extend_along(std::size_t column, std::uint8_t jump_cost, PixelCosts& path) {
  const std::size_t disparities = config_.disparities;
  const std::uint8_t* costs = costs_.data() + column * disparities;
  std::uint8_t* sums = sums_.data() + column * disparities;
  std::uint8_t* own = path.costs.data() + kPad;
  const Step step{all_lanes(config_.step_penalty), path.least, path.least + jump_cost};
  Bytes low = all_lanes<std::uint8_t>(255);
  Bytes before = load_lanes(own - kBytes);
  Bytes here = load_lanes(own);
  for (std::size_t k = 0; k < disparities; k += kBytes) {
    const Bytes after = load_lanes(own + k + kBytes);
    const Bytes cost = step.extend(here, lanes_before(before, here), lanes_after(here, after),
                                   load_lanes(costs + k));
    low = smaller(low, cost);
    store_lanes(cost, own + k);
    store_lanes(load_lanes(sums + k) + cost, sums + k);
    before = here;
    here = after;
  }
  path.least = smallest_everywhere(low);
}

// The paths from the left and from the right. Each waits for its own last pixel all the time, so
// both are walked at once.
void Matcher::aggregate_along(std::size_t columns) {
  for (PixelCosts* path : {&from_left_, &from_right_}) {
    std::fill_n(path->costs.data() + kPad, config_.disparities, std::uint8_t{0});
    path->least = Bytes{};
  }
  const std::uint8_t* grey = left_.grey(0) + first_column_;
  const std::uint8_t* grey_before = grey - 1;
  for (std::size_t i = 0; i < columns; ++i) {
    const std::size_t back = columns - 1 - i;
    extend_along(i, jump(grey_before[i], grey[i]), from_left_);
    extend_along(back, jump(grey[back + 1], grey[back]), from_right_);
  }
}

// The first index with the least sum, if no other but its neighbours comes near.
void Matcher::choose(std::size_t column) {
  const std::size_t disparities = config_.disparities;
  const std::uint8_t* sums = sums_.data() + column * disparities;
  Bytes low = load_lanes(sums);
  for (std::size_t k = kBytes; k < disparities; k += kBytes) {
    low = smaller(low, load_lanes(sums + k));
  }
  const std::uint8_t least = smallest(low);
  const std::int32_t bound = std::min(least + ((least * uniqueness_) >> 16), 254);
  const Bytes least_lanes = all_lanes(least);
  const Bytes bound_lanes = all_lanes(static_cast<std::uint8_t>(bound));
  Bytes rank = kFirstRanks;  // 255 - index
  Bytes found{};
  Bytes near{};
  for (std::size_t k = 0; k < disparities; k += kBytes) {
    const Bytes sum = load_lanes(sums + k);
    found = larger(found, mask_equal(sum, least_lanes) & rank);
    near -= mask_equal(smaller(sum, bound_lanes), sum);
    rank -= 16;
  }
  const std::int32_t index = 255 - largest(found);
  const auto at = static_cast<std::size_t>(index);
  std::int32_t others = sum_of(near) - 1;  // of 256 near ones 255 remain
  if (at > 0 && sums[at - 1] <= bound) --others;
  if (at + 1 < disparities && sums[at + 1] <= bound) --others;
  const std::int32_t disparity = last_px_ - index;
  const std::size_t u = first_column_ + column;
  const auto right = static_cast<std::size_t>(static_cast<std::int32_t>(u) - disparity);
  if (least < right_least_[right]) {
    right_least_[right] = least;
    right_choice_[right] = static_cast<std::int16_t>(disparity);
  }
  const bool unique = config_.uniqueness_percent == 0 || others == 0;
  chosen_[column] = contrast_[u] < config_.min_contrast ? kFlat
                    : unique                            ? static_cast<std::int16_t>(index)
                                                        : kAmbiguous;
}

// Sub-pixel part from the sums beside the least: two lines of equal slope (equiangular fit). Only
// of the paths along the row: where disparities change from row to row, the path from above prefers
// the value of the row before, and its sums would drag this one after it.
std::int16_t Matcher::subpixel(std::size_t column, std::int32_t index) const {
  const std::int32_t whole = (last_px_ - index) * kSubpixels;
  if (index == 0 || index + 1 == config_.disparities) return static_cast<std::int16_t>(whole);
  const auto at = static_cast<std::size_t>(index);
  const std::uint8_t* sum = sums_.data() + column * config_.disparities + at;
  const std::uint8_t* down = down_[above_].costs.data() + column * stride_ + kPad + at;
  const std::int32_t least = sum[0] - down[0];
  const std::int32_t larger_side = sum[-1] - down[-1] - least;  // larger disparity
  const std::int32_t smaller_side = sum[1] - down[1] - least;
  const std::int32_t steeper = std::max(larger_side, smaller_side);
  if (steeper <= 0) return static_cast<std::int16_t>(whole);
  // The least of all three paths need not be that of two.
  const std::int32_t shift = std::clamp((smaller_side - larger_side) * (kSubpixels / 2) / steeper,
                                        -kSubpixels / 2, kSubpixels / 2);
  return static_cast<std::int16_t>(whole + shift);
}

void Matcher::finish_row(std::size_t columns, std::int16_t* out) {
  for (std::size_t column = 0; column < columns; ++column) {
    const std::int16_t index = chosen_[column];
    const std::size_t u = first_column_ + column;
    if (index == kFlat) {
      ++report_.no_contrast;
    } else if (index == kAmbiguous) {
      ++report_.ambiguous;
    } else {
      const std::int32_t disparity = last_px_ - index;
      const auto right = static_cast<std::size_t>(static_cast<std::int32_t>(u) - disparity);
      const std::int32_t difference = right_choice_[right] - disparity;
      if (std::max(difference, -difference) > config_.left_right_tolerance_px) {
        ++report_.one_sided;
      } else {
        out[u] = subpixel(column, index);
      }
    }
  }
}

Status Matcher::match(const GreyView& left, const GreyView& right, DisparityImage& out,
                      MatchReport* report) {
  const bool same = left.width_px == right.width_px && left.height_px == right.height_px;
  if (!configured_ || !same || left.width_px < 16 || left.height_px < 16 ||
      left.width_px > kMaxWidth_px || left.height_px > kMaxHeight_px) {
    return Status::kInvalid;
  }
  raw_.width_px = left.width_px;
  raw_.height_px = left.height_px;
  std::fill_n(raw_.values.begin(), raw_.pixel_count(), kNoDisparity);
  const std::int32_t end = left.width_px + std::min<std::int32_t>(config_.min_disparity_px, 0);
  const auto columns =
      static_cast<std::size_t>(std::max(0, end - static_cast<std::int32_t>(first_column_)));
  prepare(columns);
  left_.start(left);
  right_.start(right);
  for (std::size_t v = 0; v < left.height_px && columns > 0; ++v) {
    left_.advance(left, v);
    right_.advance(right, v);
    left_.contrast(left.width_px, contrast_.data());
    std::copy_n(contrast_.begin(), left.width_px, out.contrasts.begin() + v * left.width_px);
    std::fill_n(right_least_.begin(), left.width_px, kNoSum);
    aggregate_down(columns);
    aggregate_along(columns);
    for (std::size_t column = 0; column < columns; ++column) choose(column);
    finish_row(columns, raw_.row(v));
  }
  report_.tried = static_cast<std::uint32_t>(columns * left.height_px);
  report_.outliers = median_filter(raw_, out);
  report_.speckles = speckles_.run(
      config_.speckle_pixels, static_cast<std::int16_t>(config_.speckle_step_px * kSubpixels), out);
  if (config_.smooth_radius_px > 0) {
    std::copy_n(out.values.begin(), out.pixel_count(), raw_.values.begin());
    smooth(raw_, config_.smooth_radius_px, out);
  }
  report_.matched = static_cast<std::uint32_t>(std::count_if(
      out.values.begin(), out.values.begin() + static_cast<std::ptrdiff_t>(out.pixel_count()),
      [](std::int16_t value) { return value != kNoDisparity; }));
  if (report != nullptr) *report = report_;
  return Status::kOk;
}

}  // namespace surefoot::stereo
