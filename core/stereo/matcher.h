// Semi-global matching of a rectified pair in fixed memory: census costs, paths from the left, from
// above and from the right, one pass over the rows. README.md has the equations.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/status.h"
#include "core/stereo/census.h"
#include "core/stereo/images.h"
#include "core/stereo/matcher_config.h"
#include "core/stereo/speckle.h"

namespace surefoot::stereo {

struct MatchReport {
  std::uint32_t tried = 0;    // pixels all of whose disparities lie in the right picture
  std::uint32_t matched = 0;  // have a disparity
  std::uint32_t no_contrast = 0;
  std::uint32_t ambiguous = 0;  // not unique
  std::uint32_t one_sided = 0;  // the right picture's view differs
  std::uint32_t outliers = 0;   // most of the 3 x 3 neighbours have none
  std::uint32_t speckles = 0;
};

class Matcher {
 public:
  // kInvalid: see validate(); the last configuration stays.
  Status configure(const MatcherConfig& config);

  // Disparities of the left picture. kInvalid: the pictures differ in size, are smaller than 16
  // pixels or larger than kMax..., or not configured; out is unchanged. A picture narrower than the
  // disparities gives no disparity at all. Cost: O(pixels * disparities), no input takes longer.
  Status match(const GreyView& left, const GreyView& right, DisparityImage& out,
               MatchReport* report = nullptr);

 private:
  static constexpr std::size_t kPad = kBytes;
  static constexpr std::size_t kStride = kMaxDisparities + kPad;

  // Costs of the path from above at every pixel of a row, with a guard between neighbours.
  struct PathRow {
    std::array<std::uint8_t, kMaxWidth_px * kStride + kPad> costs;
    std::array<std::uint8_t, kMaxWidth_px> least;
  };
  struct PixelCosts {  // of a path along the row, with a guard at either end
    alignas(kBytes) std::array<std::uint8_t, kMaxDisparities + 2 * kPad> costs;
    Bytes least;  // of all of them, in every lane
  };

  void prepare(std::size_t columns);
  void aggregate_down(std::size_t columns);
  void aggregate_along(std::size_t columns);
  void extend_along(std::size_t column, std::uint8_t jump_cost, PixelCosts& path);
  void choose(std::size_t column);
  void finish_row(std::size_t columns, std::int16_t* out);
  std::int16_t subpixel(std::size_t column, std::int32_t index) const;
  std::uint8_t jump(std::uint8_t from, std::uint8_t to) const {
    return jump_costs_[from > to ? from - to : to - from];
  }

  MatcherConfig config_;
  bool configured_ = false;
  std::int32_t last_px_ = 0;      // largest disparity
  std::size_t stride_ = 0;        // disparities + kPad
  std::size_t first_column_ = 0;  // pixels before it are not tried
  std::int32_t uniqueness_ = 0;   // 16.16 share by which others must be above the best
  std::array<std::uint8_t, 256> jump_costs_{};

  CensusRow left_;
  CensusRow right_;
  std::array<PathRow, 2> down_{};
  std::size_t above_ = 0;  // which of them is the row above
  PixelCosts from_left_{};
  PixelCosts from_right_{};
  // By column and index: index 0 is the largest disparity, so that right pixels follow each other.
  std::array<std::uint8_t, kMaxWidth_px * kMaxDisparities> costs_{};
  std::array<std::uint8_t, kMaxWidth_px * kMaxDisparities> sums_{};
  std::array<std::uint8_t, kMaxWidth_px + kRowPad> contrast_{};
  std::array<std::int16_t, kMaxWidth_px> chosen_{};       // index, or what is wrong
  std::array<std::int16_t, kMaxWidth_px> right_least_{};  // by right column; kNone
  std::array<std::int16_t, kMaxWidth_px> right_choice_{};
  DisparityImage raw_;
  SpeckleFilter speckles_;
  MatchReport report_;
};

}  // namespace surefoot::stereo
