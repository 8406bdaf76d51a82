#include "core/runtime/executive.h"

#include <cstring>

#include "core/base/assert.h"
#include "core/base/hash.h"

namespace surefoot::runtime {
namespace {

// Ports are emptied in pieces of kDrainPiece items, at most kDrainPieces of them, so that a
// babbling device cannot hold the tick. What is left then waits in the port, which counts its own
// losses.
constexpr std::size_t kDrainPiece = 16;
constexpr std::size_t kDrainPieces = 32;

// Appends one item; the oldest gives way when the list is full. Returns how many gave way.
template <class T, std::size_t kCapacity>
std::uint64_t append_newest(FixedVector<T, kCapacity>& list, const T& item) {
  if (ok(list.push_back(item))) return 0;
  for (std::size_t i = 1; i < kCapacity; ++i) list[i - 1] = list[i];
  list.back() = item;
  return 1;
}

// Moves all that waits in the port into the list; returns how many items gave way.
template <class Port, class T, std::size_t kCapacity>
std::uint64_t drain(Port* port, FixedVector<T, kCapacity>& list) {
  list.clear();
  if (port == nullptr) return 0;
  std::uint64_t dropped = 0;
  std::array<T, kDrainPiece> piece;
  for (std::size_t round = 0; round < kDrainPieces; ++round) {
    const std::size_t count = port->receive(piece);
    for (std::size_t i = 0; i < count; ++i) dropped += append_newest(list, piece[i]);
    if (count < piece.size()) break;
  }
  return dropped;
}

bool task_valid(const Task& task) {
  if (task.release == nullptr || task.run == nullptr || task.publish == nullptr) return false;
  return task.period_ticks > 0 && task.phase_ticks < task.period_ticks;
}

bool setup_valid(const ExecutiveSetup& setup) {
  if (setup.board.clock == nullptr || setup.period.ns <= 0) return false;
  if (setup.tasks.empty() || setup.tasks.size() > kMaxTasks) return false;
  std::size_t slow_tasks = 0;
  for (const Task& task : setup.tasks) {
    if (!task_valid(task)) return false;
    if (task.latency_ticks > 0) ++slow_tasks;
  }
  if (slow_tasks > autonomy::kMaxSlowTasks) return false;
  return slow_tasks == 0 || setup.runner != nullptr;
}

double to_us(TimeNs time) { return static_cast<double>(time.ns) * 1e-3; }

std::uint32_t whole_us(TimeNs time) { return static_cast<std::uint32_t>(time.ns / 1000); }

void fill_quantiles(const DurationHistogram& histogram, TaskReport& report) {
  report.count = histogram.count();
  report.p50_us = to_us(histogram.quantile(0.50));
  report.p99_us = to_us(histogram.quantile(0.99));
  report.max_us = to_us(histogram.maximum());
}

}  // namespace

Status Executive::start(const ExecutiveSetup& setup) {
  if (!setup_valid(setup)) return Status::kInvalid;
  setup_ = setup;
  start_ = setup.board.clock->now() + setup.period;
  ticks_ = 0;
  hash_ = 0;
  tick_overruns_ = 0;
  counters_ = {};
  tick_histogram_ = {};
  std::size_t slow_index = 0;
  for (std::size_t i = 0; i < kMaxTasks; ++i) {
    states_[i] = {};
    const bool slow = i < setup.tasks.size() && setup.tasks[i].latency_ticks > 0;
    if (slow) states_[i].slow_index = slow_index++;
  }
  clear_tick();
  return Status::kOk;
}

// On its own: the two temporaries are off the stack again before a port or a task is called.
[[gnu::noinline]] void Executive::clear_tick() {
  inputs_ = {};
  outputs_ = {};
}

Status Executive::run_tick() {
  SUREFOOT_ASSERT(setup_.board.clock != nullptr);  // start() came first
  const TimeNs stamp = start_ + setup_.period * static_cast<std::int64_t>(ticks_);
  const Status woke = setup_.board.clock->wait_until(stamp);
  if (woke != Status::kOk && woke != Status::kTimeout) return woke;

  inputs_.tick = ticks_;
  inputs_.stamp = stamp;
  if (setup_.observer != nullptr) setup_.observer->begin_tick_body();
  run_tick_body(woke);
  if (setup_.observer != nullptr) setup_.observer->end_tick_body();
  ++ticks_;
  return Status::kOk;
}

void Executive::run_tick_body(Status woke) {
  const TimeNs begin = stopwatch();
  inline_time_ = {};
  outputs_.can.clear();
  outputs_.gait = {};
  outputs_.stereo_trigger = false;
  latch(woke);
  publish_due();
  run_table();
  commit();
  if (setup_.board.stopwatch == nullptr) return;
  const TimeNs duration = stopwatch() - begin - inline_time_;
  tick_histogram_.add(duration);
  if (duration > setup_.period) ++tick_overruns_;
}

void Executive::latch(Status woke) {
  const hal::Board& board = setup_.board;
  inputs_.late = woke == Status::kTimeout;
  if (inputs_.late) ++counters_.late_ticks;
  latch_can();
  counters_.imu_dropped += drain(board.imu, inputs_.imu);
  counters_.pose_dropped += drain(board.pose, inputs_.pose);
  inputs_.operator_fresh =
      board.operator_port != nullptr && ok(board.operator_port->receive(inputs_.operator_command));
  latch_gait();
  latch_frames();
  latch_overruns();
}

void Executive::latch_can() {
  counters_.can_dropped += drain(setup_.board.can, inputs_.can);
  // Only bytes in use are recorded: the others must not carry anything into the autonomy.
  std::size_t kept = 0;
  for (std::size_t i = 0; i < inputs_.can.size(); ++i) {
    hal::CanFrame frame = inputs_.can[i];
    if (frame.size > frame.data.size()) {
      ++counters_.can_invalid;
      continue;
    }
    std::memset(frame.data.data() + frame.size, 0, frame.data.size() - frame.size);
    inputs_.can[kept++] = frame;
  }
  const Status shortened = inputs_.can.resize(kept);
  SUREFOOT_ASSERT(ok(shortened));
}

void Executive::latch_gait() {
  hal::GaitPort* const port = setup_.board.gait;
  inputs_.gait.clear();
  if (port == nullptr) return;
  hal::GaitSample sample;
  for (std::size_t i = 0; i < kDrainPiece * kDrainPieces && ok(port->receive(sample)); ++i) {
    counters_.gait_dropped += append_newest(inputs_.gait, sample);
  }
}

// Null: nothing fresh.
template <class Port, class Frame, std::size_t kMaxBytes>
const Frame* Executive::latch_frame(Port* port, Latched<Frame, kMaxBytes>& latched,
                                    Status (*encode)(const Frame&, std::span<std::uint8_t>,
                                                     std::size_t&),
                                    hal::RecordChannel channel, std::uint64_t& invalid) {
  latched.size = 0;
  if (port == nullptr || !ok(port->receive(latched.frame))) return nullptr;
  if (!ok(encode(latched.frame, latched.bytes, latched.size))) {
    ++invalid;
    return nullptr;
  }
  store_record(channel, latched.used());
  return &latched.frame;
}

void Executive::latch_frames() {
  using hal::RecordChannel;
  const hal::Board& board = setup_.board;
  inputs_.depth = latch_frame(board.depth_camera, depth_, encode_depth, RecordChannel::kDepth,
                              counters_.depth_invalid);
  inputs_.stereo = latch_frame(board.stereo_camera, stereo_, encode_stereo, RecordChannel::kStereo,
                               counters_.stereo_invalid);
  inputs_.lidar = latch_frame(board.lidar, lidar_, encode_lidar, RecordChannel::kLidar,
                              counters_.lidar_invalid);
  inputs_.depth_fresh = inputs_.depth != nullptr;
  inputs_.stereo_fresh = inputs_.stereo != nullptr;
  inputs_.lidar_fresh = inputs_.lidar != nullptr;
}

void Executive::latch_overruns() {
  inputs_.slow_task_overruns = 0;
  for (std::size_t i = 0; i < setup_.tasks.size(); ++i) {
    const TaskState& state = states_[i];
    if (!state.pending || state.due_tick > ticks_) continue;
    if (!setup_.runner->finished(state.slow_index)) {
      inputs_.slow_task_overruns |= std::uint32_t{1} << state.slow_index;
    }
  }
  if (inputs_.slow_task_overruns != 0) ++counters_.overrun_ticks;
}

void Executive::publish_due() {
  for (std::size_t i = 0; i < setup_.tasks.size(); ++i) {
    TaskState& state = states_[i];
    if (!state.pending || state.due_tick > ticks_) continue;
    if (((inputs_.slow_task_overruns >> state.slow_index) & 1u) != 0) continue;
    const Task& task = setup_.tasks[i];
    const TimeNs begin = stopwatch();
    task.publish(task.self, outputs_);
    const TimeNs publish_time = stopwatch() - begin;
    state.pending = false;
    if (state.due_tick < ticks_) ++state.late_publishes;
    account(i, state.release_time + setup_.runner->execution_time(state.slow_index) + publish_time);
  }
}

void Executive::run_table() {
  for (std::size_t i = 0; i < setup_.tasks.size(); ++i) {
    const Task& task = setup_.tasks[i];
    if (ticks_ % task.period_ticks != task.phase_ticks) continue;
    if (task.latency_ticks == 0) {
      run_fast(i);
    } else {
      release_slow(i);
    }
  }
}

void Executive::run_fast(std::size_t index) {
  const Task& task = setup_.tasks[index];
  const TimeNs begin = stopwatch();
  if (!task.release(task.self, inputs_)) return;
  task.run(task.self);
  task.publish(task.self, outputs_);
  account(index, stopwatch() - begin);
}

void Executive::release_slow(std::size_t index) {
  const Task& task = setup_.tasks[index];
  TaskState& state = states_[index];
  if (state.pending) {
    // A task that is released by events may have a period shorter than its latency; only an overrun
    // makes it miss a release.
    if (ticks_ >= state.due_tick) ++state.skipped;
    return;
  }
  const TimeNs begin = stopwatch();
  if (!task.release(task.self, inputs_)) return;
  state.release_time = stopwatch() - begin;
  state.pending = true;
  state.due_tick = ticks_ + task.latency_ticks;
  setup_.runner->start(state.slow_index, SlowWork{task.self, task.run});
  inline_time_ = inline_time_ + setup_.runner->inline_time(state.slow_index);
}

void Executive::commit() {
  if (setup_.board.can != nullptr) {
    for (const hal::CanFrame& frame : outputs_.can) {
      if (!ok(setup_.board.can->send(frame))) ++counters_.sends_refused;
    }
  }
  if (setup_.board.gait != nullptr && !ok(setup_.board.gait->send(outputs_.gait))) {
    ++counters_.sends_refused;
  }
  if (outputs_.stereo_trigger) {
    hal::StereoCameraPort* const camera = setup_.board.stereo_camera;
    if (camera == nullptr || !ok(camera->trigger())) ++counters_.triggers_refused;
  }
  FieldWriter writer(tick_bytes_);
  writer.members(inputs_);
  const std::size_t inputs_size = writer.size();
  writer.members(outputs_);
  const std::size_t outputs_size = writer.size() - inputs_size;

  Fnv64 chain;
  chain.word(hash_, sizeof(hash_));
  chain.bytes(tick_bytes_.data(), inputs_size);
  chain.bytes(depth_.bytes.data(), depth_.size);
  chain.bytes(stereo_.bytes.data(), stereo_.size);
  chain.bytes(lidar_.bytes.data(), lidar_.size);
  chain.bytes(tick_bytes_.data() + inputs_size, outputs_size);
  hash_ = chain.value();

  writer.scalar("hash", hash_);
  SUREFOOT_ASSERT(ok(writer.status()));  // kMaxTickBytes holds any tick
  store_record(hal::RecordChannel::kTick, std::span(tick_bytes_).first(writer.size()));
}

void Executive::store_record(hal::RecordChannel channel, std::span<const std::uint8_t> bytes) {
  if (setup_.board.record == nullptr) return;
  if (!ok(setup_.board.record->write(channel, inputs_.stamp, bytes))) ++counters_.records_refused;
}

void Executive::account(std::size_t index, TimeNs duration) {
  TaskState& state = states_[index];
  state.histogram.add(duration);
  const TimeNs budget = microseconds(setup_.tasks[index].budget_us);
  if (budget.ns > 0 && duration > budget) ++state.overruns;
}

TimeNs Executive::stopwatch() const {
  return setup_.board.stopwatch != nullptr ? setup_.board.stopwatch->now() : TimeNs{};
}

TaskReport Executive::task_report(std::size_t index) const {
  SUREFOOT_ASSERT(index < setup_.tasks.size());
  const Task& task = setup_.tasks[index];
  const TaskState& state = states_[index];
  TaskReport report;
  report.name = task.name;
  report.period_us = whole_us(setup_.period * task.period_ticks);
  report.budget_us = task.budget_us;
  fill_quantiles(state.histogram, report);
  report.overruns = state.overruns;
  report.skipped = state.skipped;
  report.late_publishes = state.late_publishes;
  return report;
}

TaskReport Executive::tick_report() const {
  TaskReport report;
  report.name = "tick";
  report.period_us = whole_us(setup_.period);
  report.budget_us = report.period_us;
  fill_quantiles(tick_histogram_, report);
  report.overruns = tick_overruns_;
  return report;
}

}  // namespace surefoot::runtime
