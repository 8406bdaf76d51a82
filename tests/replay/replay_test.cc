#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <memory>
#include <string>

#include "hal/record/record_writer.h"
#include "hal/replay/replay_board.h"
#include "hal/replay/replay_comparer.h"
#include "hal/replay/surefoot_record.h"
#include "tests/replay/fake_run.h"
#include "tests/unit/hal/record_fixture.h"

namespace surefoot::hal {
namespace {

using testing::FakeAutonomy;
using testing::FakeBoard;
using testing::FakeInputs;
using testing::ScratchFolder;

constexpr TimeNs kPeriod = milliseconds(2);
constexpr std::uint64_t kTicks = 400;
const std::string kConfiguration = "fake: true\n";

struct Recorded {
  std::uint64_t hash = 0;
  std::uint64_t overrun_ticks = 0;
};

// Runs the fake robot and writes its record, without the messages of `lose_tick`.
Recorded record_run(const std::string& path, std::uint64_t lose_tick = UINT64_MAX) {
  FakeBoard fake;
  fake.clock.late_ticks = {17, 18, 200};
  fake.can.keep_sent = false;
  RecordWriter writer;
  RecordWriterOptions options;
  options.max_chunk_span = milliseconds(100);
  EXPECT_EQ(writer.open(path, surefoot_record_layout(), options), Status::kOk);
  EXPECT_EQ(writer.write(RecordChannel::kConfiguration, {},
                         {reinterpret_cast<const std::uint8_t*>(kConfiguration.data()),
                          kConfiguration.size()}),
            Status::kOk);
  FakeAutonomy autonomy;
  const auto table = autonomy.table();
  runtime::FaultInjectingRunner runner(nullptr, 5, 0.4);
  auto executive = std::make_unique<runtime::Executive>();
  runtime::ExecutiveSetup setup{fake.board(), table, kPeriod, &runner, nullptr};
  EXPECT_EQ(executive->start(setup), Status::kOk);
  FakeInputs inputs(11);
  RecordWriter unused;  // refuses everything: it is not open
  for (std::uint64_t t = 0; t < kTicks; ++t) {
    inputs.feed(fake, t);
    fake.record.forward = t == lose_tick ? &unused : &writer;
    EXPECT_EQ(executive->run_tick(), Status::kOk);
  }
  EXPECT_EQ(writer.close(), Status::kOk) << writer.error();
  return {executive->hash(), executive->counters().overrun_ticks};
}

struct Replayed {
  Status opened = Status::kOk;
  std::uint64_t ticks = 0;
  std::uint64_t hash = 0;
  bool identical = true;
  ReplayDifference difference;
  ReplayEnd end = ReplayEnd::kNotYet;
  RecordDamage damage;
  std::string message;
  std::string configuration;
};

Replayed replay_run(const std::string& path, std::uint64_t tamper_tick = UINT64_MAX) {
  Replayed result;
  ReplayBoard board;
  result.opened = board.open(path);
  if (ok(result.opened)) {
    FakeAutonomy autonomy;
    autonomy.tamper_tick = tamper_tick;
    const auto table = autonomy.table();
    runtime::RecordedRunner runner(nullptr, board.overruns());
    auto executive = std::make_unique<runtime::Executive>();
    runtime::ExecutiveSetup setup{board.board(kPeriod), table, kPeriod, &runner, nullptr};
    EXPECT_EQ(executive->start(setup), Status::kOk);
    ReplayComparer comparer;
    while (executive->run_tick() == Status::kOk) {
      comparer.compare(executive->inputs(), executive->outputs(), executive->hash(),
                       board.recorded());
    }
    result.ticks = comparer.ticks_compared();
    result.identical = comparer.identical();
    result.difference = comparer.difference();
    result.hash = executive->hash();
  }
  result.end = board.end();
  result.damage = board.damage();
  result.message = board.message();
  result.configuration = board.configuration();
  return result;
}

TEST(Replay, IsIdenticalWithLateTicksOverrunsAndDepth) {
  const ScratchFolder folder;
  const Recorded recorded = record_run(folder.file("r.mcap"));
  EXPECT_GT(recorded.overrun_ticks, 10u);
  const Replayed replayed = replay_run(folder.file("r.mcap"));
  EXPECT_EQ(replayed.opened, Status::kOk);
  EXPECT_EQ(replayed.configuration, kConfiguration);
  EXPECT_TRUE(replayed.identical) << replayed.difference.tick << " " << replayed.difference.field;
  EXPECT_EQ(replayed.ticks, kTicks);
  EXPECT_EQ(replayed.hash, recorded.hash);
  EXPECT_EQ(replayed.end, ReplayEnd::kComplete);
}

TEST(Replay, TwoRunsGiveTheSameRecord) {
  const ScratchFolder folder;
  EXPECT_EQ(record_run(folder.file("a.mcap")).hash, record_run(folder.file("b.mcap")).hash);
  EXPECT_EQ(testing::load(folder.file("a.mcap")), testing::load(folder.file("b.mcap")));
}

TEST(Replay, ChangedCodeIsFoundWithTickAndField) {
  const ScratchFolder folder;
  record_run(folder.file("r.mcap"));
  const Replayed replayed = replay_run(folder.file("r.mcap"), 123);
  EXPECT_FALSE(replayed.identical);
  EXPECT_EQ(replayed.difference.tick, 123u);
  EXPECT_EQ(replayed.difference.field, "outputs.telemetry.legs[2].foot_O_m[1]");
  EXPECT_EQ(replayed.difference.recorded, "0.25 (0x3fd0000000000000)");
  EXPECT_EQ(replayed.difference.replayed, "-0.125 (0xbfc0000000000000)");
  EXPECT_EQ(replayed.ticks, kTicks);  // compares on to the end
}

TEST(Replay, ACutRecordReplaysUpToTheCut) {
  const ScratchFolder folder;
  const std::string path = folder.file("r.mcap");
  record_run(path);
  const auto whole = std::filesystem::file_size(path);
  std::uint64_t last_ticks = kTicks;
  for (const double share : {0.95, 0.7, 0.4}) {
    const auto size = static_cast<std::uintmax_t>(share * static_cast<double>(whole));
    std::filesystem::resize_file(path, size);
    const Replayed replayed = replay_run(path);
    ASSERT_EQ(replayed.opened, Status::kOk);
    EXPECT_TRUE(replayed.identical);
    EXPECT_LT(replayed.ticks, last_ticks);
    EXPECT_GT(replayed.ticks, 0u);
    EXPECT_EQ(replayed.end, ReplayEnd::kDamaged);
    EXPECT_LE(replayed.damage.offset, size);
    EXPECT_NE(replayed.message.find("byte " + std::to_string(replayed.damage.offset)),
              std::string::npos)
        << replayed.message;
    last_ticks = replayed.ticks;
  }
  std::filesystem::resize_file(path, 300);  // nothing but a part of the head is left
  const Replayed nothing = replay_run(path);
  EXPECT_EQ(nothing.opened, Status::kCorrupt);
  EXPECT_NE(nothing.message.find("0 ticks before it"), std::string::npos) << nothing.message;
}

TEST(Replay, ACorruptedRecordReplaysUpToTheDamage) {
  const ScratchFolder folder;
  const std::string path = folder.file("r.mcap");
  record_run(path);
  auto bytes = testing::load(path);
  bytes[bytes.size() / 2] ^= 0x40;
  testing::save(path, bytes);
  const Replayed replayed = replay_run(path);
  EXPECT_TRUE(replayed.identical);
  EXPECT_GT(replayed.ticks, 0u);
  EXPECT_LT(replayed.ticks, kTicks);
  // Whole chunks of 100 ms; the first begins with the configuration, one tick earlier.
  EXPECT_EQ(replayed.ticks % 50, 49u);
  EXPECT_EQ(replayed.end, ReplayEnd::kDamaged);
  EXPECT_LE(replayed.damage.offset, bytes.size() / 2);
  EXPECT_EQ(replayed.damage.chunk, replayed.ticks / 50 + 1);
}

TEST(Replay, ALostTickStopsTheReplayThere) {
  const ScratchFolder folder;
  record_run(folder.file("r.mcap"), 150);
  const Replayed replayed = replay_run(folder.file("r.mcap"));
  EXPECT_TRUE(replayed.identical);
  EXPECT_EQ(replayed.ticks, 150u);
  EXPECT_EQ(replayed.end, ReplayEnd::kGap);
  EXPECT_NE(replayed.message.find("tick 150 is missing"), std::string::npos) << replayed.message;
}

TEST(Replay, WhatIsNoRecordIsRefused) {
  const ScratchFolder folder;
  EXPECT_EQ(replay_run(folder.file("none")).opened, Status::kUnavailable);
  testing::save(folder.file("text"), testing::Bytes(1000, 'x'));
  EXPECT_EQ(replay_run(folder.file("text")).opened, Status::kCorrupt);
}

TEST(ReplayComparer, NamesListsBytesAndTheHash) {
  auto record = std::make_unique<runtime::TickRecord>();
  CanFrame frame;
  frame.size = 3;
  ASSERT_EQ(record->outputs.can.push_back(frame), Status::kOk);
  record->hash = 1;
  auto outputs = record->outputs;
  {
    auto comparer = std::make_unique<ReplayComparer>();
    EXPECT_TRUE(comparer->compare(record->inputs, outputs, 1, *record));
    EXPECT_FALSE(comparer->compare(record->inputs, outputs, 2, *record));
    EXPECT_EQ(comparer->difference().field, "hash");
  }
  outputs.can[0].data[2] = 9;
  {
    auto comparer = std::make_unique<ReplayComparer>();
    EXPECT_FALSE(comparer->compare(record->inputs, outputs, 1, *record));
    EXPECT_EQ(comparer->difference().field, "outputs.can[0].data[2]");
    EXPECT_EQ(comparer->difference().replayed, "9");
  }
  outputs.can.clear();
  {
    auto comparer = std::make_unique<ReplayComparer>();
    EXPECT_FALSE(comparer->compare(record->inputs, outputs, 1, *record));
    EXPECT_EQ(comparer->difference().field, "outputs.can.size");
  }
}

TEST(SurefootRecord, SchemaListsEveryMemberOnceWithItsType) {
  const RecordLayout layout = surefoot_record_layout();
  const auto text = [&](RecordChannel channel) {
    for (const auto& info : layout) {
      if (info.channel == channel) return info.schema_text;
    }
    return std::string();
  };
  const std::string tick = text(RecordChannel::kTick);
  const auto has = [](const std::string& where, const std::string& line) {
    return where.find("\n" + line + "\n") != std::string::npos;
  };
  EXPECT_TRUE(has(tick, "inputs.tick uint64")) << tick;
  EXPECT_TRUE(has(tick, "inputs.can.count uint32")) << tick;
  EXPECT_TRUE(has(tick, "inputs.can[*].data uint8")) << tick;
  EXPECT_TRUE(has(tick, "inputs.imu[*].angular_velocity_I_rad_s[3] float64")) << tick;
  EXPECT_TRUE(has(tick, "inputs.operator_command.forward_m_s float64")) << tick;
  EXPECT_TRUE(has(tick, "outputs.telemetry.legs[4].foot_O_m[3] float64")) << tick;
  EXPECT_TRUE(has(tick, "hash uint64")) << tick;
  const std::string depth = text(RecordChannel::kDepth);
  EXPECT_TRUE(has(depth, "intrinsics.fx_px float64")) << depth;
  EXPECT_TRUE(has(depth, "depth uint16")) << depth;
}

}  // namespace
}  // namespace surefoot::hal
