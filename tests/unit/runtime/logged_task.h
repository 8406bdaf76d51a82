// An executive over a fake board, and tasks that log what happens to them.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "core/runtime/executive.h"
#include "tests/unit/runtime/fake_board.h"

namespace surefoot::runtime {

using testing::FakeBoard;

// A task that logs what happens to it and when.
struct LoggedTask {
  std::string name;
  std::vector<std::string>* log = nullptr;
  testing::ManualStopwatch* stopwatch = nullptr;
  TimeNs cost;
  bool has_work = true;
  std::uint64_t released_at = 0;
  std::vector<std::uint64_t> published;  // the tick each published result was released at

  static bool release(void* self, const autonomy::TickInputs& inputs) {
    auto& task = *static_cast<LoggedTask*>(self);
    if (!task.has_work) return false;
    task.released_at = inputs.tick;
    task.log->push_back(task.name + ".release");
    return true;
  }
  static void run(void* self) {
    auto& task = *static_cast<LoggedTask*>(self);
    task.log->push_back(task.name + ".run");
    if (task.stopwatch != nullptr) task.stopwatch->time = task.stopwatch->time + task.cost;
  }
  static void publish(void* self, autonomy::TickOutputs& outputs) {
    auto& task = *static_cast<LoggedTask*>(self);
    task.log->push_back(task.name + ".publish");
    task.published.push_back(task.released_at);
    outputs.telemetry.map_digest = task.released_at + 1;
  }
  Task row(std::uint32_t period, std::uint32_t phase, std::uint32_t latency) {
    return {name.c_str(), period, phase, latency, 0, this, release, run, publish};
  }
};

class ExecutiveTest : public ::testing::Test {
 protected:
  void start(std::vector<Task> table, SlowTaskRunner* runner = nullptr) {
    table_ = std::move(table);
    ExecutiveSetup setup;
    setup.board = board_.board();
    setup.tasks = table_;
    setup.period = milliseconds(2);
    setup.runner = runner != nullptr ? runner : &inline_runner_;
    ASSERT_EQ(executive_->start(setup), Status::kOk);
  }
  void tick() {
    log_.clear();
    ASSERT_EQ(executive_->run_tick(), Status::kOk);
  }

  FakeBoard board_;
  InlineRunner inline_runner_{&board_.stopwatch};
  std::vector<std::string> log_;
  std::vector<Task> table_;
  std::unique_ptr<Executive> executive_ = std::make_unique<Executive>();
  LoggedTask control_{"control", &log_, &board_.stopwatch, {}, true, 0, {}};
  LoggedTask mapping_{"mapping", &log_, &board_.stopwatch, {}, true, 0, {}};
};

}  // namespace surefoot::runtime
