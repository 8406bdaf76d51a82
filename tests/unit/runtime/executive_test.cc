#include "core/runtime/executive.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "tests/unit/runtime/fake_board.h"

namespace surefoot::runtime {
namespace {

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

TEST_F(ExecutiveTest, OldestInputsGiveWayAndAreCounted) {
  start({control_.row(1, 0, 0)});
  for (std::uint32_t i = 0; i < 70; ++i) {
    hal::CanFrame frame;
    frame.id = i;
    board_.can.push(frame);
  }
  for (std::uint32_t i = 0; i < 20; ++i) {
    hal::ImuSample sample;
    sample.sequence = i;
    board_.imu.push(sample);
  }
  for (int i = 0; i < 9; ++i) board_.pose.push({});
  tick();
  EXPECT_EQ(executive_->inputs().can.size(), autonomy::kMaxCanFramesPerTick);
  EXPECT_EQ(executive_->inputs().can[0].id, 6u);
  EXPECT_EQ(executive_->inputs().can.back().id, 69u);
  EXPECT_EQ(executive_->inputs().imu[0].sequence, 4u);
  EXPECT_EQ(executive_->counters().can_dropped, 6u);
  EXPECT_EQ(executive_->counters().imu_dropped, 4u);
  EXPECT_EQ(executive_->counters().pose_dropped, 1u);
  tick();
  EXPECT_TRUE(executive_->inputs().can.empty());
}

TEST_F(ExecutiveTest, ABabblingBusCannotHoldTheTick) {
  start({control_.row(1, 0, 0)});
  for (int i = 0; i < 2000; ++i) board_.can.push({});
  tick();
  EXPECT_GT(board_.can.waiting(), 0u);
  EXPECT_EQ(
      board_.can.waiting() + executive_->counters().can_dropped + executive_->inputs().can.size(),
      2000u);
}

TEST_F(ExecutiveTest, FramesAreCanonicalWhenLatched) {
  start({control_.row(1, 0, 0)});
  hal::CanFrame frame;
  frame.size = 2;
  frame.data.fill(0xEE);
  board_.can.push(frame);
  frame.size = 65;
  board_.can.push(frame);
  tick();
  ASSERT_EQ(executive_->inputs().can.size(), 1u);
  EXPECT_EQ(executive_->inputs().can[0].data[1], 0xEE);
  EXPECT_EQ(executive_->inputs().can[0].data[2], 0);
  EXPECT_EQ(executive_->counters().can_invalid, 1u);
}

// Sends as many frames as told.
struct Sender {
  std::size_t frames = 3;
  static bool release(void*, const autonomy::TickInputs&) { return true; }
  static void run(void*) {}
  static void publish(void* self, autonomy::TickOutputs& outputs) {
    for (std::size_t i = 0; i < static_cast<Sender*>(self)->frames; ++i) {
      hal::CanFrame frame;
      frame.id = static_cast<std::uint32_t>(i);
      ASSERT_EQ(outputs.can.push_back(frame), Status::kOk);
    }
  }
};

TEST_F(ExecutiveTest, SendsInOrderOncePerTickAndCountsRefusals) {
  Sender sender;
  board_.can.refuse_from = 5;
  start({{"sender", 1, 0, 0, 0, &sender, Sender::release, Sender::run, Sender::publish}});
  tick();
  tick();
  ASSERT_EQ(board_.can.sent.size(), 5u);
  EXPECT_EQ(board_.can.sent[1].id, 1u);
  EXPECT_EQ(executive_->outputs().can.size(), 3u);
  EXPECT_EQ(executive_->counters().sends_refused, 1u);
}

TEST_F(ExecutiveTest, RecordsDepthBeforeItsTickAndChainsTheHash) {
  start({control_.row(1, 0, 0)});
  board_.depth.frame.intrinsics.width_px = 3;
  board_.depth.frame.intrinsics.height_px = 2;
  board_.depth.frame.depth[5] = 1234;
  board_.depth.waiting = 1;
  board_.imu.push({});
  board_.operator_port.fresh = true;
  tick();
  tick();
  const auto& messages = board_.record.messages;
  ASSERT_EQ(messages.size(), 3u);
  EXPECT_EQ(messages[0].channel, hal::RecordChannel::kDepth);
  EXPECT_EQ(messages[1].channel, hal::RecordChannel::kTick);
  EXPECT_EQ(messages[1].stamp, milliseconds(2));

  auto decoded = std::make_unique<TickRecord>();
  ASSERT_EQ(decode_tick(messages[1].bytes, *decoded), Status::kOk);
  EXPECT_TRUE(decoded->inputs.depth_fresh);
  EXPECT_TRUE(decoded->inputs.operator_fresh);
  EXPECT_EQ(decoded->inputs.imu.size(), 1u);
  auto frame = std::make_unique<hal::DepthFrame>();
  ASSERT_EQ(decode_depth(messages[0].bytes, *frame), Status::kOk);
  EXPECT_EQ(frame->depth[5], 1234);

  // The documented chain, computed from the recorded bytes alone.
  auto hash_of = [](std::uint64_t before, const hal::DepthFrame* depth, const TickRecord& record) {
    Fnv64 chain;
    chain.word(before, 8);
    FieldHasher hasher(chain);
    hasher.members(record.inputs);
    if (depth != nullptr) hasher.members(*depth);
    hasher.members(record.outputs);
    return chain.value();
  };
  EXPECT_EQ(decoded->hash, hash_of(0, frame.get(), *decoded));
  const std::uint64_t first = decoded->hash;
  ASSERT_EQ(decode_tick(messages[2].bytes, *decoded), Status::kOk);
  EXPECT_FALSE(decoded->inputs.depth_fresh);
  EXPECT_EQ(decoded->hash, hash_of(first, nullptr, *decoded));
  EXPECT_EQ(decoded->hash, executive_->hash());
}

TEST_F(ExecutiveTest, DepthEntersTheHash) {
  std::vector<std::uint64_t> hashes;
  for (const std::uint16_t depth : {std::uint16_t{1000}, std::uint16_t{1001}}) {
    board_.clock = {};
    board_.depth.frame.intrinsics.width_px = 1;
    board_.depth.frame.intrinsics.height_px = 1;
    board_.depth.frame.depth[0] = depth;
    board_.depth.waiting = 1;
    start({control_.row(1, 0, 0)});
    tick();
    hashes.push_back(executive_->hash());
  }
  EXPECT_NE(hashes[0], hashes[1]);
}

TEST_F(ExecutiveTest, DepthLargerThanTheCapacityIsIgnoredAndCounted) {
  board_.depth.frame.intrinsics.width_px = 2000;
  board_.depth.frame.intrinsics.height_px = 2000;
  board_.depth.waiting = 1;
  start({control_.row(1, 0, 0)});
  tick();
  EXPECT_FALSE(executive_->inputs().depth_fresh);
  EXPECT_EQ(executive_->inputs().depth, nullptr);
  EXPECT_EQ(executive_->counters().depth_invalid, 1u);
}

TEST_F(ExecutiveTest, RecordsTheStereoPairBeforeItsTickAndHashesIt) {
  std::vector<std::uint64_t> hashes;
  for (const std::uint8_t grey : {std::uint8_t{7}, std::uint8_t{8}}) {
    board_.clock = {};
    board_.record.messages.clear();
    board_.stereo.frame.width_px = 3;
    board_.stereo.frame.height_px = 2;
    board_.stereo.frame.right[5] = grey;
    board_.stereo.waiting = 1;
    start({control_.row(1, 0, 0)});
    tick();
    EXPECT_TRUE(executive_->inputs().stereo_fresh);
    ASSERT_EQ(board_.record.messages.size(), 2u);
    EXPECT_EQ(board_.record.messages[0].channel, hal::RecordChannel::kStereo);
    auto pair = std::make_unique<hal::StereoFrame>();
    ASSERT_EQ(decode_stereo(board_.record.messages[0].bytes, *pair), Status::kOk);
    EXPECT_EQ(pair->right[5], grey);
    hashes.push_back(executive_->hash());
    tick();
    EXPECT_FALSE(executive_->inputs().stereo_fresh);
    EXPECT_EQ(executive_->inputs().stereo, nullptr);
  }
  EXPECT_NE(hashes[0], hashes[1]);
}

TEST_F(ExecutiveTest, APairLargerThanTheCapacityIsIgnoredAndCounted) {
  board_.stereo.frame.width_px = board_.stereo.frame.height_px = 2000;
  board_.stereo.waiting = 1;
  start({control_.row(1, 0, 0)});
  tick();
  EXPECT_FALSE(executive_->inputs().stereo_fresh);
  EXPECT_EQ(executive_->counters().stereo_invalid, 1u);
}

TEST_F(ExecutiveTest, TriggersTheStereoCameraAtCommitAndOnlyThen) {
  Task trigger = control_.row(5, 2, 0);
  trigger.publish = [](void*, autonomy::TickOutputs& outputs) { outputs.stereo_trigger = true; };
  start({trigger});
  for (int t = 0; t < 10; ++t) tick();
  EXPECT_EQ(board_.stereo.triggers, 2u);
  EXPECT_EQ(executive_->counters().triggers_refused, 0u);
  board_.stereo.refuse = true;
  for (int t = 0; t < 5; ++t) tick();
  EXPECT_EQ(executive_->counters().triggers_refused, 1u);
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
