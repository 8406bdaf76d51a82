#include "hal/replay/replay_board.h"

#include <algorithm>

#include "core/base/fixed_vector.h"

namespace surefoot::hal {
namespace {

// Delivers the items of one tick's list, each once.
template <class T, std::size_t kCapacity>
std::size_t deliver(const FixedVector<T, kCapacity>& list, std::size_t& delivered,
                    std::span<T> out) {
  const std::size_t count = std::min(out.size(), list.size() - delivered);
  std::copy_n(list.begin() + delivered, count, out.begin());
  delivered += count;
  return count;
}

class ReplayCan final : public CanPort {
 public:
  explicit ReplayCan(const runtime::TickRecord& tick) : tick_(tick) {}
  void rewind() { delivered_ = 0; }

 private:
  std::size_t do_receive(std::span<CanFrame> out) override {
    const std::size_t count = deliver(tick_.inputs.can, delivered_, out);
    counters_.received += count;
    return count;
  }
  Status do_send(const CanFrame&) override {
    ++counters_.sent;
    return Status::kOk;
  }
  CanCounters do_counters() const override { return counters_; }

  const runtime::TickRecord& tick_;
  std::size_t delivered_ = 0;
  CanCounters counters_;
};

// A sensor whose samples stand in a list of the tick's inputs.
template <class Port, class Sample, auto kList>
class ReplaySamples final : public Port {
 public:
  explicit ReplaySamples(const runtime::TickRecord& tick) : tick_(tick) {}
  void rewind() { delivered_ = 0; }

 private:
  std::size_t do_receive(std::span<Sample> out) override {
    const std::size_t count = deliver(tick_.inputs.*kList, delivered_, out);
    counters_.delivered += count;
    return count;
  }
  SensorCounters do_counters() const override { return counters_; }

  const runtime::TickRecord& tick_;
  std::size_t delivered_ = 0;
  SensorCounters counters_;
};
using ReplayImu = ReplaySamples<ImuPort, ImuSample, &autonomy::TickInputs::imu>;
using ReplayPose = ReplaySamples<PosePort, PoseSample, &autonomy::TickInputs::pose>;

class ReplayGait final : public GaitPort {
 public:
  explicit ReplayGait(const runtime::TickRecord& tick) : tick_(tick) {}
  void rewind() { delivered_ = 0; }

 private:
  Status do_receive(GaitSample& out) override {
    const std::size_t count = deliver(tick_.inputs.gait, delivered_, std::span(&out, 1));
    counters_.delivered += count;
    return count == 1 ? Status::kOk : Status::kUnavailable;
  }
  // What came of it is in the record.
  Status do_send(const GaitCommand&) override { return Status::kOk; }
  SensorCounters do_counters() const override { return counters_; }

  const runtime::TickRecord& tick_;
  std::size_t delivered_ = 0;
  SensorCounters counters_;
};

class ReplayOperator final : public OperatorPort {
 public:
  explicit ReplayOperator(const runtime::TickRecord& tick) : tick_(tick) {}
  void rewind() { waiting_ = tick_.inputs.operator_fresh; }

 private:
  Status do_receive(OperatorCommand& out) override {
    if (!waiting_) return Status::kUnavailable;
    waiting_ = false;
    out = tick_.inputs.operator_command;
    ++counters_.delivered;
    return Status::kOk;
  }
  SensorCounters do_counters() const override { return counters_; }

  const runtime::TickRecord& tick_;
  bool waiting_ = false;
  SensorCounters counters_;
};

// Of a picture only the pixels in use are copied.
template <class Frame>
void assign(Frame& to, const Frame& from) {
  to.assign(from);
}
void assign(LidarScan& to, const LidarScan& from) { to = from; }

// A camera whose pictures lie beside the tick's inputs, which say whether there is one.
template <class Port, class Frame, auto kFresh>
class ReplayFrames : public Port {
 public:
  explicit ReplayFrames(const runtime::TickRecord& tick) : tick_(tick) {}
  void forget() { read_ = false; }
  // Of a message that was decoded into frame().
  void note(TimeNs tick_stamp) {
    read_ = true;
    tick_stamp_ = tick_stamp;
  }
  // The inputs tell of a picture that was not read.
  bool missing() const {
    return tick_.inputs.*kFresh && !(read_ && tick_stamp_ == tick_.inputs.stamp);
  }
  void rewind() { waiting_ = tick_.inputs.*kFresh; }
  Frame& frame() { return frame_; }

 private:
  Status do_receive(Frame& out) override {
    if (!waiting_) return Status::kUnavailable;
    waiting_ = false;
    assign(out, frame_);
    ++counters_.delivered;
    return Status::kOk;
  }
  SensorCounters do_counters() const override { return counters_; }

  const runtime::TickRecord& tick_;
  bool read_ = false;
  TimeNs tick_stamp_;  // of the tick that latched the picture read last
  bool waiting_ = false;
  Frame frame_;
  SensorCounters counters_;
};
using ReplayDepth = ReplayFrames<DepthCameraPort, DepthFrame, &autonomy::TickInputs::depth_fresh>;

using ReplayLidar = ReplayFrames<LidarPort, LidarScan, &autonomy::TickInputs::lidar_fresh>;

class ReplayStereo final
    : public ReplayFrames<StereoCameraPort, StereoFrame, &autonomy::TickInputs::stereo_fresh> {
 public:
  using ReplayFrames::ReplayFrames;

 private:
  // What came of it is in the record.
  Status do_trigger() override { return Status::kOk; }
};

}  // namespace

struct ReplayBoard::Impl final : public Clock {
  RecordReader reader;
  std::string configuration;
  bool has_configuration = false;
  runtime::TickRecord tick;  // being replayed; before the first grant: the first tick
  bool tick_waits = false;   // `tick` has been read but not granted
  TimeNs start;              // now() before the first tick is granted
  std::uint64_t granted = 0;
  ReplayEnd end = ReplayEnd::kNotYet;
  RecordDamage damage;

  ReplayCan can{tick};
  ReplayImu imu{tick};
  ReplayPose pose{tick};
  ReplayOperator operator_port{tick};
  ReplayDepth depth{tick};
  ReplayStereo stereo{tick};
  ReplayLidar lidar{tick};
  ReplayGait gait{tick};

  virtual ~Impl() = default;
  void read_tick();
  bool take(const RecordMessage& message);
  template <class Frame, class Frames>
  void take_frame(const RecordMessage& message,
                  Status (*decode)(std::span<const std::uint8_t>, Frame&), Frames& frames,
                  const std::string& what);
  bool take_tick(const RecordMessage& message);
  void stop(ReplayEnd how, const std::string& reason, const RecordMessage& message);

 private:
  TimeNs do_now() const override { return granted == 0 ? start : tick.inputs.stamp; }
  Status do_wait_until(TimeNs deadline) override;
};

void ReplayBoard::Impl::stop(ReplayEnd how, const std::string& reason,
                             const RecordMessage& message) {
  end = how;
  damage = {message.chunk_offset, message.chunk, reason};
}

// Reads up to the next tick; afterwards tick_waits or end is set.
void ReplayBoard::Impl::read_tick() {
  depth.forget();
  stereo.forget();
  lidar.forget();
  RecordMessage message;
  while (!tick_waits && end == ReplayEnd::kNotYet) {
    const Status status = reader.next(message);
    if (status == Status::kEndOfData) {
      end = ReplayEnd::kComplete;
    } else if (!ok(status)) {
      end = ReplayEnd::kDamaged;
      damage = reader.damage();
    } else {
      tick_waits = take(message);
    }
  }
}

// true: the message was a tick.
bool ReplayBoard::Impl::take(const RecordMessage& message) {
  switch (message.channel) {
    case RecordChannel::kConfiguration:
      configuration.assign(message.bytes.begin(), message.bytes.end());
      has_configuration = true;
      return false;
    case RecordChannel::kDepth:
      take_frame(message, runtime::decode_depth, depth, "depth frame");
      return false;
    case RecordChannel::kStereo:
      take_frame(message, runtime::decode_stereo, stereo, "stereo pair");
      return false;
    case RecordChannel::kLidar:
      take_frame(message, runtime::decode_lidar, lidar, "laser scan");
      return false;
    case RecordChannel::kTick: return take_tick(message);
  }
  return false;
}

template <class Frame, class Frames>
void ReplayBoard::Impl::take_frame(const RecordMessage& message,
                                   Status (*decode)(std::span<const std::uint8_t>, Frame&),
                                   Frames& frames, const std::string& what) {
  if (!ok(decode(message.bytes, frames.frame()))) {
    stop(ReplayEnd::kDamaged, "a " + what + " does not decode: of another version?", message);
  }
  frames.note(message.stamp);
}

bool ReplayBoard::Impl::take_tick(const RecordMessage& message) {
  if (!ok(runtime::decode_tick(message.bytes, tick))) {
    stop(ReplayEnd::kDamaged, "a tick does not decode: of another version?", message);
    return false;
  }
  if (tick.inputs.tick != granted) {
    stop(ReplayEnd::kGap,
         "tick " + std::to_string(granted) + " is missing, the next is tick " +
             std::to_string(tick.inputs.tick),
         message);
    return false;
  }
  const char* const missing = depth.missing()    ? "depth frame"
                              : stereo.missing() ? "stereo pair"
                              : lidar.missing()  ? "laser scan"
                                                 : nullptr;
  if (missing == nullptr) return true;
  stop(ReplayEnd::kGap,
       std::string("the ") + missing + " of tick " + std::to_string(granted) + " is missing",
       message);
  return false;
}

// The recorded tick is what the deadline asks for; if it is not, ReplayComparer finds the stamps
// different.
Status ReplayBoard::Impl::do_wait_until(TimeNs) {
  if (!tick_waits) read_tick();
  if (!tick_waits) return Status::kEndOfData;
  tick_waits = false;
  ++granted;
  can.rewind();
  imu.rewind();
  pose.rewind();
  operator_port.rewind();
  depth.rewind();
  stereo.rewind();
  lidar.rewind();
  gait.rewind();
  return tick.inputs.late ? Status::kTimeout : Status::kOk;
}

ReplayBoard::ReplayBoard() : impl_(std::make_unique<Impl>()) {}
ReplayBoard::~ReplayBoard() = default;

Status ReplayBoard::open(const std::string& path) {
  impl_ = std::make_unique<Impl>();
  const Status opened = impl_->reader.open(path);
  if (!ok(opened)) {
    impl_->end = ReplayEnd::kDamaged;
    impl_->damage = impl_->reader.damage();
    return opened;
  }
  impl_->read_tick();
  if (impl_->end == ReplayEnd::kDamaged || impl_->end == ReplayEnd::kGap) return Status::kCorrupt;
  if (!impl_->has_configuration) {
    impl_->stop(ReplayEnd::kDamaged, "no configuration before the first tick", {});
    return Status::kCorrupt;
  }
  return Status::kOk;
}

const std::string& ReplayBoard::configuration() const { return impl_->configuration; }

Board ReplayBoard::board(TimeNs period) {
  impl_->start = impl_->tick.inputs.stamp - period;
  Board board;
  board.clock = impl_.get();
  board.can = &impl_->can;
  board.imu = &impl_->imu;
  board.pose = &impl_->pose;
  board.operator_port = &impl_->operator_port;
  board.depth_camera = &impl_->depth;
  board.stereo_camera = &impl_->stereo;
  board.lidar = &impl_->lidar;
  board.gait = &impl_->gait;
  return board;
}

const std::uint32_t& ReplayBoard::overruns() const { return impl_->tick.inputs.slow_task_overruns; }

const runtime::TickRecord& ReplayBoard::recorded() const { return impl_->tick; }

std::uint64_t ReplayBoard::ticks() const { return impl_->granted; }

ReplayEnd ReplayBoard::end() const { return impl_->end; }

const RecordDamage& ReplayBoard::damage() const { return impl_->damage; }

std::string ReplayBoard::message() const {
  const std::string ticks = std::to_string(impl_->granted) + " ticks";
  const std::string where = "byte " + std::to_string(impl_->damage.offset) + " (chunk " +
                            std::to_string(impl_->damage.chunk) + ")";
  switch (impl_->end) {
    case ReplayEnd::kNotYet: return ticks + " so far";
    case ReplayEnd::kComplete: return "record complete, " + ticks;
    case ReplayEnd::kDamaged:
      return "record damaged at " + where + ": " + impl_->damage.reason + "; " + ticks +
             " before it";
    case ReplayEnd::kGap:
      return "record incomplete at " + where + ": " + impl_->damage.reason + "; " + ticks +
             " before it";
  }
  return ticks;
}

}  // namespace surefoot::hal
