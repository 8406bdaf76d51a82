// The executive: one thread, one task table, one order. At each tick it
//   1. waits for the tick's deadline (the only place that reads a clock),
//   2. latches every input once into TickInputs,
//   3. runs the table,
//   4. commits: sends the outputs, triggers the stereo camera where they say so, extends the hash
//      chain, writes the record.
//
// Logical execution time. A task with latency 0 runs release, run and publish within its tick, in
// table order. A task with latency k > 0 is released at tick r (release() copies what it needs),
// runs anywhere, and is published at tick r + k before any other task runs, whatever it really
// took. When it is not done by then, bit i of TickInputs::slow_task_overruns is set (i counts the
// slow tasks of the table) and it is published at the first later tick where the bit is clear. A
// slow task that is still pending when its next release comes is not released; that is counted.
//
// A task that is released by events (a fresh frame) has a period shorter than its latency and a
// release() that answers false when there is none; it is not asked while it is pending, so events
// closer together than the latency are passed over. Only ticks lost to an overrun count as skipped.
//
// Hash chain: h[t] = Fnv64(h[t-1], canonical bytes of TickInputs, of the depth frame, of the stereo
// pair and of the laser scan where fresh, of TickOutputs), h[-1] = 0. Execution times never enter.
//
// TickOutputs: the list of CAN frames, the gait command and the trigger are cleared before each
// tick; telemetry keeps its values until a task writes them again.
//
// Fixed memory (about 4.5 MB, most of it one depth frame, one stereo pair and their bytes); no
// heap; the object belongs into static storage. Cost of a tick without tasks: O(inputs + outputs)
// bytes, plus one pass over the frame or pair when there is one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/autonomy/tick.h"
#include "core/base/status.h"
#include "core/base/time.h"
#include "core/runtime/slow_task_runner.h"
#include "core/runtime/statistics.h"
#include "core/runtime/tick_record.h"
#include "hal/api/board.h"

namespace surefoot::runtime {

inline constexpr std::size_t kMaxTasks = 16;

// One row of the task table. Released at ticks where tick % period_ticks == phase_ticks.
struct Task {
  const char* name = "";
  std::uint32_t period_ticks = 1;
  std::uint32_t phase_ticks = 0;
  std::uint32_t latency_ticks = 0;
  std::uint32_t budget_us = 0;
  void* self = nullptr;
  // Takes over what the task needs from the inputs. false: nothing to do, run and publish are left
  // out.
  bool (*release)(void* self, const autonomy::TickInputs& inputs) = nullptr;
  void (*run)(void* self) = nullptr;
  void (*publish)(void* self, autonomy::TickOutputs& outputs) = nullptr;
};

// Told when the body of a tick (latch to commit) begins and ends: memory guards, tracing.
class TickObserver {
 public:
  void begin_tick_body() { do_begin_tick_body(); }
  void end_tick_body() { do_end_tick_body(); }

 protected:
  ~TickObserver() = default;

 private:
  virtual void do_begin_tick_body() = 0;
  virtual void do_end_tick_body() = 0;
};

struct ExecutiveSetup {
  hal::Board board;                  // clock is required, the rest may be null
  std::span<const Task> tasks;       // must outlive the executive
  TimeNs period;                     // of a tick
  SlowTaskRunner* runner = nullptr;  // required when the table has a slow task
  TickObserver* observer = nullptr;
};

// What the executive lost or saw. Not hashed.
struct ExecutiveCounters {
  std::uint64_t late_ticks = 0;
  std::uint64_t can_dropped = 0;  // received, but beyond the capacity of a tick: oldest give way
  std::uint64_t can_invalid = 0;  // received with an impossible size: ignored
  std::uint64_t imu_dropped = 0;
  std::uint64_t pose_dropped = 0;
  std::uint64_t gait_dropped = 0;
  std::uint64_t sends_refused = 0;     // CAN frames and gait commands, by the port
  std::uint64_t depth_invalid = 0;     // frames whose size exceeds the capacity: ignored
  std::uint64_t stereo_invalid = 0;    // pairs, likewise
  std::uint64_t lidar_invalid = 0;     // scans, likewise
  std::uint64_t triggers_refused = 0;  // by the stereo camera, or there is none
  std::uint64_t records_refused = 0;   // by the record sink
  std::uint64_t overrun_ticks = 0;     // ticks at which a slow task was due but not done
};

class Executive {
 public:
  // Checks the table and takes over the set-up; the first tick is due at clock.now() + period.
  // kInvalid: no clock, no or too many tasks, too many slow tasks, a zero period, phase >= period,
  // a null function, or a slow task without a runner; nothing changed.
  Status start(const ExecutiveSetup& setup);

  // One tick. kEndOfData: the clock has no further ticks, nothing was latched or changed. Any other
  // status but kOk comes from the clock, likewise.
  Status run_tick();

  // After run_tick(): of the tick just done.
  const autonomy::TickInputs& inputs() const { return inputs_; }
  const autonomy::TickOutputs& outputs() const { return outputs_; }
  std::uint64_t hash() const { return hash_; }
  // Ticks done.
  std::uint64_t ticks() const { return ticks_; }
  const ExecutiveCounters& counters() const { return counters_; }

  std::size_t task_count() const { return setup_.tasks.size(); }
  TaskReport task_report(std::size_t index) const;
  // Work of the tick thread from latch to commit, without what slow tasks ran inline.
  TaskReport tick_report() const;

 private:
  struct TaskState {
    bool pending = false;        // slow task: released, not yet published
    std::size_t slow_index = 0;  // position among the slow tasks
    std::uint64_t due_tick = 0;
    TimeNs release_time;  // spent in release(), added to the execution
    std::uint64_t overruns = 0;
    std::uint64_t skipped = 0;
    std::uint64_t late_publishes = 0;
    DurationHistogram histogram;
  };

  // A large input that lies beside TickInputs, and its bytes for the hash and the record.
  template <class Frame, std::size_t kMaxBytes>
  struct Latched {
    Frame frame{};
    std::size_t size = 0;  // of the bytes; 0: nothing fresh
    std::array<std::uint8_t, kMaxBytes> bytes{};

    std::span<const std::uint8_t> used() const { return std::span(bytes).first(size); }
  };
  template <class Port, class Frame, std::size_t kMaxBytes>
  const Frame* latch_frame(Port* port, Latched<Frame, kMaxBytes>& latched,
                           Status (*encode)(const Frame&, std::span<std::uint8_t>, std::size_t&),
                           hal::RecordChannel channel, std::uint64_t& invalid);

  void clear_tick();
  void run_tick_body(Status woke);
  void latch(Status woke);
  void latch_can();
  void latch_gait();
  void latch_frames();
  void latch_overruns();
  void publish_due();
  void run_table();
  void run_fast(std::size_t index);
  void release_slow(std::size_t index);
  void commit();
  void store_record(hal::RecordChannel channel, std::span<const std::uint8_t> bytes);
  void account(std::size_t index, TimeNs duration);
  TimeNs stopwatch() const;

  ExecutiveSetup setup_;
  TimeNs start_;  // logical time of tick 0
  std::uint64_t ticks_ = 0;
  std::uint64_t hash_ = 0;
  TimeNs inline_time_;  // of slow tasks, within the present tick
  std::uint64_t tick_overruns_ = 0;
  ExecutiveCounters counters_;
  std::array<TaskState, kMaxTasks> states_{};
  DurationHistogram tick_histogram_;
  autonomy::TickInputs inputs_;
  autonomy::TickOutputs outputs_;
  Latched<hal::DepthFrame, kMaxDepthBytes> depth_;
  Latched<hal::StereoFrame, kMaxStereoBytes> stereo_;
  Latched<hal::LidarScan, kMaxLidarBytes> lidar_;
  std::array<std::uint8_t, kMaxTickBytes> tick_bytes_{};
};

}  // namespace surefoot::runtime
