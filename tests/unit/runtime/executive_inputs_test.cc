// What the executive latches from the devices, and what it hands back to them.
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <vector>

#include "tests/unit/runtime/logged_task.h"

namespace surefoot::runtime {
namespace {

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

TEST_F(ExecutiveTest, RecordsTheLaserScanBeforeItsTickAndHashesIt) {
  std::vector<std::uint64_t> hashes;
  for (const float range_m : {7.0f, 7.5f}) {
    board_.clock = {};
    board_.record.messages.clear();
    board_.lidar.scan.beam_count = 3;
    board_.lidar.scan.range_m[2] = range_m;
    board_.lidar.waiting = 1;
    start({control_.row(1, 0, 0)});
    tick();
    EXPECT_TRUE(executive_->inputs().lidar_fresh);
    ASSERT_EQ(board_.record.messages.size(), 2u);
    EXPECT_EQ(board_.record.messages[0].channel, hal::RecordChannel::kLidar);
    hal::LidarScan scan;
    ASSERT_EQ(decode_lidar(board_.record.messages[0].bytes, scan), Status::kOk);
    EXPECT_EQ(scan.range_m[2], range_m);
    hashes.push_back(executive_->hash());
    tick();
    EXPECT_FALSE(executive_->inputs().lidar_fresh);
    EXPECT_EQ(executive_->inputs().lidar, nullptr);
  }
  EXPECT_NE(hashes[0], hashes[1]);
}

TEST_F(ExecutiveTest, AScanLargerThanTheCapacityIsIgnoredAndCounted) {
  board_.lidar.scan.beam_count = hal::kMaxLidarBeams + 1;
  board_.lidar.waiting = 1;
  start({control_.row(1, 0, 0)});
  tick();
  EXPECT_FALSE(executive_->inputs().lidar_fresh);
  EXPECT_EQ(executive_->counters().lidar_invalid, 1u);
}

TEST_F(ExecutiveTest, LatchesGaitSamplesAndSendsTheGaitCommandOfTheTick) {
  Task walk = control_.row(2, 0, 0);
  walk.publish = [](void*, autonomy::TickOutputs& outputs) { outputs.gait.walk = true; };
  start({walk});
  hal::GaitSample sample;
  for (std::size_t i = 0; i < autonomy::kMaxGaitSamplesPerTick + 3; ++i) {
    sample.sequence = static_cast<std::uint32_t>(i);
    board_.gait.push(sample);
  }
  tick();
  ASSERT_EQ(executive_->inputs().gait.size(), autonomy::kMaxGaitSamplesPerTick);
  EXPECT_EQ(executive_->inputs().gait[0].sequence, 3u);
  EXPECT_EQ(executive_->counters().gait_dropped, 3u);
  board_.gait.refuse = true;
  tick();
  EXPECT_TRUE(executive_->inputs().gait.empty());
  ASSERT_EQ(board_.gait.sent.size(), 2u);
  EXPECT_TRUE(board_.gait.sent[0].walk);
  EXPECT_FALSE(board_.gait.sent[1].walk) << "not held from the tick before";
  EXPECT_EQ(executive_->counters().sends_refused, 1u);
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

}  // namespace
}  // namespace surefoot::runtime
