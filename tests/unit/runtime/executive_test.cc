#include "core/runtime/executive.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "tests/unit/runtime/logged_task.h"

namespace surefoot::runtime {
namespace {

// Answers from a script; runs inline.
class ScriptedRunner final : public InlineRunner {
 public:
  ScriptedRunner() : InlineRunner(nullptr) {}
  std::vector<bool> answers;  // true when they run out

 private:
  bool do_finished(std::size_t) override { return next_ >= answers.size() || answers[next_++]; }
  std::size_t next_ = 0;
};

TEST_F(ExecutiveTest, FastTaskRunsWithinItsTickInTableOrder) {
  LoggedTask second{"second", &log_, nullptr, {}, true, 0, {}};
  start({control_.row(1, 0, 0), second.row(2, 1, 0)});
  tick();
  EXPECT_EQ(log_, (std::vector<std::string>{"control.release", "control.run", "control.publish"}));
  tick();
  EXPECT_EQ(log_, (std::vector<std::string>{"control.release", "control.run", "control.publish",
                                            "second.release", "second.run", "second.publish"}));
}

TEST_F(ExecutiveTest, SlowResultIsVisibleExactlyAfterItsLatencyAndBeforeOtherTasks) {
  start({control_.row(1, 0, 0), mapping_.row(10, 2, 4)});
  for (std::uint64_t t = 0; t < 30; ++t) {
    tick();
    const bool due = t % 10 == 6;
    EXPECT_EQ(log_.front() == "mapping.publish", due) << t;
    EXPECT_EQ(executive_->inputs().slow_task_overruns, 0u);
  }
  EXPECT_EQ(mapping_.published, (std::vector<std::uint64_t>{2, 12, 22}));
}

TEST_F(ExecutiveTest, LatencyEqualToThePeriodPublishesThenReleases) {
  start({mapping_.row(3, 0, 3)});
  for (int t = 0; t < 3; ++t) tick();
  tick();
  EXPECT_EQ(log_, (std::vector<std::string>{"mapping.publish", "mapping.release", "mapping.run"}));
  EXPECT_EQ(executive_->task_report(0).skipped, 0u);
}

TEST_F(ExecutiveTest, ATaskReleasedByEventsIsNotAskedWhilePending) {
  start({mapping_.row(1, 0, 4)});
  for (std::uint64_t t = 0; t < 12; ++t) {
    mapping_.has_work = t == 1 || t == 3 || t == 7;  // 3 comes while the result of 1 is pending
    tick();
  }
  EXPECT_EQ(mapping_.published, (std::vector<std::uint64_t>{1, 7}));
  EXPECT_EQ(executive_->task_report(0).skipped, 0u);
}

TEST_F(ExecutiveTest, NothingToDoLeavesOutRunAndPublish) {
  start({control_.row(1, 0, 0), mapping_.row(5, 0, 2)});
  mapping_.has_work = false;
  control_.has_work = false;
  for (int t = 0; t < 8; ++t) {
    tick();
    EXPECT_TRUE(log_.empty());
  }
  EXPECT_EQ(executive_->task_report(0).count, 0u);
}

TEST_F(ExecutiveTest, OverrunIsLatchedAndPublishesAtTheFirstClearTick) {
  ScriptedRunner runner;
  runner.answers = {false, false, true};
  start({control_.row(1, 0, 0), mapping_.row(10, 0, 3)}, &runner);
  for (std::uint64_t t = 0; t < 6; ++t) {
    tick();
    EXPECT_EQ(executive_->inputs().slow_task_overruns, t == 3 || t == 4 ? 1u : 0u) << t;
    EXPECT_EQ(mapping_.published.size(), t < 5 ? 0u : 1u) << t;
  }
  EXPECT_EQ(executive_->task_report(1).late_publishes, 1u);
  EXPECT_EQ(executive_->counters().overrun_ticks, 2u);
}

TEST_F(ExecutiveTest, TheOverrunBitCountsSlowTasksOnly) {
  ScriptedRunner runner;
  runner.answers = {true, false};  // first slow task done, second not
  LoggedTask planning{"planning", &log_, nullptr, {}, true, 0, {}};
  start({control_.row(1, 0, 0), mapping_.row(10, 0, 1), planning.row(10, 0, 1)}, &runner);
  tick();
  tick();
  EXPECT_EQ(executive_->inputs().slow_task_overruns, 2u);
}

TEST_F(ExecutiveTest, ReleaseIsSkippedAndCountedWhileTheTaskIsPending) {
  ScriptedRunner runner;
  runner.answers = {false, false, true};
  start({mapping_.row(2, 0, 1)}, &runner);
  // Released at 0, due at 1, late at 1 and 2 (its release at 2 is skipped), published at 3.
  for (int t = 0; t < 4; ++t) tick();
  EXPECT_EQ(executive_->task_report(0).skipped, 1u);
  EXPECT_EQ(mapping_.published, std::vector<std::uint64_t>{0});
}

TEST_F(ExecutiveTest, FaultInjectionRepeatsWithItsSeedAndIsRepeatedFromTheRecord) {
  const auto overruns_of = [this](SlowTaskRunner& runner, std::uint32_t* replayed,
                                  const std::vector<std::uint32_t>& source) {
    std::vector<std::uint32_t> bits;
    board_.clock = {};
    start({control_.row(1, 0, 0), mapping_.row(5, 0, 3)}, &runner);
    for (std::size_t t = 0; t < 200; ++t) {
      if (replayed != nullptr) *replayed = source[t];
      tick();
      bits.push_back(executive_->inputs().slow_task_overruns);
    }
    return bits;
  };
  FaultInjectingRunner first(nullptr, 7, 0.5);
  const auto a = overruns_of(first, nullptr, {});
  const std::uint64_t hash = executive_->hash();
  FaultInjectingRunner again(nullptr, 7, 0.5);
  EXPECT_EQ(a, overruns_of(again, nullptr, {}));
  EXPECT_EQ(hash, executive_->hash());
  std::uint32_t present = 0;
  RecordedRunner recorded(nullptr, present);
  EXPECT_EQ(a, overruns_of(recorded, &present, a));
  EXPECT_EQ(hash, executive_->hash());
  FaultInjectingRunner other(nullptr, 8, 0.5);
  EXPECT_NE(a, overruns_of(other, nullptr, {}));
}

TEST_F(ExecutiveTest, TicksHaveLogicalTimeAndLateOnesAreFlagged) {
  board_.clock.time = milliseconds(100);
  board_.clock.late_ticks = {1};
  start({control_.row(1, 0, 0)});
  for (std::uint64_t t = 0; t < 3; ++t) {
    tick();
    EXPECT_EQ(executive_->inputs().tick, t);
    EXPECT_EQ(executive_->inputs().stamp, milliseconds(102 + 2 * static_cast<std::int64_t>(t)));
    EXPECT_EQ(board_.clock.last_deadline, executive_->inputs().stamp);
    EXPECT_EQ(executive_->inputs().late, t == 1);
  }
  EXPECT_EQ(executive_->counters().late_ticks, 1u);
}

TEST_F(ExecutiveTest, EndOfDataChangesNothing) {
  board_.clock.ticks = 2;
  start({control_.row(1, 0, 0)});
  tick();
  tick();
  const std::uint64_t hash = executive_->hash();
  board_.imu.push({});
  EXPECT_EQ(executive_->run_tick(), Status::kEndOfData);
  EXPECT_EQ(executive_->ticks(), 2u);
  EXPECT_EQ(executive_->hash(), hash);
  EXPECT_EQ(board_.imu.waiting(), 1u);
}

TEST_F(ExecutiveTest, ARefusingRecordIsCountedAndChangesNoHash) {
  start({control_.row(1, 0, 0)});
  tick();
  const std::uint64_t hash = executive_->hash();
  board_.clock = {};
  board_.record.refuse = true;
  start({control_.row(1, 0, 0)});
  tick();
  EXPECT_EQ(executive_->counters().records_refused, 1u);
  EXPECT_EQ(executive_->hash(), hash);
}

TEST_F(ExecutiveTest, TimesAreMeasuredAgainstBudgetsAndInlineWorkIsNotTheTicks) {
  control_.cost = microseconds(100);
  mapping_.cost = milliseconds(5);
  Task control = control_.row(1, 0, 0);
  control.budget_us = 99;
  start({control, mapping_.row(4, 0, 2)});
  for (int t = 0; t < 8; ++t) tick();
  EXPECT_EQ(executive_->task_report(0).count, 8u);
  EXPECT_EQ(executive_->task_report(0).overruns, 8u);
  EXPECT_EQ(executive_->task_report(0).max_us, 100.0);
  EXPECT_EQ(executive_->task_report(0).period_us, 2000u);
  EXPECT_EQ(executive_->task_report(1).count, 2u);
  EXPECT_EQ(executive_->task_report(1).max_us, 5000.0);
  EXPECT_EQ(executive_->task_report(1).overruns, 0u);  // no budget
  EXPECT_EQ(executive_->tick_report().count, 8u);
  EXPECT_EQ(executive_->tick_report().max_us, 100.0);
  EXPECT_EQ(executive_->tick_report().overruns, 0u);
}

class Observer final : public TickObserver {
 public:
  int begun = 0;
  int ended = 0;

 private:
  void do_begin_tick_body() override { ++begun; }
  void do_end_tick_body() override { ++ended; }
};

TEST_F(ExecutiveTest, ObserverSeesEveryTickBody) {
  Observer observer;
  table_ = {control_.row(1, 0, 0)};
  ExecutiveSetup setup;
  setup.board = board_.board();
  setup.tasks = table_;
  setup.period = milliseconds(1);
  setup.observer = &observer;
  board_.clock.ticks = 3;
  ASSERT_EQ(executive_->start(setup), Status::kOk);
  while (ok(executive_->run_tick())) {
  }
  EXPECT_EQ(observer.begun, 3);
  EXPECT_EQ(observer.ended, 3);
}

TEST_F(ExecutiveTest, WrongTablesAreRefused) {
  ExecutiveSetup setup;
  setup.board = board_.board();
  setup.period = milliseconds(1);
  setup.runner = &inline_runner_;
  const auto refused = [&](const std::vector<Task>& table) {
    setup.tasks = table;
    return executive_->start(setup) == Status::kInvalid;
  };
  const Task good = control_.row(2, 1, 0);
  EXPECT_FALSE(refused({good}));
  EXPECT_TRUE(refused({}));
  EXPECT_TRUE(refused(std::vector<Task>(kMaxTasks + 1, good)));
  EXPECT_TRUE(refused({control_.row(0, 0, 0)}));
  EXPECT_TRUE(refused({control_.row(2, 2, 0)}));
  EXPECT_TRUE(refused(std::vector<Task>(autonomy::kMaxSlowTasks + 1, control_.row(2, 0, 1))));
  Task incomplete = good;
  incomplete.publish = nullptr;
  EXPECT_TRUE(refused({incomplete}));
  setup.runner = nullptr;
  EXPECT_TRUE(refused({control_.row(2, 0, 1)}));
  setup.period = {};
  EXPECT_TRUE(refused({good}));
  setup.period = milliseconds(1);
  setup.board.clock = nullptr;
  EXPECT_TRUE(refused({good}));
}

}  // namespace
}  // namespace surefoot::runtime
