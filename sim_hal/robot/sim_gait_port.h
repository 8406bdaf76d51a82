// The port of the plant without legs: the newest command in, leg odometry out.
#pragma once

#include "core/base/ring_buffer.h"
#include "core/base/time.h"
#include "hal/api/gait_port.h"

namespace surefoot::sim {

class SimGaitPort final : public hal::GaitPort {
 public:
  static constexpr std::size_t kQueue = 32;

  // What holds at `now`: a stand when the last one is too old.
  hal::GaitCommand command(TimeNs now) const {
    const bool fresh = commanded_ && now - commanded_at_ <= hal::kGaitCommandTimeout;
    return fresh ? command_ : hal::GaitCommand{};
  }
  void advance(TimeNs now) { now_ = now; }
  // Numbers the sample and queues it; the oldest gives way.
  void push(hal::GaitSample sample) {
    sample.sequence = sequence_++;
    if (queue_.push_overwrite(sample)) ++counters_.dropped;
  }

 private:
  Status do_send(const hal::GaitCommand& command) override {
    command_ = command;
    commanded_ = true;
    commanded_at_ = now_;
    return Status::kOk;
  }
  Status do_receive(hal::GaitSample& out) override {
    if (queue_.empty()) return Status::kUnavailable;
    out = queue_.front();
    queue_.pop_front();
    ++counters_.delivered;
    return Status::kOk;
  }
  hal::SensorCounters do_counters() const override { return counters_; }

  hal::GaitCommand command_;
  bool commanded_ = false;
  TimeNs commanded_at_;
  TimeNs now_;
  std::uint32_t sequence_ = 0;
  RingBuffer<hal::GaitSample, kQueue> queue_;
  hal::SensorCounters counters_;
};

}  // namespace surefoot::sim
