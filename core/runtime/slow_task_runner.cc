#include "core/runtime/slow_task_runner.h"

#include "core/base/assert.h"

namespace surefoot::runtime {

void InlineRunner::do_start(std::size_t index, const SlowWork& work) {
  SUREFOOT_ASSERT(index < times_.size());
  const TimeNs begin = stopwatch_ != nullptr ? stopwatch_->now() : TimeNs{};
  work.run(work.self);
  times_[index] = stopwatch_ != nullptr ? stopwatch_->now() - begin : TimeNs{};
}

TimeNs InlineRunner::do_execution_time(std::size_t index) const {
  SUREFOOT_ASSERT(index < times_.size());
  return times_[index];
}

TimeNs InlineRunner::do_inline_time(std::size_t index) const {
  return do_execution_time(index);
}

}  // namespace surefoot::runtime
