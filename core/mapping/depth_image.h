// A depth frame made ready: thinned to the pixel bound, in metres, with two answers per pixel that
// need its neighbours: is it a mixed pixel, and how near is the nearest surface around it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/mapping/mapping_config.h"
#include "core/math/lanes.h"
#include "hal/api/depth_camera_port.h"

namespace surefoot::mapping {

// Pixels used per frame; larger images are thinned by the smallest whole stride that fits.
inline constexpr std::size_t kMaxPixels = 20480;

// How much more than its sensor's noise each pixel of a frame has: where the sensor itself can
// tell. Laid out as the frame's pixels, in 1 / kUnit of the sensor's sigma of 1 / z.
struct DepthNoise {
  static constexpr std::int32_t kUnit = 64;
  std::array<std::uint16_t, hal::kMaxDepthWidth_px * hal::kMaxDepthHeight_px> factors{};
};

struct DepthImage {
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::int32_t stride = 1;  // pixels of the frame per pixel here
  double fx = 0;            // of the thinned image, [pixels]
  double fy = 0;
  double cx = 0;
  double cy = 0;
  // Rays of one unit of depth: x in C of each column, y of each row.
  std::array<double, hal::kMaxDepthWidth_px + kDoubleLanes> across{};
  std::array<double, hal::kMaxDepthHeight_px> down{};
  float farthest_m = 0;                                // largest of nearest_m
  std::array<float, kMaxPixels + kDoubleLanes> z_m{};  // 0: no measurement
  std::array<float, kMaxPixels> nearest_m{};     // least z of the 3 x 3; 0: not all nine measured
  std::array<std::uint8_t, kMaxPixels> mixed{};  // 1: between two surfaces or alone
  bool has_noise = false;
  // Of the pixel's own sigma of 1 / z in the sensor's; meaningful where has_noise.
  std::array<float, kMaxPixels + kDoubleLanes> noise{};

  std::size_t at(std::int32_t u, std::int32_t v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(u);
  }
};

// The header of `frame` must have been checked. noise: null where all pixels have the sensor's.
// Cost: a few operations per pixel.
void prepare(const hal::DepthFrame& frame, const MappingConfig& config,
             const DepthSensorModel& sensor, DepthImage& out, const DepthNoise* noise = nullptr);

}  // namespace surefoot::mapping
