// Depth camera: images of z-distance, as the device delivers them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/status.h"
#include "core/base/time.h"
#include "hal/api/sensor_counters.h"

namespace surefoot::hal {

inline constexpr std::size_t kMaxDepthWidth_px = 640;
inline constexpr std::size_t kMaxDepthHeight_px = 480;

// Pinhole model of a rectified image; u to the right, v down; the centre of the first pixel is (0,
// 0).
struct PinholeIntrinsics {
  std::uint16_t width_px = 0;
  std::uint16_t height_px = 0;
  double fx_px = 0;
  double fy_px = 0;
  double cx_px = 0;
  double cy_px = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("width_px", self.width_px);
    visit("height_px", self.height_px);
    visit("fx_px", self.fx_px);
    visit("fy_px", self.fy_px);
    visit("cx_px", self.cx_px);
    visit("cy_px", self.cy_px);
  }
};

// Optical frame C: x right, y down, z forward. depth[v * width_px + u] * depth_unit_m is the z
// coordinate of the surface; 0 means no measurement.
struct DepthFrame {
  TimeNs stamp;  // middle of the exposure
  std::uint32_t sequence = 0;
  PinholeIntrinsics intrinsics;
  float depth_unit_m = 0.001F;
  std::array<std::uint16_t, kMaxDepthWidth_px * kMaxDepthHeight_px> depth{};

  std::size_t pixel_count() const {
    return static_cast<std::size_t>(intrinsics.width_px) * intrinsics.height_px;
  }

  // Copies the pixels in use; the rest keeps what it held. At most depth.size() are.
  void assign(const DepthFrame& frame) {
    stamp = frame.stamp;
    sequence = frame.sequence;
    intrinsics = frame.intrinsics;
    depth_unit_m = frame.depth_unit_m;
    std::copy_n(frame.depth.begin(), frame.pixel_count(), depth.begin());
  }

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("stamp_ns", self.stamp);
    visit("sequence", self.sequence);
    visit("intrinsics", self.intrinsics);
    visit("depth_unit_m", self.depth_unit_m);
    std::size_t count = self.pixel_count();
    if (count > self.depth.size()) count = 0;  // damaged header: the caller checks pixel_count()
    for (std::size_t i = 0; i < count; ++i) visit("depth", self.depth[i]);
  }
};

class DepthCameraPort {
 public:
  // Copies the oldest waiting frame into out. kUnavailable: none waiting or no device, out
  // unchanged. Cost: one copy of the image. Never blocks.
  Status receive(DepthFrame& out) { return do_receive(out); }
  SensorCounters counters() const { return do_counters(); }

 protected:
  ~DepthCameraPort() = default;

 private:
  virtual Status do_receive(DepthFrame& out) = 0;
  virtual SensorCounters do_counters() const = 0;
};

}  // namespace surefoot::hal
