#include "core/visual_odometry/features.h"

#include <algorithm>

#include "core/math/elementary.h"

namespace surefoot::visual_odometry {
namespace {

// Of 49 pixels whose gradients are differences over two.
constexpr float kTensorScale = 1.0F / (49.0F * 4.0F);

std::size_t cells(std::size_t length_px, std::size_t cell_px) {
  return (length_px + cell_px - 1) / cell_px;
}

std::size_t smallest_cell_px(const stereo::GreyView& picture) {
  std::size_t cell_px = 8;
  while (cells(picture.width_px, cell_px) * cells(picture.height_px, cell_px) > kMaxFeatures) {
    ++cell_px;
  }
  return cell_px;
}

}  // namespace

void smooth_picture(const stereo::GreyView& in, stereo::GreyImage& out) {
  out.width_px = in.width_px;
  out.height_px = in.height_px;
  const std::size_t width = in.width_px;
  for (std::size_t v = 0; v < in.height_px; ++v) {
    const std::uint8_t* row = in.row(v);
    std::uint8_t* to = out.pixels.data() + v * width;
    if (v == 0 || v + 1 == in.height_px) {
      std::copy_n(row, width, to);
      continue;
    }
    const std::uint8_t* above = in.row(v - 1);
    const std::uint8_t* below = in.row(v + 1);
    to[0] = row[0];
    to[width - 1] = row[width - 1];
    for (std::size_t u = 1; u + 1 < width; ++u) {
      const int middle = above[u] + 2 * row[u] + below[u];
      const int sides = above[u - 1] + 2 * row[u - 1] + below[u - 1] + above[u + 1] +
                        2 * row[u + 1] + below[u + 1];
      to[u] = static_cast<std::uint8_t>((2 * middle + sides + 8) / 16);
    }
  }
}

void take_patch(const stereo::GreyView& picture, int u_px, int v_px, Patch& out) {
  for (int dv = -kStoreRadius_px; dv <= kStoreRadius_px; ++dv) {
    const std::uint8_t* from =
        picture.row(static_cast<std::size_t>(v_px + dv)) + (u_px - kStoreRadius_px);
    const auto row = static_cast<std::size_t>(dv + kStoreRadius_px);
    std::copy_n(from, kStoreSide_px, out.grey.data() + row * kStoreSide_px);
  }
  std::int32_t sum = 0;
  std::int32_t squares = 0;
  for (int dv = -kCompareRadius_px; dv <= kCompareRadius_px; ++dv) {
    for (int du = -kCompareRadius_px; du <= kCompareRadius_px; ++du) {
      const std::int32_t grey = out.at(du, dv);
      sum += grey;
      squares += grey * grey;
    }
  }
  out.sum = sum;
  const double spread = squares - static_cast<double>(sum) * sum / kComparePixels;
  out.inverse_norm = spread > kComparePixels ? 1.0 / math::sqrt(spread) : 0.0;
}

double similarity(const Patch& a, const Patch& b) {
  std::int32_t products = 0;
  for (int dv = -kCompareRadius_px; dv <= kCompareRadius_px; ++dv) {
    const std::size_t first = static_cast<std::size_t>((dv + kStoreRadius_px) * kStoreSide_px +
                                                       kStoreRadius_px - kCompareRadius_px);
    for (std::size_t i = first; i < first + kCompareSide_px; ++i) {
      products += static_cast<std::int32_t>(a.grey[i]) * b.grey[i];
    }
  }
  const double common = products - static_cast<double>(a.sum) * b.sum / kComparePixels;
  return common * a.inverse_norm * b.inverse_norm;
}

// Gradient products of a row, which also replace those of the row that leaves the window.
void CornerFinder::take_row(const stereo::GreyView& picture, std::size_t v) {
  ProductRow& row = products_[v % kWindowRows];
  const std::uint8_t* above = picture.row(v - 1);
  const std::uint8_t* middle = picture.row(v);
  const std::uint8_t* below = picture.row(v + 1);
  for (std::size_t u = 1; u + 1 < picture.width_px; ++u) {
    const std::int32_t gx = middle[u + 1] - middle[u - 1];
    const std::int32_t gy = below[u] - above[u];
    const Products fresh = {gx * gx, gx * gy, gy * gy};
    sums_[u].xx += fresh.xx - row[u].xx;
    sums_[u].xy += fresh.xy - row[u].xy;
    sums_[u].yy += fresh.yy - row[u].yy;
    row[u] = fresh;
  }
}

// Smaller eigenvalues along row v, the middle of the window.
void CornerFinder::score_row(std::size_t width, std::size_t v) {
  ScoreRow& scores = scores_[v % 3];
  Products window;
  for (std::size_t u = 1; u + 1 < width; ++u) {
    window.xx += sums_[u].xx;
    window.xy += sums_[u].xy;
    window.yy += sums_[u].yy;
    if (u < kWindowRows) continue;
    const float xx = kTensorScale * static_cast<float>(window.xx);
    const float xy = kTensorScale * static_cast<float>(window.xy);
    const float yy = kTensorScale * static_cast<float>(window.yy);
    const float half = 0.5F * (xx - yy);
    scores[u - kWindowRadius_px] =
        0.5F * (xx + yy) - static_cast<float>(math::sqrt(half * half + xy * xy));
    const Products& leaving = sums_[u + 1 - kWindowRows];
    window.xx -= leaving.xx;
    window.xy -= leaving.xy;
    window.yy -= leaving.yy;
  }
}

// Row v has its neighbours' scores: its maxima compete in their cells.
void CornerFinder::judge_row(std::size_t width, std::size_t v, std::size_t cell_px,
                             std::size_t columns) {
  const ScoreRow& above = scores_[(v - 1) % 3];
  const ScoreRow& row = scores_[v % 3];
  const ScoreRow& below = scores_[(v + 1) % 3];
  const std::size_t first = v / cell_px * columns;
  for (std::size_t u = kBorder_px; u + kBorder_px < width; ++u) {
    const float score = row[u];
    Best& best = best_[first + u / cell_px];
    if (!(score > best.score)) continue;
    if (score < row[u - 1] || score < row[u + 1]) continue;
    if (score < above[u - 1] || score < above[u] || score < above[u + 1]) continue;
    if (score < below[u - 1] || score < below[u] || score < below[u + 1]) continue;
    best = {score, static_cast<std::uint16_t>(u), static_cast<std::uint16_t>(v)};
  }
}

void CornerFinder::find(const stereo::GreyView& picture, double min_corner, Features& out) {
  out.clear();
  const std::size_t width = picture.width_px;
  const std::size_t height = picture.height_px;
  if (width <= 2 * kBorder_px || height <= 2 * kBorder_px) return;
  const std::size_t cell_px = smallest_cell_px(picture);
  const std::size_t columns = cells(width, cell_px);
  for (ProductRow& row : products_) row.fill({});
  sums_.fill({});
  best_.fill({});
  for (std::size_t v = 1; v + 1 < height; ++v) {
    take_row(picture, v);
    if (v < kWindowRows) continue;
    const std::size_t middle = v - kWindowRadius_px;
    score_row(width, middle);
    const std::size_t judged = middle - 1;
    if (judged >= kBorder_px && judged + kBorder_px < height) {
      judge_row(width, judged, cell_px, columns);
    }
  }
  for (const Best& best : best_) {
    if (!(static_cast<double>(best.score) >= min_corner)) continue;
    Feature feature;
    feature.u_px = best.u_px;
    feature.v_px = best.v_px;
    feature.corner = static_cast<double>(best.score);
    take_patch(picture, best.u_px, best.v_px, feature.patch);
    if (!ok(out.push_back(feature))) return;
  }
}

}  // namespace surefoot::visual_odometry
