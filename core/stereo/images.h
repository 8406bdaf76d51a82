// Pictures and disparities in fixed memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hal/api/stereo_camera_port.h"

namespace surefoot::stereo {

inline constexpr std::size_t kMaxWidth_px = hal::kMaxStereoWidth_px;
inline constexpr std::size_t kMaxHeight_px = hal::kMaxStereoHeight_px;
inline constexpr std::size_t kMaxPixels = kMaxWidth_px * kMaxHeight_px;

// Somebody else's grey picture, row-major without gaps.
struct GreyView {
  const std::uint8_t* pixels = nullptr;
  std::uint16_t width_px = 0;
  std::uint16_t height_px = 0;

  const std::uint8_t* row(std::size_t v) const { return pixels + v * width_px; }
  std::size_t pixel_count() const { return static_cast<std::size_t>(width_px) * height_px; }
};

// A grey picture of our own.
struct GreyImage {
  std::uint16_t width_px = 0;
  std::uint16_t height_px = 0;
  std::array<std::uint8_t, kMaxPixels> pixels{};  // row-major without gaps

  GreyView view() const { return {pixels.data(), width_px, height_px}; }
};

// Disparities are stored in 1/64 px.
inline constexpr std::int32_t kSubpixels = 64;
inline constexpr std::int16_t kNoDisparity = std::numeric_limits<std::int16_t>::min();

// Of the left picture: the point at (u, v) is at (u - disparity, v) in the right one.
struct DisparityImage {
  std::uint16_t width_px = 0;
  std::uint16_t height_px = 0;
  std::array<std::int16_t, kMaxPixels> values{};  // row-major, kNoDisparity where there is none
  // Grey levels that the 7 x 7 pixels around span, for every pixel.
  std::array<std::uint8_t, kMaxPixels> contrasts{};

  std::int16_t* row(std::size_t v) { return values.data() + v * width_px; }
  const std::int16_t* row(std::size_t v) const { return values.data() + v * width_px; }
  std::size_t pixel_count() const { return static_cast<std::size_t>(width_px) * height_px; }
};

}  // namespace surefoot::stereo
