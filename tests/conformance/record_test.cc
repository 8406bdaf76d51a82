// Records and replay against the rules of the HAL interfaces.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/base/fields.h"
#include "core/runtime/tick_record.h"
#include "hal/record/record_reader.h"
#include "hal/record/record_writer.h"
#include "hal/replay/replay_board.h"
#include "hal/replay/surefoot_record.h"
#include "tests/conformance/can_port_rules.h"
#include "tests/conformance/clock_rules.h"
#include "tests/conformance/record_sink_rules.h"
#include "tests/conformance/sensor_rules.h"

namespace surefoot::conformance {
namespace {

constexpr TimeNs kPeriod = milliseconds(2);
constexpr int kTicks = 200;

class TemporaryRecord {
 public:
  TemporaryRecord()
      : path_(testing::TempDir() + "surefoot_conformance_" + std::to_string(::getpid()) + "_" +
              testing::UnitTest::GetInstance()->current_test_info()->name() + ".mcap") {}
  ~TemporaryRecord() { std::filesystem::remove(path_); }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

class WriterBench final : public RecordSinkBench {
 public:
  explicit WriterBench(hal::WhenFull when_full) {
    hal::RecordLayout layout = hal::surefoot_record_layout();
    layout.push_back({hal::RecordChannel::kLidar, "/lidar", "x-test", "", "", ""});
    std::erase_if(layout, [&layout](const hal::RecordChannelInfo& info) {  // one lidar at most
      return info.channel == hal::RecordChannel::kLidar && &info != &layout.back();
    });
    EXPECT_EQ(writer_.open(file_.path(), layout, {.when_full = when_full}), Status::kOk);
  }
  hal::RecordSink& sink() override { return writer_; }
  std::vector<StoredMessage> stored() override {
    EXPECT_EQ(writer_.close(), Status::kOk) << writer_.error();
    hal::RecordReader reader;
    EXPECT_EQ(reader.open(file_.path()), Status::kOk);
    std::vector<StoredMessage> all;
    hal::RecordMessage message;
    while (ok(reader.next(message))) {
      all.push_back({message.channel, message.stamp, {message.bytes.begin(), message.bytes.end()}});
    }
    return all;
  }

 private:
  TemporaryRecord file_;
  hal::RecordWriter writer_;
};

TEST(Record, BlockingWriterKeepsTheRules) {
  WriterBench bench(hal::WhenFull::kBlock);
  EXPECT_EQ(joined(record_sink_violations(bench)), "");
}

TEST(Record, DroppingWriterKeepsTheRules) {
  WriterBench bench(hal::WhenFull::kDrop);
  EXPECT_EQ(joined(record_sink_violations(bench)), "");
}

// Two frames of each bus, two IMU samples, a pose, a command and a depth frame in every tick.
void fill(std::uint32_t number, autonomy::TickInputs& inputs) {
  inputs.tick = number;
  inputs.stamp = milliseconds(100) + kPeriod * number;
  for (std::uint32_t i = 0; i < 8; ++i) {
    hal::CanFrame frame;
    frame.stamp = inputs.stamp - microseconds(100 - i / 4);
    frame.bus = static_cast<std::uint8_t>(i % 4);
    frame.size = 4;
    for (unsigned byte = 0; byte < 4; ++byte) {
      frame.data[byte] = static_cast<std::uint8_t>((number * 2 + i / 4) >> (8 * byte));
    }
    ASSERT_TRUE(ok(inputs.can.push_back(frame)));
  }
  for (std::uint32_t i = 0; i < 2; ++i) {
    hal::ImuSample sample;
    sample.sequence = number * 2 + i;
    sample.stamp = inputs.stamp - microseconds(1500 - 1000 * i);
    ASSERT_TRUE(ok(inputs.imu.push_back(sample)));
  }
  hal::PoseSample pose;
  pose.sequence = number;
  pose.stamp = inputs.stamp;
  ASSERT_TRUE(ok(inputs.pose.push_back(pose)));
  inputs.operator_fresh = true;
  inputs.operator_command.sequence = number;
  inputs.operator_command.stamp = inputs.stamp;
  inputs.depth_fresh = true;
  inputs.stereo_fresh = true;
}

template <class Fields>
void write(hal::RecordSink& sink, hal::RecordChannel channel, TimeNs stamp, const Fields& value) {
  std::vector<std::uint8_t> bytes(runtime::kMaxTickBytes);
  FieldWriter writer(bytes);
  writer.members(value);
  ASSERT_EQ(writer.status(), Status::kOk);
  ASSERT_EQ(sink.write(channel, stamp, std::span(bytes).first(writer.size())), Status::kOk);
}

void write_run(const std::string& path) {
  hal::RecordWriter writer;
  ASSERT_EQ(writer.open(path, hal::surefoot_record_layout()), Status::kOk);
  const std::vector<std::uint8_t> configuration{'a', ':', ' ', '1', '\n'};
  ASSERT_EQ(writer.write(hal::RecordChannel::kConfiguration, {}, configuration), Status::kOk);
  auto depth = std::make_unique<hal::DepthFrame>();
  depth->intrinsics = {.width_px = 4, .height_px = 3, .fx_px = 5, .fy_px = 5};
  auto stereo = std::make_unique<hal::StereoFrame>();
  stereo->width_px = 20;
  stereo->height_px = 16;
  for (std::uint32_t number = 0; number < kTicks; ++number) {
    auto tick = std::make_unique<runtime::TickRecord>();
    fill(number, tick->inputs);
    depth->sequence = number;
    depth->stamp = tick->inputs.stamp;
    write(writer, hal::RecordChannel::kDepth, depth->stamp, *depth);
    stereo->sequence = number;
    stereo->stamp = tick->inputs.stamp;
    write(writer, hal::RecordChannel::kStereo, stereo->stamp, *stereo);
    write(writer, hal::RecordChannel::kTick, tick->inputs.stamp, *tick);
  }
  ASSERT_EQ(writer.close(), Status::kOk) << writer.error();
}

class Recording {
 public:
  Recording() {
    write_run(file_.path());
    EXPECT_EQ(replay_.open(file_.path()), Status::kOk) << replay_.message();
    board_ = replay_.board(kPeriod);
  }
  const hal::Board& board() const { return board_; }
  bool next_tick() {
    return board_.clock->wait_until(board_.clock->now() + kPeriod) != Status::kEndOfData;
  }

 private:
  TemporaryRecord file_;
  hal::ReplayBoard replay_;
  hal::Board board_;
};

// A recorded tick brings what it brings; the executive takes it all before the next one.
class ReplayCanBench final : public CanBench {
 public:
  hal::CanPort& port() override { return *recording_.board().can; }
  std::size_t arrive(std::uint8_t bus, std::size_t) override {
    return bus == 0 && recording_.next_tick() ? 8 : 0;
  }
  std::int64_t number_of(const hal::CanFrame& frame) const override {
    std::int64_t number = 0;
    for (unsigned byte = 4; byte > 0; --byte) number = number * 256 + frame.data[byte - 1];
    return number;
  }
  bool sends() const override { return false; }
  std::size_t bus_count() const override { return 4; }

 private:
  Recording recording_;
};

template <class Bench>
class ReplayBench final : public Bench {
 public:
  ReplayBench(typename Bench::Port* hal::Board::*port, std::size_t per_tick)
      : port_(port), per_tick_(per_tick) {}
  typename Bench::Port& port() override { return *(recording_.board().*port_); }
  std::size_t arrive(std::size_t) override { return recording_.next_tick() ? per_tick_ : 0; }

 private:
  Recording recording_;
  typename Bench::Port* hal::Board::*port_;
  std::size_t per_tick_;
};

TEST(Replay, CanPortKeepsTheRules) {
  ReplayCanBench bench;
  EXPECT_EQ(joined(can_port_violations(bench)), "");
}

TEST(Replay, ImuPortKeepsTheRules) {
  ReplayBench<ImuBench> bench(&hal::Board::imu, 2);
  EXPECT_EQ(joined(sensor_violations<ImuBench>(bench)), "");
}

TEST(Replay, PosePortKeepsTheRules) {
  ReplayBench<PoseBench> bench(&hal::Board::pose, 1);
  EXPECT_EQ(joined(sensor_violations<PoseBench>(bench)), "");
}

TEST(Replay, DepthCameraPortKeepsTheRules) {
  ReplayBench<DepthBench> bench(&hal::Board::depth_camera, 1);
  EXPECT_EQ(joined(sensor_violations<DepthBench>(bench)), "");
}

// What comes of a trigger is in the record, at its tick.
class ReplayStereoBench final : public StereoBench {
 public:
  hal::StereoCameraPort& port() override { return *recording_.board().stereo_camera; }
  std::size_t arrive(std::size_t) override { return recording_.next_tick() ? 1 : 0; }

 private:
  Recording recording_;
};

TEST(Replay, StereoCameraPortKeepsTheRules) {
  ReplayStereoBench bench;
  EXPECT_EQ(joined(sensor_violations<StereoBench>(bench)), "");
}

TEST(Replay, OperatorPortKeepsTheRules) {
  ReplayBench<OperatorBench> bench(&hal::Board::operator_port, 1);
  EXPECT_EQ(joined(operator_violations(bench)), "");
}

TEST(Replay, ClockKeepsTheRulesAndEnds) {
  const Recording recording;
  const ClockBench bench{.clock = recording.board().clock,
                         .period = kPeriod,
                         .ticks = kTicks + 10,
                         .allowed_overshoot = {0},
                         .asks_for_late = false};
  EXPECT_EQ(joined(clock_violations(bench)), "");
}

TEST(Replay, GrantsEveryRecordedTickOnce) {
  Recording recording;
  int ticks = 0;
  while (recording.next_tick()) ++ticks;
  EXPECT_EQ(ticks, kTicks);
}

}  // namespace
}  // namespace surefoot::conformance
