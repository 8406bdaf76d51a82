#include "sim_hal/sensors/sim_depth_camera_port.h"

#include <algorithm>
#include <cmath>

#include "sim_hal/robot/articulation.h"

namespace surefoot::sim {

namespace {

constexpr std::uint64_t kDepthStream = 3;
constexpr double kUnit_m = 0.001;
constexpr std::size_t kPatch_px = 4;
// Second difference of the disparity image, zero on planes, that marks a discontinuity: stereo
// matching windows straddle it. In pixels of the native image.
constexpr double kEdge_px = 1.5;

}  // namespace

SimDepthCameraPort::SimDepthCameraPort(const robot::DepthCameraSpecification& specification,
                                       const DepthNoiseConfig& noise, const FaultConfig& faults,
                                       const TerrainIndex& terrain, std::uint64_t seed)
    : specification_(specification),
      noise_(noise),
      faults_(faults),
      terrain_(terrain),
      mount_B_m_(specification.mount.position_B_m[0], specification.mount.position_B_m[1],
                 specification.mount.position_B_m[2]),
      random_(seed, kDepthStream),
      queue_(noise.latency_s) {
  const double width = specification.width_px;
  const double height = specification.height_px;
  const double half_view = std::tan(specification.horizontal_view_rad / 2);
  intrinsics_.width_px = specification.width_px;
  intrinsics_.height_px = specification.height_px;
  intrinsics_.fx_px = width / 2 / half_view;
  intrinsics_.fy_px = height / 2 / std::tan(specification.vertical_view_rad / 2);
  intrinsics_.cx_px = (width - 1) / 2;
  intrinsics_.cy_px = (height - 1) / 2;
  disparity_m_px_ = specification.native_width_px / 2 / half_view * specification.baseline_m;
  rotation_BC_ = optical_rotation(specification.mount);
  const std::size_t pixels =
      static_cast<std::size_t>(specification.width_px) * specification.height_px;
  exact_.assign(pixels, kNoHit);
  patches_wide_ = (specification.width_px + kPatch_px - 1) / kPatch_px;
  patches_.assign(patches_wide_ * ((specification.height_px + kPatch_px - 1) / kPatch_px), 0.0);
}

bool SimDepthCameraPort::due(TimeNs now) const {
  return now.seconds() * specification_.rate_Hz >= static_cast<double>(next_) - 1e-6;
}

// The pixels that the capsule may cover.
SimDepthCameraPort::Window SimDepthCameraPort::window_of(const Capsule& capsule) const {
  const CapsuleBounds bounds = bounds_of(capsule);
  const auto pixel = [](double ratio, double f, double c) {
    return std::clamp(ratio * f + c, -1e6, 1e6);
  };
  const double fx = intrinsics_.fx_px;
  const double fy = intrinsics_.fy_px;
  Window window;
  window.capsule = capsule;
  window.u0 = std::max(0, static_cast<int>(std::floor(pixel(bounds.x_low, fx, intrinsics_.cx_px))));
  window.u1 = std::min(intrinsics_.width_px - 1,
                       static_cast<int>(std::ceil(pixel(bounds.x_high, fx, intrinsics_.cx_px))));
  window.v0 = std::max(0, static_cast<int>(std::floor(pixel(bounds.y_low, fy, intrinsics_.cy_px))));
  window.v1 = std::min(intrinsics_.height_px - 1,
                       static_cast<int>(std::ceil(pixel(bounds.y_high, fy, intrinsics_.cy_px))));
  return window;
}

void SimDepthCameraPort::render_row(int v, const Vector3& p_WC_m, const Matrix3& rotation_WC) {
  const int width = intrinsics_.width_px;
  double* row = exact_.data() + static_cast<std::ptrdiff_t>(v) * width;
  const double y = (v - intrinsics_.cy_px) / intrinsics_.fy_px;
  const double limit = specification_.max_range_m;
  for (int u = 0; u < width; ++u) {
    const Vector3 direction_C((u - intrinsics_.cx_px) / intrinsics_.fx_px, y, 1.0);
    row[u] = terrain_.cast(p_WC_m, rotation_WC * direction_C, limit);
  }
  for (std::size_t k = 0; k < window_count_; ++k) {
    const Window& window = windows_[k];
    if (v < window.v0 || v > window.v1) continue;
    for (int u = window.u0; u <= window.u1; ++u) {
      const Vector3 direction_C((u - intrinsics_.cx_px) / intrinsics_.fx_px, y, 1.0);
      const double hit = cast_capsule(window.capsule, direction_C);
      if (hit < row[u]) row[u] = hit;
    }
  }
}

void SimDepthCameraPort::render(const Vector3& p_WC_m, const Matrix3& rotation_WC) {
  for (int v = 0; v < intrinsics_.height_px; ++v) render_row(v, p_WC_m, rotation_WC);
  depth_counters_.rays += exact_.size();
}

void SimDepthCameraPort::draw_patches() {
  for (double& patch : patches_) patch = random_.normal();
}

// Second difference of the native disparity along rows and columns, the larger one.
double SimDepthCameraPort::curvature_px(std::size_t u, std::size_t v) const {
  const std::size_t width = intrinsics_.width_px;
  const std::size_t height = intrinsics_.height_px;
  const std::size_t i = v * width + u;
  const double here = 2.0 / exact_[i];
  double along = 0;
  double down = 0;
  if (u > 0 && u + 1 < width) along = 1.0 / exact_[i - 1] + 1.0 / exact_[i + 1] - here;
  if (v > 0 && v + 1 < height) down = 1.0 / exact_[i - width] + 1.0 / exact_[i + width] - here;
  return disparity_m_px_ * std::max(std::fabs(along), std::fabs(down));
}

std::uint16_t SimDepthCameraPort::measure(std::size_t u, std::size_t v) {
  const double z = exact_[v * intrinsics_.width_px + u];
  if (!(z >= specification_.min_range_m && z <= specification_.max_range_m)) {
    ++depth_counters_.out_of_range;
    return 0;
  }
  const bool edge = curvature_px(u, v) > kEdge_px;
  const double chance = random_.uniform();
  if (chance < (edge ? noise_.edge_dropout : noise_.random_dropout)) {
    ++(edge ? depth_counters_.edge_dropouts : depth_counters_.random_dropouts);
    return 0;
  }
  const double patch = patches_[v / kPatch_px * patches_wide_ + u / kPatch_px];
  const double own = random_.normal();
  const double common = noise_.correlated_part;
  const double error_px = specification_.disparity_noise_px *
                          (std::sqrt(common) * patch + std::sqrt(1.0 - common) * own);
  const double measured = z + z * z / disparity_m_px_ * error_px;
  if (measured < specification_.min_range_m || measured > specification_.max_range_m) {
    ++depth_counters_.out_of_range;
    return 0;
  }
  return static_cast<std::uint16_t>(std::min(65535.0, std::floor(measured / kUnit_m + 0.5)));
}

void SimDepthCameraPort::expose(TimeNs now, const Vector3& p_WB_m, const Matrix3& rotation_WB,
                                std::span<const Capsule> robot_shapes_W) {
  next_ = static_cast<std::uint64_t>(std::floor(now.seconds() * specification_.rate_Hz + 1e-6)) + 1;
  const std::uint32_t sequence = sequence_++;
  const double t = now.seconds();
  if (t >= faults_.camera_off_from_s && t < faults_.camera_off_until_s) {
    ++depth_counters_.exposures_lost;
    return;
  }
  const Matrix3 rotation_WC = rotation_WB * rotation_BC_;
  const Vector3 p_WC_m = p_WB_m + rotation_WB * mount_B_m_;
  window_count_ = std::min(robot_shapes_W.size(), kMaxCapsules);
  for (std::size_t k = 0; k < window_count_; ++k) {
    const Capsule& shape = robot_shapes_W[k];
    windows_[k] = window_of({rotation_WC.transpose() * (shape.a_m - p_WC_m),
                             rotation_WC.transpose() * (shape.b_m - p_WC_m), shape.radius_m});
  }
  render(p_WC_m, rotation_WC);
  draw_patches();
  hal::DepthFrame& frame = queue_.push(now, sequence);
  frame.intrinsics = intrinsics_;
  frame.depth_unit_m = static_cast<float>(kUnit_m);
  for (std::size_t v = 0; v < intrinsics_.height_px; ++v) {
    for (std::size_t u = 0; u < intrinsics_.width_px; ++u) {
      frame.depth[v * intrinsics_.width_px + u] = measure(u, v);
    }
  }
}

}  // namespace surefoot::sim
