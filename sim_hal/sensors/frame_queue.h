// The frames of a simulated camera between exposure and receive(): how long they take, what gives
// way when nobody fetches them, and the counters of both.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/base/status.h"
#include "core/base/time.h"
#include "hal/api/sensor_counters.h"

namespace surefoot::sim {

// Frame: a picture of hal/api, with stamp, sequence and assign().
template <class Frame, std::size_t kCapacity>
class FrameQueue {
 public:
  explicit FrameQueue(double latency_s)
      : latency_{static_cast<std::int64_t>(std::llround(latency_s * 1e9))},
        frames_(std::make_unique<std::array<Frame, kCapacity>>()) {}

  // Room for the newest frame, stamp and sequence set; the oldest gives way.
  Frame& push(TimeNs stamp, std::uint32_t sequence) {
    if (waiting_ == kCapacity) {
      first_ = (first_ + 1) % kCapacity;
      --waiting_;
      ++counters_.dropped;
    }
    // Gaps are what never came here; what a full queue loses is counted as dropped, once.
    if (arrived_) counters_.gaps += sequence - expected_;
    arrived_ = true;
    expected_ = sequence + 1;
    Frame& frame = (*frames_)[(first_ + waiting_) % kCapacity];
    ++waiting_;
    frame.stamp = stamp;
    frame.sequence = sequence;
    return frame;
  }

  // Makes frames visible to receive() whose latency has passed.
  void advance(TimeNs now) { now_ = now; }

  // kUnavailable: none is visible, out unchanged.
  Status receive(Frame& out) {
    if (waiting_ == 0) return Status::kUnavailable;
    const Frame& frame = (*frames_)[first_];
    if (frame.stamp + latency_ > now_) return Status::kUnavailable;
    out.assign(frame);
    first_ = (first_ + 1) % kCapacity;
    --waiting_;
    ++counters_.delivered;
    return Status::kOk;
  }

  const hal::SensorCounters& counters() const { return counters_; }

 private:
  TimeNs now_;
  TimeNs latency_;
  std::unique_ptr<std::array<Frame, kCapacity>> frames_;  // ring
  std::size_t first_ = 0;
  std::size_t waiting_ = 0;
  std::uint32_t expected_ = 0;  // sequence number that follows the last arrival
  bool arrived_ = false;
  hal::SensorCounters counters_;
};

}  // namespace surefoot::sim
