#include "core/stereo/point_cloud.h"

namespace surefoot::stereo {

namespace {

// Second difference of the disparities before, at and behind a pixel [px]; 0 where one is missing.
double bend_px(std::int16_t before, std::int16_t here, std::int16_t behind) {
  if (before == kNoDisparity || behind == kNoDisparity) return 0.0;
  return static_cast<double>(before + behind - 2 * here) / kSubpixels;
}

}  // namespace

double disparity_variance_px2(const DisparityImage& image, std::size_t u, std::size_t v,
                              const DisparityNoise& noise) {
  const double contrast = image.contrasts[v * image.width_px + u];
  const double grey_px = contrast > 0.0 ? noise.grey_noise / contrast : noise.grey_noise;
  constexpr std::size_t kReach = kReliefReach_px;
  const std::int16_t* row = image.row(v);
  double relief2 = 0.0;
  if (u >= kReach && u + kReach < image.width_px) {
    const double along = bend_px(row[u - kReach], row[u], row[u + kReach]);
    relief2 += along * along;
  }
  if (v >= kReach && v + kReach < image.height_px) {
    const double down = bend_px(image.row(v - kReach)[u], row[u], image.row(v + kReach)[u]);
    relief2 += down * down;
  }
  return noise.disparity_floor_px * noise.disparity_floor_px + grey_px * grey_px +
         noise.relief_share * noise.relief_share * relief2;
}

bool is_foreground_rim(const DisparityImage& image, std::size_t u, std::size_t v,
                       std::size_t rim_px, double step_px) {
  const int step = static_cast<int>(step_px * kSubpixels);
  const int own = image.row(v)[u];
  const auto farther = [&](std::size_t x, std::size_t y) {
    const std::int16_t there = image.row(y)[x];
    return there != kNoDisparity && there > 0 && own - there > step;
  };
  for (std::size_t k = 1; k <= rim_px; ++k) {
    if (u >= k && farther(u - k, v)) return true;
    if (u + k < image.width_px && farther(u + k, v)) return true;
    if (v >= k && farther(u, v - k)) return true;
    if (v + k < image.height_px && farther(u, v + k)) return true;
  }
  return false;
}

Status make_points(const DisparityImage& image, const RectifiedPair& pair,
                   const PointConfig& config, PointCloud& out) {
  out.clear();
  RangeCheck check;
  PointConfig::describe(config, check);
  if (!check.good || image.width_px != pair.width_px || image.height_px != pair.height_px ||
      !(pair.focal_px > 0.0 && pair.baseline_m > 0.0)) {
    return Status::kInvalid;
  }
  const double focal_baseline = pair.focal_px * pair.baseline_m;
  for (std::size_t v = 0; v < image.height_px; v += config.stride) {
    for (std::size_t u = 0; u < image.width_px; u += config.stride) {
      const std::int16_t value = image.row(v)[u];
      if (value == kNoDisparity || value <= 0) continue;  // at infinity or beyond
      const double z = focal_baseline * kSubpixels / value;
      if (!(z >= config.min_range_m && z <= config.max_range_m)) continue;
      const double z_per_px = z * z / focal_baseline;
      StereoPoint point;
      point.p_N_m = Vector3((static_cast<double>(u) - pair.cx_px) / pair.focal_px * z,
                            (static_cast<double>(v) - pair.cy_px) / pair.focal_px * z, z);
      point.variance_m2 = z_per_px * z_per_px * disparity_variance_px2(image, u, v, config.noise);
      point.u_px = static_cast<std::uint16_t>(u);
      point.v_px = static_cast<std::uint16_t>(v);
      if (!ok(out.push_back(point))) return Status::kExhausted;
    }
  }
  return Status::kOk;
}

}  // namespace surefoot::stereo
