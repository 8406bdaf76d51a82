#include "core/mapping/depth_image.h"

#include <algorithm>

namespace surefoot::mapping {
namespace {

// A plane is linear in 1 / z over the image, at any inclination, and disparity noise is constant in
// 1 / z. So a pixel belongs to a surface where its 1 / z equals a neighbour's or continues the line
// of two neighbours on one side; a mixed pixel, between two surfaces, does neither.
class SurfaceTest {
 public:
  SurfaceTest(const hal::DepthFrame& frame, const MappingConfig& config,
              const DepthSensorModel& sensor)
      : frame_(frame),
        width_(frame.intrinsics.width_px),
        height_(frame.intrinsics.height_px),
        unit_(frame.depth_unit_m),
        // The line through two neighbours has the noise sqrt(1 + 4 + 1).
        gain_(static_cast<float>(2.45 * config.edge_filter_sigma)),
        inverse_sigma_(static_cast<float>(sensor.inverse_depth_sigma_per_m)),
        floor_(static_cast<float>(config.depth_noise_floor_m)) {}

  bool mixed(std::int32_t u, std::int32_t v, float z) const {
    const float tolerance = gain_ * (inverse_sigma_ + floor_ / (z * z));
    const bool horizontal =
        width_ < 3 || continues(u, v, -1, 0, z, tolerance) || continues(u, v, 1, 0, z, tolerance);
    if (!horizontal) return true;
    return !(height_ < 3 || continues(u, v, 0, -1, z, tolerance) ||
             continues(u, v, 0, 1, z, tolerance));
  }

 private:
  float depth(std::int32_t u, std::int32_t v) const {
    if (u < 0 || v < 0 || u >= width_ || v >= height_) return 0;
    return static_cast<float>(
               frame_.depth[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
                            static_cast<std::size_t>(u)]) *
           unit_;
  }
  // Both tests are the differences of 1 / z, multiplied out to spare the divisions.
  bool continues(std::int32_t u, std::int32_t v, std::int32_t du, std::int32_t dv, float z,
                 float tolerance) const {
    const float z1 = depth(u + du, v + dv);
    if (!(z1 > 0)) return false;
    if (magnitude(z - z1) <= tolerance * z * z1) return true;
    const float z2 = depth(u + 2 * du, v + 2 * dv);
    if (!(z2 > 0)) return false;
    return magnitude(z1 * z2 - 2 * z * z2 + z * z1) <= tolerance * z * z1 * z2;
  }
  static float magnitude(float x) { return x < 0 ? -x : x; }

  const hal::DepthFrame& frame_;
  std::int32_t width_;
  std::int32_t height_;
  float unit_;
  float gain_;
  float inverse_sigma_;
  float floor_;
};

void set_geometry(const hal::PinholeIntrinsics& intrinsics, std::int32_t least_stride,
                  DepthImage& out) {
  out.stride = least_stride;
  for (;; ++out.stride) {  // at most sqrt(307200 / kMaxPixels) = 4 steps
    out.width = (intrinsics.width_px + out.stride - 1) / out.stride;
    out.height = (intrinsics.height_px + out.stride - 1) / out.stride;
    if (static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height) <= kMaxPixels) {
      break;
    }
  }
  out.fx = intrinsics.fx_px / out.stride;
  out.fy = intrinsics.fy_px / out.stride;
  out.cx = intrinsics.cx_px / out.stride;
  out.cy = intrinsics.cy_px / out.stride;
  for (std::int32_t u = 0; u < out.width; ++u) {
    out.across[static_cast<std::size_t>(u)] = (u - out.cx) / out.fx;
  }
  for (std::int32_t v = 0; v < out.height; ++v) {
    out.down[static_cast<std::size_t>(v)] = (v - out.cy) / out.fy;
  }
}

void copy_pixels(const hal::DepthFrame& frame, const SurfaceTest& test, float min_range,
                 DepthImage& out) {
  const std::size_t full_width = frame.intrinsics.width_px;
  for (std::int32_t v = 0; v < out.height; ++v) {
    for (std::int32_t u = 0; u < out.width; ++u) {
      const std::int32_t full_u = u * out.stride;
      const std::int32_t full_v = v * out.stride;
      const std::uint16_t raw = frame.depth[static_cast<std::size_t>(full_v) * full_width +
                                            static_cast<std::size_t>(full_u)];
      const float z = static_cast<float>(raw) * frame.depth_unit_m;
      const bool valid = z >= min_range;
      const std::size_t i = out.at(u, v);
      out.z_m[i] = valid ? z : 0;
      out.mixed[i] = valid && test.mixed(full_u, full_v, z) ? 1 : 0;
    }
  }
}

void copy_noise(const DepthNoise& noise, std::size_t full_width, DepthImage& out) {
  for (std::int32_t v = 0; v < out.height; ++v) {
    const std::uint16_t* row =
        noise.factors.data() + static_cast<std::size_t>(v * out.stride) * full_width;
    for (std::int32_t u = 0; u < out.width; ++u) {
      out.noise[out.at(u, v)] =
          static_cast<float>(row[u * out.stride]) * (1.0F / DepthNoise::kUnit);
    }
  }
}

// 0 is both "no measurement" and the least number, so one minimum serves both.
void find_nearest(DepthImage& out) {
  out.farthest_m = 0;
  for (std::int32_t v = 0; v < out.height; ++v) {
    for (std::int32_t u = 0; u < out.width; ++u) {
      const std::size_t i = out.at(u, v);
      const bool inside = u > 0 && v > 0 && u + 1 < out.width && v + 1 < out.height;
      if (!inside) {
        out.nearest_m[i] = 0;
        continue;
      }
      float least = out.z_m[i];
      for (std::int32_t dv = -1; dv <= 1; ++dv) {
        const std::size_t row = out.at(u, v + dv);
        least = std::min({least, out.z_m[row - 1], out.z_m[row], out.z_m[row + 1]});
      }
      out.nearest_m[i] = least;
      out.farthest_m = std::max(out.farthest_m, least);
    }
  }
}

}  // namespace

void prepare(const hal::DepthFrame& frame, const MappingConfig& config,
             const DepthSensorModel& sensor, DepthImage& out, const DepthNoise* noise) {
  set_geometry(frame.intrinsics, config.pixel_stride, out);
  const SurfaceTest test(frame, config, sensor);
  copy_pixels(frame, test, static_cast<float>(sensor.min_range_m), out);
  out.has_noise = noise != nullptr;
  if (out.has_noise) copy_noise(*noise, frame.intrinsics.width_px, out);
  find_nearest(out);
}

}  // namespace surefoot::mapping
