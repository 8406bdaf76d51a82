// Stereo pair: two grey images exposed together, as the devices deliver them (not rectified).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/status.h"
#include "core/base/time.h"
#include "hal/api/sensor_counters.h"

namespace surefoot::hal {

inline constexpr std::size_t kMaxStereoWidth_px = 1024;
inline constexpr std::size_t kMaxStereoHeight_px = 768;

struct StereoFrame {
  TimeNs stamp;  // middle of the exposure
  std::uint32_t sequence = 0;
  std::uint16_t width_px = 0;
  std::uint16_t height_px = 0;
  std::array<std::uint8_t, kMaxStereoWidth_px * kMaxStereoHeight_px> left{};  // row-major grey
  std::array<std::uint8_t, kMaxStereoWidth_px * kMaxStereoHeight_px> right{};

  std::size_t pixel_count() const { return static_cast<std::size_t>(width_px) * height_px; }

  // Copies the pixels in use; the rest keeps what it held. At most left.size() are.
  void assign(const StereoFrame& frame) {
    stamp = frame.stamp;
    sequence = frame.sequence;
    width_px = frame.width_px;
    height_px = frame.height_px;
    std::copy_n(frame.left.begin(), frame.pixel_count(), left.begin());
    std::copy_n(frame.right.begin(), frame.pixel_count(), right.begin());
  }

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("stamp_ns", self.stamp);
    visit("sequence", self.sequence);
    visit("width_px", self.width_px);
    visit("height_px", self.height_px);
    std::size_t count = self.pixel_count();
    if (count > self.left.size()) count = 0;  // damaged header: the caller checks pixel_count()
    for (std::size_t i = 0; i < count; ++i) visit("left", self.left[i]);
    for (std::size_t i = 0; i < count; ++i) visit("right", self.right[i]);
  }
};

class StereoCameraPort {
 public:
  // Asks for one exposure as soon as possible. kUnavailable: no device.
  Status trigger() { return do_trigger(); }
  // Copies the oldest waiting pair into out. kUnavailable: none, out unchanged. Never blocks.
  Status receive(StereoFrame& out) { return do_receive(out); }
  SensorCounters counters() const { return do_counters(); }

 protected:
  ~StereoCameraPort() = default;

 private:
  virtual Status do_trigger() = 0;
  virtual Status do_receive(StereoFrame& out) = 0;
  virtual SensorCounters do_counters() const = 0;
};

}  // namespace surefoot::hal
