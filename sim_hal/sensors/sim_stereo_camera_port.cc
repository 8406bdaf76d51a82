#include "sim_hal/sensors/sim_stereo_camera_port.h"

#include <algorithm>
#include <cmath>

#include "sim_hal/robot/articulation.h"

namespace surefoot::sim {

namespace {

constexpr std::uint64_t kStereoStream = 7;
constexpr double kBrightness = 255.0;
constexpr double kAlbedo = 0.45;       // of the ground, mean
constexpr double kPatternShare = 0.5;  // of the brightness, per unit of the pattern
constexpr double kSky = 0.8;
constexpr double kAmbient = 0.45;  // share of the light that comes from everywhere
constexpr double kFarthest_m = 10.0;

// Where a lens puts the direction (x, y, 1), in focal lengths (OpenCV's model).
Vector2 distorted(const std::array<double, 8>& k, const Vector2& at) {
  const double r2 = at.squaredNorm();
  const double radial =
      (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
  const double xy = at.x() * at.y();
  return {at.x() * radial + 2 * k[2] * xy + k[3] * (r2 + 2 * at.x() * at.x()),
          at.y() * radial + k[2] * (r2 + 2 * at.y() * at.y()) + 2 * k[3] * xy};
}

// The direction that the lens puts there: Newton's method with differences.
Vector2 undistorted(const std::array<double, 8>& k, const Vector2& seen) {
  constexpr double kStep = 1e-6;
  Vector2 at = seen;
  for (int i = 0; i < 20; ++i) {
    const Vector2 error = distorted(k, at) - seen;
    if (error.squaredNorm() < 1e-24) break;
    const Vector2 by_x = (distorted(k, at + Vector2(kStep, 0)) - seen - error) / kStep;
    const Vector2 by_y = (distorted(k, at + Vector2(0, kStep)) - seen - error) / kStep;
    const double determinant = by_x.x() * by_y.y() - by_x.y() * by_y.x();
    if (std::fabs(determinant) < 1e-9) break;
    at.x() -= (by_y.y() * error.x() - by_y.x() * error.y()) / determinant;
    at.y() -= (by_x.x() * error.y() - by_x.y() * error.x()) / determinant;
  }
  return at;
}

Matrix3 matrix_of(const std::array<double, 9>& rows) {
  Matrix3 matrix;
  matrix << rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6], rows[7], rows[8];
  return matrix;
}

}  // namespace

SimStereoCameraPort::SimStereoCameraPort(const robot::StereoCameraSpecification& specification,
                                         const StereoImageConfig& config, const FaultConfig& faults,
                                         const TerrainIndex& terrain, std::uint64_t seed)
    : specification_(specification),
      config_(config),
      faults_(faults),
      terrain_(terrain),
      pattern_(seed),
      random_(seed, kStereoStream),
      queue_(config.latency_s) {
  const robot::StereoCameraCalibration& calibration = specification.calibration;
  const auto& position = specification.mount.position_B_m;
  left_.rotation_BC = optical_rotation(specification.mount);
  left_.p_BC_m = Vector3(position[0], position[1], position[2]);
  const Matrix3 R_VE = matrix_of(calibration.R_EV).transpose();
  const Vector3 p_EV_m(calibration.p_EV_m[0], calibration.p_EV_m[1], calibration.p_EV_m[2]);
  right_.rotation_BC = left_.rotation_BC * R_VE;
  right_.p_BC_m = left_.p_BC_m - right_.rotation_BC * p_EV_m;
  set_up(calibration.left, left_);
  set_up(calibration.right, right_);
  points_W_m_.resize(left_.directions_C.size());
  hit_.resize(left_.directions_C.size());
}

void SimStereoCameraPort::set_up(const robot::StereoLens& lens, Eye& eye) const {
  const auto& m = lens.matrix;
  for (int v = 0; v < specification_.calibration.height_px; ++v) {
    for (int u = 0; u < specification_.calibration.width_px; ++u) {
      const Vector2 at = undistorted(lens.distortion, {(u - m[2]) / m[0], (v - m[5]) / m[4]});
      eye.directions_C.emplace_back(at.x(), at.y(), 1.0);
    }
  }
}

Status SimStereoCameraPort::do_trigger() {
  triggered_ = true;
  return Status::kOk;
}

// What each pixel sees: the ground or a link, whichever is nearer.
void SimStereoCameraPort::cast(const Eye& eye, const Vector3& p_WC_m, const Matrix3& rotation_WC,
                               std::span<const Capsule> shapes_W) {
  std::array<Capsule, kMaxCapsules> capsules_C;
  std::array<CapsuleBounds, kMaxCapsules> bounds;
  const std::size_t count = std::min(shapes_W.size(), kMaxCapsules);
  for (std::size_t k = 0; k < count; ++k) {
    const Capsule& shape = shapes_W[k];
    capsules_C[k] = {rotation_WC.transpose() * (shape.a_m - p_WC_m),
                     rotation_WC.transpose() * (shape.b_m - p_WC_m), shape.radius_m};
    bounds[k] = bounds_of(capsules_C[k]);
  }
  for (std::size_t i = 0; i < eye.directions_C.size(); ++i) {
    const Vector3& direction_C = eye.directions_C[i];
    const Vector3 direction_W = rotation_WC * direction_C;
    double t = terrain_.cast(p_WC_m, direction_W, kFarthest_m);
    for (std::size_t k = 0; k < count; ++k) {
      if (!bounds[k].contains(direction_C.x(), direction_C.y())) continue;
      t = std::min(t, cast_capsule(capsules_C[k], direction_C));
    }
    hit_[i] = t < kFarthest_m;
    if (hit_[i]) points_W_m_[i] = p_WC_m + t * direction_W;
  }
  image_counters_.rays += eye.directions_C.size();
}

// To the neighbour on the side that is nearer: on the same surface, where there is one.
Vector3 SimStereoCameraPort::nearer_step(std::size_t pixel, std::size_t stride, bool first,
                                         bool last) const {
  const bool before = !first && hit_[pixel - stride];
  const bool behind = !last && hit_[pixel + stride];
  const Vector3 back =
      before ? Vector3(points_W_m_[pixel] - points_W_m_[pixel - stride]) : Vector3::Zero();
  const Vector3 on =
      behind ? Vector3(points_W_m_[pixel + stride] - points_W_m_[pixel]) : Vector3::Zero();
  if (!before) return on;
  return behind && on.squaredNorm() < back.squaredNorm() ? on : back;
}

// Brightness from 0 to 1: the pattern's, in the light of a high sun.
double SimStereoCameraPort::grey_at(std::size_t u, std::size_t v, const Vector3& p_WC_m) const {
  const std::size_t width = specification_.calibration.width_px;
  const std::size_t height = specification_.calibration.height_px;
  const std::size_t i = v * width + u;
  if (!hit_[i]) return kSky;
  const Vector3 along = nearer_step(i, 1, u == 0, u + 1 == width);
  const Vector3 down = nearer_step(i, width, v == 0, v + 1 == height);
  const double footprint_m = std::sqrt(std::max(along.squaredNorm(), down.squaredNorm()));
  Vector3 normal = along.cross(down);
  if (normal.dot(points_W_m_[i] - p_WC_m) > 0) normal = -normal;
  const Vector3 sun = Vector3(0.35, 0.25, 0.9).normalized();
  const double lit = std::max(0.0, normal.dot(sun)) / std::max(normal.norm(), 1e-12);
  const double albedo = kAlbedo + kPatternShare * config_.texture *
                                      pattern_.at(points_W_m_[i], std::max(footprint_m, 1e-5));
  return std::max(0.0, albedo) * (kAmbient + (1.0 - kAmbient) * lit);
}

void SimStereoCameraPort::render(const Eye& eye, const Vector3& p_WB_m, const Matrix3& rotation_WB,
                                 std::span<const Capsule> shapes_W, double gain, double offset,
                                 std::uint8_t* out) {
  const Vector3 p_WC_m = p_WB_m + rotation_WB * eye.p_BC_m;
  cast(eye, p_WC_m, rotation_WB * eye.rotation_BC, shapes_W);
  for (std::size_t v = 0; v < specification_.calibration.height_px; ++v) {
    for (std::size_t u = 0; u < specification_.calibration.width_px; ++u) {
      const double grey = kBrightness * gain * grey_at(u, v, p_WC_m) + offset +
                          config_.grey_noise * random_.normal();
      *out++ = static_cast<std::uint8_t>(std::clamp(grey + 0.5, 0.0, 255.0));
    }
  }
}

void SimStereoCameraPort::expose(TimeNs now, const Vector3& p_WB_m, const Matrix3& rotation_WB,
                                 std::span<const Capsule> robot_shapes_W) {
  triggered_ = false;
  const std::uint32_t sequence = sequence_++;
  const double t = now.seconds();
  const bool off = t >= faults_.camera_off_from_s && t < faults_.camera_off_until_s;
  if (off || random_.uniform() < config_.dropout) {
    ++image_counters_.exposures_lost;
    return;
  }
  ++image_counters_.exposures;
  hal::StereoFrame& frame = queue_.push(now, sequence);
  frame.width_px = specification_.calibration.width_px;
  frame.height_px = specification_.calibration.height_px;
  render(left_, p_WB_m, rotation_WB, robot_shapes_W, 1.0, 0.0, frame.left.data());
  render(right_, p_WB_m, rotation_WB, robot_shapes_W, config_.right_gain, config_.right_offset,
         frame.right.data());
}

}  // namespace surefoot::sim
