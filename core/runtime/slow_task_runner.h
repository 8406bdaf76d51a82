// How slow tasks get their computing time, and who says whether one was done when it was due.
//
// The executive speaks to one runner, always from the tick thread. start() hands over a released
// task; from then until finished() has answered true, only the runner touches the task's run() and
// the task's working memory. finished() is asked at the due tick and at every later tick until it
// answers true; a true answer makes everything run() wrote visible to the tick thread. The answer
// is latched into TickInputs::slow_task_overruns, so that a run may depend on it and replay repeats
// it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/autonomy/tick.h"
#include "core/base/assert.h"
#include "core/base/random.h"
#include "core/base/time.h"
#include "hal/api/clock.h"

namespace surefoot::runtime {

// A slow task as the runner sees it.
struct SlowWork {
  void* self = nullptr;
  void (*run)(void* self) = nullptr;
};

class SlowTaskRunner {
 public:
  // index: position among the slow tasks of the table, below autonomy::kMaxSlowTasks. The task is
  // not running.
  void start(std::size_t index, const SlowWork& work) { do_start(index, work); }
  // Whether the task started last at this index may be published now. Never blocks.
  bool finished(std::size_t index) { return do_finished(index); }
  // How long the last run took; zero when not measured. Asked after finished() answered true.
  TimeNs execution_time(std::size_t index) const { return do_execution_time(index); }
  // Part of execution_time() that was spent on the tick thread, inside start().
  TimeNs inline_time(std::size_t index) const { return do_inline_time(index); }

 protected:
  ~SlowTaskRunner() = default;

 private:
  virtual void do_start(std::size_t index, const SlowWork& work) = 0;
  virtual bool do_finished(std::size_t index) = 0;
  virtual TimeNs do_execution_time(std::size_t index) const = 0;
  virtual TimeNs do_inline_time(std::size_t index) const = 0;
};

// Simulation: runs the task inside start() on the tick thread, and it is always done when due. The
// runners below differ from it only in what they answer.
class InlineRunner : public SlowTaskRunner {
 public:
  // stopwatch: null leaves times at zero. It must outlive the runner.
  explicit InlineRunner(hal::Clock* stopwatch) : stopwatch_(stopwatch) {}

 private:
  // Defined here and not in a source file: core is compiled without run-time type information, and
  // a class whose table lives there could not be derived from in code that has it.
  void do_start(std::size_t index, const SlowWork& work) final {
    SUREFOOT_ASSERT(index < times_.size());
    const TimeNs begin = stopwatch_ != nullptr ? stopwatch_->now() : TimeNs{};
    work.run(work.self);
    times_[index] = stopwatch_ != nullptr ? stopwatch_->now() - begin : TimeNs{};
  }
  bool do_finished(std::size_t) override { return true; }
  TimeNs do_execution_time(std::size_t index) const final {
    SUREFOOT_ASSERT(index < times_.size());
    return times_[index];
  }
  TimeNs do_inline_time(std::size_t index) const final { return do_execution_time(index); }

  hal::Clock* stopwatch_;
  std::array<TimeNs, autonomy::kMaxSlowTasks> times_{};
};

// Simulation with seeded overruns: each question is answered "not yet" with the given probability.
class FaultInjectingRunner final : public InlineRunner {
 public:
  FaultInjectingRunner(hal::Clock* stopwatch, std::uint64_t seed, double probability)
      : InlineRunner(stopwatch), random_(seed), probability_(probability) {}

 private:
  bool do_finished(std::size_t) override { return random_.uniform() >= probability_; }

  Random random_;
  double probability_;
};

// Replay: answers what was recorded. `overruns` is the recorded TickInputs::slow_task_overruns of
// the tick being replayed; whoever feeds the record keeps it up to date.
class RecordedRunner final : public InlineRunner {
 public:
  RecordedRunner(hal::Clock* stopwatch, const std::uint32_t& overruns)
      : InlineRunner(stopwatch), overruns_(overruns) {}

 private:
  bool do_finished(std::size_t index) override { return ((overruns_ >> index) & 1u) == 0; }

  const std::uint32_t& overruns_;
};

}  // namespace surefoot::runtime
