// Devices of a made-up robot, scripted by a test. Shared by the runtime, replay and memory tests.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/autonomy/tick.h"
#include "hal/api/board.h"

namespace surefoot::testing {

// Logical time that jumps to each deadline; chosen ticks are late; ends after `ticks`.
class FakeClock final : public hal::Clock {
 public:
  std::uint64_t ticks = UINT64_MAX;
  std::vector<std::uint64_t> late_ticks;
  TimeNs time;
  TimeNs last_deadline;

 private:
  TimeNs do_now() const override { return time; }
  Status do_wait_until(TimeNs deadline) override {
    if (granted_ == ticks) return Status::kEndOfData;
    last_deadline = deadline;
    time = deadline;
    const std::uint64_t tick = granted_++;
    const bool late = std::find(late_ticks.begin(), late_ticks.end(), tick) != late_ticks.end();
    return late ? Status::kTimeout : Status::kOk;
  }
  std::uint64_t granted_ = 0;
};

// A stopwatch that moves only when told.
class ManualStopwatch final : public hal::Clock {
 public:
  TimeNs time;

 private:
  TimeNs do_now() const override { return time; }
  Status do_wait_until(TimeNs) override { return Status::kUnavailable; }
};

// A queue behind a port; what is pushed is delivered oldest first.
template <class Port, class Item>
class FakeQueue : public Port {
 public:
  void push(const Item& item) { queue_.push_back(item); }
  std::size_t waiting() const { return queue_.size(); }

 protected:
  ~FakeQueue() = default;
  std::size_t take(std::span<Item> out) {
    const std::size_t count = std::min(out.size(), queue_.size());
    std::copy_n(queue_.begin(), count, out.begin());
    queue_.erase(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }

 private:
  std::vector<Item> queue_;
};

class FakeCan final : public FakeQueue<hal::CanPort, hal::CanFrame> {
 public:
  std::vector<hal::CanFrame> sent;
  std::size_t refuse_from = SIZE_MAX;  // sends beyond this many are refused
  bool keep_sent = true;

 private:
  std::size_t do_receive(std::span<hal::CanFrame> out) override { return take(out); }
  Status do_send(const hal::CanFrame& frame) override {
    if (sent.size() >= refuse_from) return Status::kExhausted;
    if (keep_sent) sent.push_back(frame);
    return Status::kOk;
  }
  hal::CanCounters do_counters() const override { return {}; }
};

class FakeImu final : public FakeQueue<hal::ImuPort, hal::ImuSample> {
 private:
  std::size_t do_receive(std::span<hal::ImuSample> out) override { return take(out); }
  hal::SensorCounters do_counters() const override { return {}; }
};

class FakePose final : public FakeQueue<hal::PosePort, hal::PoseSample> {
 private:
  std::size_t do_receive(std::span<hal::PoseSample> out) override { return take(out); }
  hal::SensorCounters do_counters() const override { return {}; }
};

class FakeOperator final : public hal::OperatorPort {
 public:
  bool fresh = false;
  hal::OperatorCommand command;

 private:
  Status do_receive(hal::OperatorCommand& out) override {
    if (!fresh) return Status::kUnavailable;
    fresh = false;
    out = command;
    return Status::kOk;
  }
  hal::SensorCounters do_counters() const override { return {}; }
};

class FakeDepth final : public hal::DepthCameraPort {
 public:
  std::size_t waiting = 0;
  hal::DepthFrame frame;

 private:
  Status do_receive(hal::DepthFrame& out) override {
    if (waiting == 0) return Status::kUnavailable;
    --waiting;
    out = frame;
    return Status::kOk;
  }
  hal::SensorCounters do_counters() const override { return {}; }
};

class FakeStereo final : public hal::StereoCameraPort {
 public:
  std::size_t waiting = 0;
  std::size_t triggers = 0;
  bool refuse = false;
  hal::StereoFrame frame;

 private:
  Status do_trigger() override {
    ++triggers;
    return refuse ? Status::kUnavailable : Status::kOk;
  }
  Status do_receive(hal::StereoFrame& out) override {
    if (waiting == 0) return Status::kUnavailable;
    --waiting;
    out = frame;
    return Status::kOk;
  }
  hal::SensorCounters do_counters() const override { return {}; }
};

class FakeLidar final : public hal::LidarPort {
 public:
  std::size_t waiting = 0;
  hal::LidarScan scan;

 private:
  Status do_receive(hal::LidarScan& out) override {
    if (waiting == 0) return Status::kUnavailable;
    --waiting;
    out = scan;
    return Status::kOk;
  }
  hal::SensorCounters do_counters() const override { return {}; }
};

class FakeGait final : public FakeQueue<hal::GaitPort, hal::GaitSample> {
 public:
  std::vector<hal::GaitCommand> sent;
  bool keep_sent = true;
  bool refuse = false;

 private:
  Status do_send(const hal::GaitCommand& command) override {
    if (keep_sent) sent.push_back(command);
    return refuse ? Status::kUnavailable : Status::kOk;
  }
  Status do_receive(hal::GaitSample& out) override {
    return take(std::span(&out, 1)) == 1 ? Status::kOk : Status::kUnavailable;
  }
  hal::SensorCounters do_counters() const override { return {}; }
};

// Keeps every message in memory.
class FakeRecord final : public hal::RecordSink {
 public:
  struct Message {
    hal::RecordChannel channel;
    TimeNs stamp;
    std::vector<std::uint8_t> bytes;
  };
  std::vector<Message> messages;
  bool refuse = false;
  hal::RecordSink* forward = nullptr;  // where messages go instead, if anywhere

 private:
  Status do_write(hal::RecordChannel channel, TimeNs stamp,
                  std::span<const std::uint8_t> bytes) override {
    if (refuse) return Status::kExhausted;
    if (forward != nullptr) return forward->write(channel, stamp, bytes);
    messages.push_back({channel, stamp, {bytes.begin(), bytes.end()}});
    return Status::kOk;
  }
  hal::RecordCounters do_counters() const override { return {}; }
};

struct FakeBoard {
  FakeClock clock;
  ManualStopwatch stopwatch;
  FakeCan can;
  FakeImu imu;
  FakePose pose;
  FakeOperator operator_port;
  FakeDepth depth;
  FakeStereo stereo;
  FakeLidar lidar;
  FakeGait gait;
  FakeRecord record;

  hal::Board board() {
    hal::Board board;
    board.clock = &clock;
    board.stopwatch = &stopwatch;
    board.can = &can;
    board.imu = &imu;
    board.pose = &pose;
    board.operator_port = &operator_port;
    board.depth_camera = &depth;
    board.stereo_camera = &stereo;
    board.lidar = &lidar;
    board.gait = &gait;
    board.record = &record;
    return board;
  }
};

}  // namespace surefoot::testing
