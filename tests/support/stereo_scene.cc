#include "tests/support/stereo_scene.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/math/elementary.h"
#include "core/math/linear.h"

namespace surefoot::tests {

namespace {

struct Stone {
  Vector3 centre_m;
  double radius_m;
};

// A grey level between 0 and 1 at each corner of a lattice.
double lattice(std::int64_t x, std::int64_t y, std::int64_t z) {
  std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15u;
  h ^= static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4Fu + (h >> 29u);
  h ^= static_cast<std::uint64_t>(z) * 0x165667B19E3779F9u + (h >> 32u);
  h *= 0xBF58476D1CE4E5B9u;
  return static_cast<double>((h >> 40u) & 0xFFFFu) / 65535.0;
}

double ease(double t) { return t * t * (3.0 - 2.0 * t); }

double value_noise(const Vector3& p) {
  const double fx = std::floor(p.x());
  const double fy = std::floor(p.y());
  const double fz = std::floor(p.z());
  const double wx = ease(p.x() - fx);
  const double wy = ease(p.y() - fy);
  const double wz = ease(p.z() - fz);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int i = corner & 1;
    const int j = corner >> 1 & 1;
    const int k = corner >> 2;
    sum += lattice(static_cast<std::int64_t>(fx) + i, static_cast<std::int64_t>(fy) + j,
                   static_cast<std::int64_t>(fz) + k) *
           (i != 0 ? wx : 1 - wx) * (j != 0 ? wy : 1 - wy) * (k != 0 ? wz : 1 - wz);
  }
  return sum;
}

double pattern(const Vector3& p_m) {
  double sum = 0;
  double weights = 0;
  double weight = 1;
  double frequency_1_m = 8;
  for (int octave = 0; octave < 6; ++octave) {
    sum += weight * value_noise(p_m * frequency_1_m);
    weights += weight;
    weight *= 0.75;
    frequency_1_m *= 2.1;
  }
  return sum / weights;
}

// z along the optical axis of the nearest surface in `direction`, whose axial part is 1.
double cast(const std::vector<Stone>& stones, const Vector3& origin, const Vector3& direction) {
  double nearest = direction.z() < -1e-6 ? -origin.z() / direction.z() : 20.0;
  const double a = direction.squaredNorm();
  for (const Stone& stone : stones) {
    const Vector3 offset = origin - stone.centre_m;
    const double b = offset.dot(direction);
    const double c = offset.squaredNorm() - stone.radius_m * stone.radius_m;
    const double root = b * b - a * c;
    if (root <= 0) continue;
    const double t = (-b - math::sqrt(root)) / a;
    if (t > 0 && t < nearest) nearest = t;
  }
  return std::min(nearest, 20.0);
}

std::vector<Stone> scatter(int count, Random& random) {
  std::vector<Stone> stones;
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform(-0.6, 0.6);
    const double y = random.uniform(0.3, 1.2);
    stones.push_back({Vector3(x, y, 0), random.uniform(0.02, 0.10)});
  }
  return stones;
}

}  // namespace

StereoScene render_stereo_scene(const StereoSceneOptions& options) {
  Random random(options.seed, 77);
  const std::vector<Stone> stones = scatter(options.stones, random);
  StereoScene scene{
      options.width_px, options.height_px, options.focal_px, options.baseline_m, {}, {}, {}};
  const math::SinCos tilt = math::sin_cos(options.pitch_rad);
  const double cx = 0.5 * (options.width_px - 1);
  const double cy = 0.5 * (options.height_px - 1);
  for (int camera = 0; camera < 2; ++camera) {
    const Vector3 origin(camera * options.baseline_m, 0, options.camera_height_m);
    const double gain = camera == 0 ? 1.0 : options.right_gain;
    for (int v = 0; v < options.height_px; ++v) {
      for (int u = 0; u < options.width_px; ++u) {
        const auto direction = [&](double du, double dv) {
          const double x = (u + du - cx) / options.focal_px;
          const double y = (v + dv - cy) / options.focal_px;
          return Vector3(x, tilt.cos - y * tilt.sin, -tilt.sin - y * tilt.cos);
        };
        double sum = 0;
        for (int ray = 0; ray < 4; ++ray) {
          const Vector3 way = direction(ray % 2 * 0.5 - 0.25, ray / 2 * 0.5 - 0.25);
          sum += pattern(origin + cast(stones, origin, way) * way);
        }
        const double grey = 120 + 2 * options.contrast * (sum / 4 - 0.5);
        const double noise = options.grey_noise * random.normal();
        const double seen = std::clamp(std::floor(grey * gain + noise + 0.5), 0.0, 255.0);
        (camera == 0 ? scene.left : scene.right).push_back(static_cast<std::uint8_t>(seen));
        if (camera == 0) {
          const double z = cast(stones, origin, direction(0, 0));
          scene.disparity_px.push_back(
              static_cast<float>(options.focal_px * options.baseline_m / z));
        }
      }
    }
  }
  return scene;
}

DisparityQuality judge_disparities(const std::int16_t* values, double scale,
                                   const std::vector<float>& truth_px, std::size_t width_px,
                                   std::size_t first_column) {
  double judged = 0;
  double valid = 0;
  double wrong = 0;
  double close = 0;
  double squares = 0;
  for (std::size_t i = 0; i < truth_px.size(); ++i) {
    if (i % width_px < first_column || !(truth_px[i] > 0)) continue;
    ++judged;
    if (values[i] < 0) continue;
    ++valid;
    const double error = std::fabs(values[i] / scale - static_cast<double>(truth_px[i]));
    if (error > 2) ++wrong;
    if (error < 1) {
      ++close;
      squares += error * error;
    }
  }
  return {valid / std::max(judged, 1.0), wrong / std::max(valid, 1.0),
          std::sqrt(squares / std::max(close, 1.0))};
}

}  // namespace surefoot::tests
