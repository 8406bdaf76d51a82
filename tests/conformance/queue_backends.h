// Small backends over queues: how a backend for a new device is written, and, with a defect
// switched on, proof that the suites see one. A real backend differs in where push() is called
// from: a receiver thread or an interrupt, through a lock-free ring.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <span>
#include <utility>
#include <vector>

#include "hal/api/board.h"

namespace surefoot::conformance {

enum class Defect : std::uint8_t {
  kNone,
  kWritesWhenEmpty,  // touches the output without a sample
  kIgnoresRoom,      // takes a sample off the queue though there is no room for it
  kNewestFirst,
  kNotCounted,     // delivers without counting
  kLosesSilently,  // a full queue is not counted
  kDeliversTwice,
  kBadForm,  // hands out what is out of its domain
  kGapsUnseen,
  kDropsAreGaps,     // what the full queue dropped is counted as lost before the host too
  kDropsNewest,      // operator: keeps the oldest command
  kAcceptsAnything,  // CAN: sends frames that are none
  kNoBusCheck,       // CAN: sends to buses that are not there
  kRefusesSilently,  // CAN: a full transmit queue is not counted
  kDirtyPadding,     // CAN: bytes beyond the size are left over from before
  kSwapsBuses,       // CAN: equal stamps in the wrong order
  kIgnoresTrigger,   // stereo
  kReturnsEarly,     // clock
  kIgnoresLate,      // clock
  kGoesBack,         // clock
  kComesBackToLife,  // clock: goes on after its end
  kKeepsReference,   // record: does not copy
  kForgets,          // record: loses a message
  kAllocates,        // record
};

// The queue behind every sensor port: bounded, the oldest gives way, nothing is lost silently.
template <class Sample>
class SampleQueue {
 public:
  explicit SampleQueue(Defect defect) : defect_(defect) {}

  void push(Sample sample) {
    if (pushed_ && defect_ != Defect::kGapsUnseen) {
      counters_.gaps += sample.sequence - last_sequence_ - 1;  // modulo 2^32, as the counter is
    }
    pushed_ = true;
    last_sequence_ = sample.sequence;
    if (queue_.size() == kCapacity) {
      queue_.pop_front();
      if (defect_ != Defect::kLosesSilently) ++counters_.dropped;
      if (defect_ == Defect::kDropsAreGaps) ++counters_.gaps;
    }
    queue_.push_back(std::move(sample));
  }
  bool empty() const { return queue_.empty(); }
  void take(Sample& out) {
    const bool newest = defect_ == Defect::kNewestFirst;
    out = newest ? queue_.back() : queue_.front();
    newest ? queue_.pop_back() : queue_.pop_front();
    if (defect_ == Defect::kDeliversTwice && !repeated_) {
      queue_.push_front(out);
      repeated_ = true;
    } else {
      repeated_ = false;
    }
    if (defect_ != Defect::kNotCounted) ++counters_.delivered;
  }
  void drop_all_but_newest() {
    while (queue_.size() > 1) {
      defect_ == Defect::kDropsNewest ? queue_.pop_back() : queue_.pop_front();
      if (defect_ != Defect::kLosesSilently) ++counters_.dropped;
    }
  }
  hal::SensorCounters counters() const { return counters_; }
  Defect defect() const { return defect_; }

  static constexpr std::size_t kCapacity = 8;

 private:
  Defect defect_;
  std::deque<Sample> queue_;
  hal::SensorCounters counters_;
  std::uint32_t last_sequence_ = 0;
  bool pushed_ = false;
  bool repeated_ = false;
};

// ImuPort, PosePort.
template <class Port, class Sample>
class QueueListPort final : public Port {
 public:
  explicit QueueListPort(Defect defect) : queue_(defect) {}
  SampleQueue<Sample>& queue() { return queue_; }

 private:
  std::size_t do_receive(std::span<Sample> out) override {
    if (queue_.defect() == Defect::kWritesWhenEmpty && !out.empty()) out[0] = Sample{};
    Sample discarded;
    if (queue_.defect() == Defect::kIgnoresRoom && out.empty() && !queue_.empty()) {
      queue_.take(discarded);
    }
    std::size_t count = 0;
    while (count < out.size() && !queue_.empty()) queue_.take(out[count++]);
    return count;
  }
  hal::SensorCounters do_counters() const override { return queue_.counters(); }

  SampleQueue<Sample> queue_;
};

// DepthCameraPort, LidarPort.
template <class Port, class Frame>
class QueueFramePort : public Port {
 public:
  explicit QueueFramePort(Defect defect) : queue_(defect) {}
  SampleQueue<Frame>& queue() { return queue_; }

 private:
  Status do_receive(Frame& out) override {
    if (queue_.empty()) {
      if (queue_.defect() == Defect::kWritesWhenEmpty) out = Frame{};
      return Status::kUnavailable;
    }
    queue_.take(out);
    return Status::kOk;
  }
  hal::SensorCounters do_counters() const override { return queue_.counters(); }

  SampleQueue<Frame> queue_;
};

class QueueStereoPort final : public QueueFramePort<hal::StereoCameraPort, hal::StereoFrame> {
 public:
  explicit QueueStereoPort(Defect defect)
      : QueueFramePort<hal::StereoCameraPort, hal::StereoFrame>(defect) {}
  bool take_trigger() { return std::exchange(triggered_, false); }

 private:
  Status do_trigger() override {
    triggered_ = queue().defect() != Defect::kIgnoresTrigger;
    return Status::kOk;
  }
  bool triggered_ = false;
};

class QueueOperatorPort final : public hal::OperatorPort {
 public:
  explicit QueueOperatorPort(Defect defect) : queue_(defect) {}
  SampleQueue<hal::OperatorCommand>& queue() { return queue_; }

 private:
  Status do_receive(hal::OperatorCommand& out) override {
    if (queue_.empty()) {
      if (queue_.defect() == Defect::kWritesWhenEmpty) out = {};
      return Status::kUnavailable;
    }
    queue_.drop_all_but_newest();
    queue_.take(out);
    return Status::kOk;
  }
  hal::SensorCounters do_counters() const override { return queue_.counters(); }

  SampleQueue<hal::OperatorCommand> queue_;
};

class QueueCanPort final : public hal::CanPort {
 public:
  static constexpr std::size_t kBuses = 3;
  static constexpr std::size_t kReceiveCapacity = 32;
  static constexpr std::size_t kTransmitCapacity = 64;

  explicit QueueCanPort(Defect defect) : defect_(defect) {}

  void push(const hal::CanFrame& frame) {
    if (waiting_.size() == kReceiveCapacity) {
      if (defect_ != Defect::kLosesSilently) ++counters_.receive_dropped;
      return;
    }
    const auto later = [](const hal::CanFrame& a, const hal::CanFrame& b) {
      return a.stamp < b.stamp || (a.stamp == b.stamp && a.bus < b.bus);
    };
    waiting_.insert(std::upper_bound(waiting_.begin(), waiting_.end(), frame, later), frame);
  }

 private:
  std::size_t do_receive(std::span<hal::CanFrame> out) override {
    if (defect_ == Defect::kWritesWhenEmpty && !out.empty()) out[0] = {};
    if (defect_ == Defect::kIgnoresRoom && out.empty() && !waiting_.empty()) waiting_.pop_front();
    std::size_t count = 0;
    while (count < out.size() && !waiting_.empty()) out[count++] = take();
    if (defect_ == Defect::kSwapsBuses && count > 1) std::swap(out[0], out[1]);
    return count;
  }
  hal::CanFrame take() {
    const bool newest = defect_ == Defect::kNewestFirst;
    hal::CanFrame frame = newest ? waiting_.back() : waiting_.front();
    newest ? waiting_.pop_back() : waiting_.pop_front();
    if (defect_ == Defect::kDirtyPadding) frame.data[40] = 0x77;
    if (defect_ == Defect::kBadForm) frame.id = 0x900;
    if (defect_ != Defect::kNotCounted) ++counters_.received;
    return frame;
  }
  Status do_send(const hal::CanFrame& frame) override {
    using Flag = hal::CanFrame::Flag;
    const std::size_t longest = (frame.flags & Flag::kFlexibleDataRate) != 0 ? 64 : 8;
    const std::uint32_t last_id = (frame.flags & Flag::kExtendedId) != 0 ? 0x1FFFFFFF : 0x7FF;
    const bool is_frame = frame.size <= longest && frame.id <= last_id;
    if (!is_frame && defect_ != Defect::kAcceptsAnything) return Status::kInvalid;
    if (frame.bus >= kBuses && defect_ != Defect::kNoBusCheck) {
      ++counters_.send_dropped;
      return Status::kUnavailable;
    }
    if (transmitting_ == kTransmitCapacity) {
      if (defect_ != Defect::kRefusesSilently) ++counters_.send_dropped;
      return Status::kExhausted;
    }
    ++transmitting_;
    ++counters_.sent;
    return Status::kOk;
  }
  hal::CanCounters do_counters() const override { return counters_; }

  Defect defect_;
  std::deque<hal::CanFrame> waiting_;
  std::size_t transmitting_ = 0;
  hal::CanCounters counters_;
};

// A clock whose time is the deadline last waited for; it ends after `ticks`.
class SteppedClock final : public hal::Clock {
 public:
  SteppedClock(Defect defect, int ticks) : defect_(defect), ticks_left_(ticks) {}

 private:
  TimeNs do_now() const override { return now_; }
  Status do_wait_until(TimeNs deadline) override {
    if (ticks_left_ == 0) {
      if (defect_ != Defect::kComesBackToLife) return Status::kEndOfData;
      now_ = deadline;
      return ended_++ == 0 ? Status::kEndOfData : Status::kOk;
    }
    if (deadline < now_) return defect_ == Defect::kIgnoresLate ? Status::kOk : Status::kTimeout;
    --ticks_left_;
    now_ = defect_ == Defect::kReturnsEarly ? deadline - microseconds(1) : deadline;
    if (defect_ == Defect::kGoesBack && ticks_left_ % 4 == 0) now_ = now_ - milliseconds(50);
    return Status::kOk;
  }

  Defect defect_;
  int ticks_left_;
  int ended_ = 0;
  TimeNs now_;
};

// Keeps the messages in one block of memory taken at construction.
class MemorySink final : public hal::RecordSink {
 public:
  struct Entry {
    hal::RecordChannel channel;
    TimeNs stamp;
    const std::uint8_t* bytes;
    std::size_t size;
  };

  explicit MemorySink(Defect defect) : defect_(defect), block_(kBytes) { entries_.reserve(1000); }
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  static constexpr std::size_t kBytes = 2'000'000;  // less than the suite writes: must refuse

  Status do_write(hal::RecordChannel channel, TimeNs stamp,
                  std::span<const std::uint8_t> bytes) override {
    if (defect_ == Defect::kBadForm) return Status::kNotFound;
    if (used_ + bytes.size() > block_.size()) {
      if (defect_ != Defect::kLosesSilently) ++counters_.dropped;
      return Status::kExhausted;
    }
    std::copy(bytes.begin(), bytes.end(), block_.begin() + static_cast<std::ptrdiff_t>(used_));
    // A reference kept instead of a copy shows what the caller writes there afterwards.
    const bool stale = defect_ == Defect::kKeepsReference && !bytes.empty();
    if (stale) std::fill_n(block_.begin() + static_cast<std::ptrdiff_t>(used_), bytes.size(), 0xEE);
    const bool forget = defect_ == Defect::kForgets && counters_.messages == 7;
    if (!forget) entries_.push_back({channel, stamp, block_.data() + used_, bytes.size()});
    if (defect_ == Defect::kAllocates) std::vector<char>(bytes.size() + 1).swap(waste_);
    used_ += bytes.size();
    if (defect_ != Defect::kNotCounted) ++counters_.messages;
    counters_.bytes += bytes.size();
    return Status::kOk;
  }
  hal::RecordCounters do_counters() const override { return counters_; }

  Defect defect_;
  std::vector<std::uint8_t> block_;
  std::size_t used_ = 0;
  std::vector<Entry> entries_;
  std::vector<char> waste_;
  hal::RecordCounters counters_;
};

}  // namespace surefoot::conformance
