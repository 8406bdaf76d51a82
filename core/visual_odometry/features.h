// Corners of a picture with what surrounds them: found in buckets, kept in fixed memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/fixed_vector.h"
#include "core/stereo/images.h"

namespace surefoot::visual_odometry {

inline constexpr std::size_t kMaxFeatures = 400;

// Patches are square. The compared part is the middle of the stored one: a patch that turns and
// grows still finds its pixels inside.
inline constexpr int kCompareRadius_px = 5;
inline constexpr int kStoreRadius_px = 8;
inline constexpr int kCompareSide_px = 2 * kCompareRadius_px + 1;
inline constexpr int kStoreSide_px = 2 * kStoreRadius_px + 1;
inline constexpr int kComparePixels = kCompareSide_px * kCompareSide_px;
inline constexpr int kBorder_px = kStoreRadius_px + 1;

struct Patch {
  std::array<std::uint8_t, kStoreSide_px * kStoreSide_px> grey{};
  std::int32_t sum = 0;     // of the compared part
  double inverse_norm = 0;  // of its deviations from their mean; 0: it is plain

  // (0, 0) is the middle.
  std::uint8_t at(int du, int dv) const {
    const auto row = static_cast<std::size_t>(dv + kStoreRadius_px);
    return grey[row * kStoreSide_px + static_cast<std::size_t>(du + kStoreRadius_px)];
  }
};

struct Feature {
  std::uint16_t u_px = 0;
  std::uint16_t v_px = 0;
  double corner = 0;        // smaller eigenvalue of the mean gradient tensor
  double disparity_px = 0;  // 0: unknown
  double disparity_variance_px2 = 0;
  double disparity_per_u = 0;  // of the surface around, px / px
  double disparity_per_v = 0;
  Patch patch;

  bool has_depth() const { return disparity_px > 0; }
};

using Features = FixedVector<Feature, kMaxFeatures>;

// Binomial 3 x 3: halves the noise, and what is interpolated in it moves less with the fraction of
// the pixel. Rows and columns at the border are copied.
void smooth_picture(const stereo::GreyView& in, stereo::GreyImage& out);

// The patch around a pixel at least kBorder_px inside.
void take_patch(const stereo::GreyView& picture, int u_px, int v_px, Patch& out);

// Correlation of the compared parts, -1 to 1; 0 where one is plain. Exposure and gain drop out.
double similarity(const Patch& a, const Patch& b);

class CornerFinder {
 public:
  // The strongest corner of every cell (Shi and Tomasi 1994: the smaller eigenvalue, over 7 x 7
  // pixels); of equals the first in reading order. The cells are the smallest squares of which
  // kMaxFeatures cover the picture. Cost: O(pixels).
  void find(const stereo::GreyView& picture, double min_corner, Features& out);

 private:
  static constexpr int kWindowRadius_px = 3;
  static constexpr std::size_t kWindowRows = 2 * kWindowRadius_px + 1;
  struct Products {
    std::int32_t xx = 0;
    std::int32_t xy = 0;
    std::int32_t yy = 0;
  };
  using ProductRow = std::array<Products, stereo::kMaxWidth_px>;
  using ScoreRow = std::array<float, stereo::kMaxWidth_px>;
  struct Best {
    float score = 0;
    std::uint16_t u_px = 0;
    std::uint16_t v_px = 0;
  };

  void take_row(const stereo::GreyView& picture, std::size_t v);
  void score_row(std::size_t width, std::size_t v);
  void judge_row(std::size_t width, std::size_t v, std::size_t cell_px, std::size_t columns);

  std::array<ProductRow, kWindowRows> products_{};  // of row v, at v % kWindowRows
  ProductRow sums_{};                               // of the column's rows in the window
  std::array<ScoreRow, 3> scores_{};                // of row v, at v % 3
  std::array<Best, kMaxFeatures> best_{};
};

}  // namespace surefoot::visual_odometry
