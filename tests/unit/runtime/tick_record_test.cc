#include "core/runtime/tick_record.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace surefoot::runtime {
namespace {

// Every list at its capacity, every optional part present.
void fill(TickRecord& record) {
  hal::CanFrame frame;
  frame.size = 64;
  frame.data.fill(0xA5);
  while (ok(record.inputs.can.push_back(frame))) {
  }
  while (ok(record.outputs.can.push_back(frame))) {
  }
  while (ok(record.inputs.imu.push_back({}))) {
  }
  while (ok(record.inputs.pose.push_back({}))) {
  }
  record.inputs.operator_fresh = true;
  record.hash = 0x0123456789abcdefull;
}

std::vector<std::uint8_t> encode(const TickRecord& record) {
  std::vector<std::uint8_t> bytes(kMaxTickBytes);
  FieldWriter writer(bytes);
  writer.members(record);
  EXPECT_EQ(writer.status(), Status::kOk);
  bytes.resize(writer.size());
  return bytes;
}

TEST(TickRecord, TheFullestTickFitsAndComesBack) {
  auto record = std::make_unique<TickRecord>();
  fill(*record);
  const auto bytes = encode(*record);
  auto decoded = std::make_unique<TickRecord>();
  ASSERT_EQ(decode_tick(bytes, *decoded), Status::kOk);
  EXPECT_EQ(encode(*decoded), bytes);
}

TEST(TickRecord, WrongLengthsAreCorrupt) {
  auto record = std::make_unique<TickRecord>();
  auto bytes = encode(*record);
  auto decoded = std::make_unique<TickRecord>();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(decode_tick(std::span(bytes).first(size), *decoded), Status::kCorrupt);
  }
  bytes.push_back(0);
  EXPECT_EQ(decode_tick(bytes, *decoded), Status::kCorrupt);
}

TEST(TickRecord, DepthFastPathWritesCanonicalBytes) {
  auto frame = std::make_unique<hal::DepthFrame>();
  frame->stamp = milliseconds(77);
  frame->sequence = 9;
  frame->intrinsics = {640, 480, 385.5, 386.5, 320.25, 240.75};
  for (std::size_t i = 0; i < frame->depth.size(); ++i) {
    frame->depth[i] = static_cast<std::uint16_t>(i * 7919);
  }
  std::vector<std::uint8_t> canonical(kMaxDepthBytes);
  FieldWriter writer(canonical);
  writer.members(*frame);
  ASSERT_EQ(writer.status(), Status::kOk);
  std::vector<std::uint8_t> fast(kMaxDepthBytes);
  std::size_t size = 0;
  ASSERT_EQ(encode_depth(*frame, fast, size), Status::kOk);
  EXPECT_EQ(size, writer.size());
  EXPECT_EQ(fast, canonical);
  auto decoded = std::make_unique<hal::DepthFrame>();
  ASSERT_EQ(decode_depth(std::span(fast).first(size), *decoded), Status::kOk);
  EXPECT_EQ(decoded->depth, frame->depth);
  EXPECT_EQ(decode_depth(std::span(fast).first(size - 1), *decoded), Status::kCorrupt);
}

TEST(TickRecord, StereoFastPathWritesCanonicalBytes) {
  auto frame = std::make_unique<hal::StereoFrame>();
  frame->stamp = milliseconds(78);
  frame->sequence = 10;
  frame->width_px = 1024;
  frame->height_px = 768;
  for (std::size_t i = 0; i < frame->left.size(); ++i) {
    frame->left[i] = static_cast<std::uint8_t>(i * 7919);
    frame->right[i] = static_cast<std::uint8_t>(i * 104729);
  }
  std::vector<std::uint8_t> canonical(kMaxStereoBytes);
  FieldWriter writer(canonical);
  writer.members(*frame);
  ASSERT_EQ(writer.status(), Status::kOk);
  std::vector<std::uint8_t> fast(kMaxStereoBytes);
  std::size_t size = 0;
  ASSERT_EQ(encode_stereo(*frame, fast, size), Status::kOk);
  EXPECT_EQ(size, writer.size());
  EXPECT_EQ(fast, canonical);
  auto decoded = std::make_unique<hal::StereoFrame>();
  ASSERT_EQ(decode_stereo(std::span(fast).first(size), *decoded), Status::kOk);
  EXPECT_EQ(decoded->left, frame->left);
  EXPECT_EQ(decoded->right, frame->right);
  EXPECT_EQ(decode_stereo(std::span(fast).first(size - 1), *decoded), Status::kCorrupt);
  frame->height_px = 769;
  EXPECT_EQ(encode_stereo(*frame, fast, size), Status::kInvalid);
}

TEST(TickRecord, LidarFastPathWritesCanonicalBytes) {
  hal::LidarScan scan;
  scan.stamp = milliseconds(79);
  scan.beam_interval = microseconds(37);
  scan.sequence = 11;
  scan.beam_count = hal::kMaxLidarBeams;
  scan.first_angle_rad = -1.5f;
  scan.angle_step_rad = 0.01f;
  for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
    scan.range_m[i] = 0.25f * static_cast<float>(i);
  }
  std::vector<std::uint8_t> canonical(kMaxLidarBytes);
  FieldWriter writer(canonical);
  writer.members(scan);
  ASSERT_EQ(writer.status(), Status::kOk);
  std::vector<std::uint8_t> fast(kMaxLidarBytes);
  std::size_t size = 0;
  ASSERT_EQ(encode_lidar(scan, fast, size), Status::kOk);
  EXPECT_EQ(size, writer.size());
  EXPECT_EQ(fast, canonical);
  hal::LidarScan decoded;
  ASSERT_EQ(decode_lidar(std::span(fast).first(size), decoded), Status::kOk);
  EXPECT_EQ(decoded.range_m, scan.range_m);
  EXPECT_EQ(decoded.beam_interval.ns, scan.beam_interval.ns);
  EXPECT_EQ(decode_lidar(std::span(fast).first(size - 1), decoded), Status::kCorrupt);
  scan.beam_count = hal::kMaxLidarBeams + 1;
  EXPECT_EQ(encode_lidar(scan, fast, size), Status::kInvalid);
}

TEST(TickRecord, ImpossibleDepthSizesAreRefused) {
  auto frame = std::make_unique<hal::DepthFrame>();
  std::vector<std::uint8_t> bytes(kMaxDepthBytes);
  std::size_t size = 0;
  frame->intrinsics.width_px = 65535;
  frame->intrinsics.height_px = 65535;
  EXPECT_EQ(encode_depth(*frame, bytes, size), Status::kInvalid);
  frame->intrinsics.width_px = 10;
  frame->intrinsics.height_px = 10;
  EXPECT_EQ(encode_depth(*frame, std::span(bytes).first(100), size), Status::kExhausted);
}

}  // namespace
}  // namespace surefoot::runtime
