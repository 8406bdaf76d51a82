// The executive's own work: latch, hash chain and record.
#include "core/base/assert.h"
#include "core/runtime/executive.h"
#include "tests/timing/work_case.h"

namespace surefoot::timing {
namespace {

class StepClock final : public hal::Clock {
  TimeNs do_now() const override { return time_; }
  Status do_wait_until(TimeNs deadline) override {
    time_ = deadline;
    return Status::kOk;
  }
  TimeNs time_;
};

// Devices that always have more than a tick can take.
class BabblingCan final : public hal::CanPort {
  std::size_t do_receive(std::span<hal::CanFrame> out) override {
    for (hal::CanFrame& frame : out) {
      frame.id = ++count_ & 0x7FF;
      frame.flags = hal::CanFrame::kFlexibleDataRate;
      frame.size = 64;
      frame.data.fill(static_cast<std::uint8_t>(count_));
    }
    return out.size();
  }
  Status do_send(const hal::CanFrame&) override { return Status::kOk; }
  hal::CanCounters do_counters() const override { return {}; }
  std::uint32_t count_ = 0;
};

class BabblingImu final : public hal::ImuPort {
  std::size_t do_receive(std::span<hal::ImuSample> out) override {
    for (hal::ImuSample& sample : out) sample.sequence = ++count_;
    return out.size();
  }
  hal::SensorCounters do_counters() const override { return {}; }
  std::uint32_t count_ = 0;
};

class BabblingPose final : public hal::PosePort {
  std::size_t do_receive(std::span<hal::PoseSample> out) override {
    for (hal::PoseSample& sample : out) sample.sequence = ++count_;
    return out.size();
  }
  hal::SensorCounters do_counters() const override { return {}; }
  std::uint32_t count_ = 0;
};

class EagerOperator final : public hal::OperatorPort {
  Status do_receive(hal::OperatorCommand& out) override {
    ++out.sequence;
    return Status::kOk;
  }
  hal::SensorCounters do_counters() const override { return {}; }
};

// 640 x 480; the pixels are written at the first call, later ones change one.
class LargeDepth final : public hal::DepthCameraPort {
  Status do_receive(hal::DepthFrame& out) override {
    out.intrinsics = {hal::kMaxDepthWidth_px, hal::kMaxDepthHeight_px, 600, 600, 319.5, 239.5};
    if (count_ == 0) {
      for (std::size_t i = 0; i < out.depth.size(); ++i) {
        out.depth[i] = static_cast<std::uint16_t>(500 + i % 3000);
      }
    }
    out.depth[count_++] = 1;
    return Status::kOk;
  }
  hal::SensorCounters do_counters() const override { return {}; }
  std::size_t count_ = 0;
};

class CountingSink final : public hal::RecordSink {
 public:
  std::size_t bytes = 0;  // of the last tick's messages

 private:
  Status do_write(hal::RecordChannel channel, TimeNs, std::span<const std::uint8_t> data) override {
    bytes = channel == hal::RecordChannel::kDepth ? data.size() : bytes + data.size();
    return Status::kOk;
  }
  hal::RecordCounters do_counters() const override { return {}; }
};

// Fills the outputs and nothing else.
runtime::Task full_outputs() {
  runtime::Task task;
  task.name = "outputs";
  task.release = [](void*, const autonomy::TickInputs&) { return true; };
  task.run = [](void*) {};
  task.publish = [](void*, autonomy::TickOutputs& outputs) {
    SUREFOOT_ASSERT(ok(outputs.can.resize(autonomy::kMaxCanFramesPerTick)));
    for (hal::CanFrame& frame : outputs.can) frame.size = 64;
  };
  return task;
}

// One tick; the second one is measured. Without kDepth there is no camera frame, as at most ticks.
template <bool kDepth>
class FullTick final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    runtime::ExecutiveSetup setup;
    setup.board.clock = &clock_;
    setup.board.can = &can_;
    setup.board.imu = &imu_;
    setup.board.pose = &pose_;
    setup.board.operator_port = &operator_;
    if (kDepth) setup.board.depth_camera = &depth_;
    setup.board.record = &sink_;
    setup.tasks = tasks_;
    setup.period = milliseconds(2);
    SUREFOOT_ASSERT(ok(executive_.start(setup)));
    SUREFOOT_ASSERT(ok(executive_.run_tick()));
    return true;
  }
  void run() override { status_ = executive_.run_tick(); }
  bool did_the_work() override {
    const std::size_t least = kDepth ? 2 * 640 * 480 : 12000;
    return ok(status_) && executive_.inputs().can.full() && executive_.inputs().imu.full() &&
           executive_.inputs().pose.full() && executive_.counters().can_dropped == 2 * 448 &&
           executive_.outputs().can.full() && sink_.bytes > least;
  }

 private:
  StepClock clock_;
  BabblingCan can_;
  BabblingImu imu_;
  BabblingPose pose_;
  EagerOperator operator_;
  LargeDepth depth_;
  CountingSink sink_;
  std::array<runtime::Task, 1> tasks_{full_outputs()};
  runtime::Executive executive_;
  Status status_ = Status::kUnavailable;
};

template <class Case>
std::unique_ptr<WorkCase> make() {
  return std::make_unique<Case>();
}

}  // namespace

const WorkEntry kExecutiveCases[] = {
    {"executive_tick", "latch, hash and record; every list full, devices that do not stop",
     make<FullTick<false>>},
    {"executive_depth", "the same with a depth frame of 640 x 480 pixels", make<FullTick<true>>},
    {nullptr, nullptr, nullptr}};

}  // namespace surefoot::timing
