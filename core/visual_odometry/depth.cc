#include "core/visual_odometry/depth.h"

#include <algorithm>

#include "core/math/elementary.h"
#include "core/visual_odometry/alignment.h"

namespace surefoot::visual_odometry {
namespace {

// The rest of the best place's correlation to 1 is at most this share of any other place's.
constexpr double kAmbiguity = 0.8;
constexpr int kSamePlace_px = 2;
constexpr int kSlopeReach_px = 3;
constexpr double kMaxSlope = 0.6;

// Correlation of a patch with the pixels around (u, v) of a picture.
double correlate(const Patch& patch, const stereo::GreyView& picture, int u, int v) {
  std::int32_t sum = 0;
  std::int32_t squares = 0;
  std::int32_t products = 0;
  for (int dv = -kCompareRadius_px; dv <= kCompareRadius_px; ++dv) {
    const std::uint8_t* seen =
        picture.row(static_cast<std::size_t>(v + dv)) + (u - kCompareRadius_px);
    const auto row = static_cast<std::size_t>(dv + kStoreRadius_px);
    const std::uint8_t* own =
        patch.grey.data() + row * kStoreSide_px + kStoreRadius_px - kCompareRadius_px;
    for (int i = 0; i < kCompareSide_px; ++i) {
      sum += seen[i];
      squares += seen[i] * seen[i];
      products += own[i] * seen[i];
    }
  }
  const double spread = squares - static_cast<double>(sum) * sum / kComparePixels;
  if (!(spread > kComparePixels)) return 0;
  const double common = products - static_cast<double>(sum) * patch.sum / kComparePixels;
  return common * patch.inverse_norm / math::sqrt(spread);
}

// The whole disparity of the best place, -1 where there is none or more than one.
int search_row(const stereo::GreyView& right, const VisualOdometryConfig& config,
               const Feature& feature, std::array<double, 256>& scores) {
  const int last =
      std::min(static_cast<int>(config.max_disparity_px), feature.u_px - kCompareRadius_px - 1);
  int best = -1;
  for (int d = 0; d <= last; ++d) {
    const auto i = static_cast<std::size_t>(d);
    scores[i] = correlate(feature.patch, right, feature.u_px - d, feature.v_px);
    if (best < 0 || scores[i] > scores[static_cast<std::size_t>(best)]) best = d;
  }
  if (best < 0) return -1;
  const double best_score = scores[static_cast<std::size_t>(best)];
  if (!(best_score >= config.min_similarity)) return -1;
  for (int d = 0; d <= last; ++d) {
    if (d >= best - kSamePlace_px && d <= best + kSamePlace_px) continue;
    if (1.0 - best_score > kAmbiguity * (1.0 - scores[static_cast<std::size_t>(d)])) return -1;
  }
  return best;
}

// Both pictures are noisy: twice the variance.
void find_depth(const stereo::GreyView& right, const VisualOdometryConfig& config,
                Feature& feature) {
  std::array<double, 256> scores;
  const int whole_px = search_row(right, config, feature, scores);
  Template patch;
  DisparityFit fit;
  if (whole_px < 0 || !make_template(feature.patch, patch)) return;
  if (!fit_disparity(patch, right, feature, whole_px, config.grey_noise, fit)) return;
  if (fit.similarity < config.min_similarity) return;
  if (fit.disparity_px < config.min_disparity_px) return;
  feature.disparity_px = fit.disparity_px;
  feature.disparity_variance_px2 = math::square(config.disparity_noise_px) + 2 * fit.variance_px2;
  feature.disparity_per_u = fit.per_u;
  feature.disparity_per_v = fit.per_v;
}

// Per pixel between two values of a disparity picture; 0 where one is missing or another surface.
double slope_between(std::int16_t from, std::int16_t to) {
  if (from == stereo::kNoDisparity || to == stereo::kNoDisparity) return 0;
  const double slope = (to - from) / (2.0 * kSlopeReach_px * stereo::kSubpixels);
  return math::magnitude(slope) > kMaxSlope ? 0.0 : slope;
}

}  // namespace

void find_depths(const stereo::GreyView& right, const VisualOdometryConfig& config,
                 Features& features) {
  for (Feature& feature : features) {
    feature.disparity_px = 0;
    find_depth(right, config, feature);
  }
}

void read_depths(const stereo::DisparityImage& disparities, const VisualOdometryConfig& config,
                 Features& features) {
  for (Feature& feature : features) {
    const std::size_t u = feature.u_px;
    const std::size_t v = feature.v_px;
    feature.disparity_px = 0;
    const std::int16_t* row = disparities.row(v);
    if (row[u] == stereo::kNoDisparity) continue;
    const double disparity_px = static_cast<double>(row[u]) / stereo::kSubpixels;
    if (disparity_px < config.min_disparity_px || disparity_px > config.max_disparity_px) continue;
    feature.disparity_px = disparity_px;
    feature.disparity_variance_px2 =
        math::square(config.disparity_noise_px) +
        2 * math::square(config.grey_noise) / std::max(kComparePixels * feature.corner, 1.0);
    feature.disparity_per_u = slope_between(row[u - kSlopeReach_px], row[u + kSlopeReach_px]);
    feature.disparity_per_v = slope_between(disparities.row(v - kSlopeReach_px)[u],
                                            disparities.row(v + kSlopeReach_px)[u]);
  }
}

}  // namespace surefoot::visual_odometry
