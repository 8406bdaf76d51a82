#include "core/actuation/motor_protocol.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "tests/support/samples.h"

namespace surefoot::actuation {
namespace {

constexpr WireRanges kMiniCheetah{12.5, 45.0, 500.0, 5.0, 18.0};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Every table of research/locomotion.md section 2.
const std::vector<WireRanges> kAllRanges = {
    kMiniCheetah,
    {12.5, 65.0, 500.0, 5.0, 18.0},   // motorcontrol v2
    {95.5, 45.0, 500.0, 5.0, 18.0},   // AK80-6 V1.0
    {12.5, 22.5, 500.0, 5.0, 12.0},   // AK80-6 V1.1
    {12.5, 38.2, 500.0, 5.0, 12.0},   // AK80-6 V2
    {12.5, 76.0, 500.0, 5.0, 12.0},   // AK80-6 in the T-Motor library
    {12.5, 25.64, 500.0, 5.0, 18.0},  // AK80-9 V2
    {12.5, 50.0, 500.0, 5.0, 65.0},   // AK10-9
    {12.5, 8.0, 500.0, 5.0, 144.0},   // AK80-64
};

CommandBytes bytes_of(const WireRanges& ranges, const DriveCommand& command) {
  CommandBytes bytes{};
  EXPECT_TRUE(ok(encode_command(ranges, command, bytes)));
  return bytes;
}

bool is_special(const CommandBytes& bytes) {
  const Result<FrameKind> kind = classify(bytes);
  return !kind.ok() || kind.value() != FrameKind::kCommand;
}

TEST(MotorProtocol, EveryCodeOfEveryFieldSurvivesDecodeAndEncode) {
  for (const WireRanges& r : kAllRanges) {
    for (std::uint32_t code = 0; code < 65536; ++code) {
      const double x = decode_field(code, -r.position_rad, r.position_rad, 16);
      ASSERT_EQ(encode_field(x, -r.position_rad, r.position_rad, 16), code) << r.position_rad;
    }
    for (std::uint32_t code = 0; code < 4096; ++code) {
      for (const double span : {r.velocity_rad_s, r.torque_Nm}) {
        ASSERT_EQ(encode_field(decode_field(code, -span, span, 12), -span, span, 12), code) << span;
      }
      for (const double span : {r.kp_max_Nm_rad, r.kd_max_Nm_s_rad}) {
        ASSERT_EQ(encode_field(decode_field(code, 0.0, span, 12), 0.0, span, 12), code) << span;
      }
    }
  }
}

// Frames made from codes by hand, in the layout of the protocol, decode and encode to themselves.
TEST(MotorProtocol, CommandFramesRoundTripBitForBit) {
  Random random(1);
  for (int i = 0; i < 200'000; ++i) {
    CommandBytes bytes{};
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.next_u32());
    if (i < 65536) {  // all position codes
      bytes[0] = static_cast<std::uint8_t>(i >> 8);
      bytes[1] = static_cast<std::uint8_t>(i);
    }
    const Result<DriveCommand> command = decode_command(kMiniCheetah, bytes);
    ASSERT_TRUE(command.ok());
    ASSERT_EQ(bytes_of(kMiniCheetah, command.value()), bytes);
  }
}

TEST(MotorProtocol, ReplyFramesRoundTripBitForBit) {
  Random random(2);
  for (int i = 0; i < 200'000; ++i) {
    std::array<std::uint8_t, 8> bytes{};
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.next_u32());
    if (i < 65536) {
      bytes[1] = static_cast<std::uint8_t>(i >> 8);
      bytes[2] = static_cast<std::uint8_t>(i);
    }
    const std::size_t size = 6 + random.below(3);
    const Result<Reply> reply = decode_reply(kMiniCheetah, std::span(bytes).first(size));
    ASSERT_TRUE(reply.ok());
    const Result<ReplyBytes> again = encode_reply(kMiniCheetah, reply.value());
    ASSERT_TRUE(again.ok());
    ASSERT_EQ(again.value().size, size);
    ASSERT_EQ(std::memcmp(again.value().data.data(), bytes.data(), size), 0);
  }
}

// The layout itself, against frames worked out by hand.
TEST(MotorProtocol, FieldsLieWhereTheFirmwareReadsThem) {
  const CommandBytes zero = bytes_of(kMiniCheetah, {});
  EXPECT_EQ(zero, (CommandBytes{0x7F, 0xFF, 0x7F, 0xF0, 0x00, 0x00, 0x07, 0xFF}));
  const CommandBytes position = bytes_of(kMiniCheetah, {.position_rad = 12.5});
  EXPECT_EQ(position, (CommandBytes{0xFF, 0xFF, 0x7F, 0xF0, 0x00, 0x00, 0x07, 0xFF}));
  const CommandBytes velocity = bytes_of(kMiniCheetah, {.velocity_rad_s = 45.0});
  EXPECT_EQ(velocity, (CommandBytes{0x7F, 0xFF, 0xFF, 0xF0, 0x00, 0x00, 0x07, 0xFF}));
  const CommandBytes kp = bytes_of(kMiniCheetah, {.kp_Nm_rad = 500.0});
  EXPECT_EQ(kp, (CommandBytes{0x7F, 0xFF, 0x7F, 0xFF, 0xFF, 0x00, 0x07, 0xFF}));
  const CommandBytes kd = bytes_of(kMiniCheetah, {.kd_Nm_s_rad = 5.0});
  EXPECT_EQ(kd, (CommandBytes{0x7F, 0xFF, 0x7F, 0xF0, 0x00, 0xFF, 0xF7, 0xFF}));
  const CommandBytes torque = bytes_of(kMiniCheetah, {.torque_Nm = -18.0});
  EXPECT_EQ(torque, (CommandBytes{0x7F, 0xFF, 0x7F, 0xF0, 0x00, 0x00, 0x00, 0x00}));
}

// Truncation: the decoded value is the asked one or at most one step below, never above by more
// than the guard.
TEST(MotorProtocol, CodesTruncate) {
  Random random(3);
  const double step = 36.0 / 4095.0;
  for (int i = 0; i < 100'000; ++i) {
    const double asked = random.uniform(-18.0, 18.0);
    const double got = decode_field(encode_field(asked, -18.0, 18.0, 12), -18.0, 18.0, 12);
    ASSERT_LE(got, asked + step * 0x1p-15);
    ASSERT_GT(got, asked - step);
  }
}

// The mean error of what the drive measured: half a code as decoded, none once centred.
TEST(MotorProtocol, CentredRepliesHaveNoMeanError) {
  Random random(4);
  constexpr int kReplies = 100'000;
  double decoded_error_rad_s = 0;
  Reply centred_error;
  for (int i = 0; i < kReplies; ++i) {
    Reply sent;
    sent.position_rad = random.uniform(-12.0, 12.0);
    sent.velocity_rad_s = random.uniform(-40.0, 40.0);
    sent.torque_Nm = random.uniform(-17.0, 17.0);
    const Result<ReplyBytes> bytes = encode_reply(kMiniCheetah, sent);
    ASSERT_TRUE(bytes.ok());
    const Result<Reply> decoded = decode_reply(kMiniCheetah, bytes.value().bytes());
    ASSERT_TRUE(decoded.ok());
    const Reply read = centred(kMiniCheetah, decoded.value());
    decoded_error_rad_s += (decoded.value().velocity_rad_s - sent.velocity_rad_s) / kReplies;
    centred_error.position_rad += (read.position_rad - sent.position_rad) / kReplies;
    centred_error.velocity_rad_s += (read.velocity_rad_s - sent.velocity_rad_s) / kReplies;
    centred_error.torque_Nm += (read.torque_Nm - sent.torque_Nm) / kReplies;
  }
  // A mean over 10^5 draws is within 0.001 of a step, one sigma.
  const double step_rad_s = 90.0 / 4095.0;
  EXPECT_NEAR(decoded_error_rad_s, -0.5 * step_rad_s, 0.01 * step_rad_s);
  EXPECT_NEAR(centred_error.velocity_rad_s, 0.0, 0.01 * step_rad_s);
  EXPECT_NEAR(centred_error.position_rad, 0.0, 0.01 * 25.0 / 65535.0);
  EXPECT_NEAR(centred_error.torque_Nm, 0.0, 0.01 * 36.0 / 4095.0);
}

TEST(MotorProtocol, ZeroTorqueIsHalfAStepBelowZero) {
  const Result<DriveCommand> limp = decode_command(kMiniCheetah, bytes_of(kMiniCheetah, {}));
  ASSERT_TRUE(limp.ok());
  EXPECT_EQ(limp.value().kp_Nm_rad, 0.0);
  EXPECT_EQ(limp.value().kd_Nm_s_rad, 0.0);
  EXPECT_NEAR(limp.value().torque_Nm, -0.5 * 36.0 / 4095.0, 1e-12);
}

TEST(MotorProtocol, ValuesBeyondTheRangeAreClampedAndDoNotAlias) {
  const DriveCommand huge{1e9, 1e9, 1e9, 0.0, -1e9};
  const Result<DriveCommand> high = decode_command(kMiniCheetah, bytes_of(kMiniCheetah, huge));
  ASSERT_TRUE(high.ok());
  EXPECT_DOUBLE_EQ(high.value().position_rad, 12.5);
  EXPECT_DOUBLE_EQ(high.value().velocity_rad_s, 45.0);
  EXPECT_DOUBLE_EQ(high.value().kp_Nm_rad, 500.0);
  EXPECT_DOUBLE_EQ(high.value().torque_Nm, -18.0);
  const DriveCommand low{-1e9, -1e9, -1e9, -1e9, 1e9};
  const Result<DriveCommand> other = decode_command(kMiniCheetah, bytes_of(kMiniCheetah, low));
  ASSERT_TRUE(other.ok());
  EXPECT_DOUBLE_EQ(other.value().position_rad, -12.5);
  EXPECT_DOUBLE_EQ(other.value().velocity_rad_s, -45.0);
  EXPECT_EQ(other.value().kp_Nm_rad, 0.0);
  EXPECT_EQ(other.value().kd_Nm_s_rad, 0.0);
  EXPECT_DOUBLE_EQ(other.value().torque_Nm, 18.0);
}

TEST(MotorProtocol, NotFiniteIsRefusedAndNothingIsWritten) {
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    for (int field = 0; field < 5; ++field) {
      DriveCommand command;
      if (field == 0) command.position_rad = bad;
      if (field == 1) command.velocity_rad_s = bad;
      if (field == 2) command.kp_Nm_rad = bad;
      if (field == 3) command.kd_Nm_s_rad = bad;
      if (field == 4) command.torque_Nm = bad;
      CommandBytes bytes;
      bytes.fill(0xA5);
      EXPECT_EQ(encode_command(kMiniCheetah, command, bytes), Status::kInvalid);
      for (const std::uint8_t byte : bytes) EXPECT_EQ(byte, 0xA5);
    }
    EXPECT_FALSE(encode_reply(kMiniCheetah, {.position_rad = bad}).ok());
    WireRanges ranges = kMiniCheetah;
    ranges.torque_Nm = bad;
    CommandBytes bytes{};
    EXPECT_EQ(encode_command(ranges, {}, bytes), Status::kInvalid);
  }
}

// Special frames need seven bytes 0xFF, so p, v, kp and kd at their last code and t at 0xF00 or
// above. Only t is free there: walking all of its codes walks every command that could alias.
TEST(MotorProtocol, NoSaturatedCommandAliasesASpecialFrame) {
  for (const WireRanges& r : kAllRanges) {
    int corrected = 0;
    for (std::uint32_t t = 0; t < 4096; ++t) {
      const double torque = decode_field(t, -r.torque_Nm, r.torque_Nm, 12);
      const DriveCommand asked{r.position_rad, r.velocity_rad_s, r.kp_max_Nm_rad, r.kd_max_Nm_s_rad,
                               torque};
      const CommandBytes bytes = bytes_of(r, asked);
      ASSERT_FALSE(is_special(bytes)) << t;
      const Result<DriveCommand> got = decode_command(r, bytes);
      ASSERT_TRUE(got.ok());
      EXPECT_DOUBLE_EQ(got.value().torque_Nm, torque);
      EXPECT_DOUBLE_EQ(got.value().position_rad, r.position_rad);
      const double step = r.kd_max_Nm_s_rad / 4095.0;
      EXPECT_NEAR(got.value().kd_Nm_s_rad,
                  t >= 0xF00 ? r.kd_max_Nm_s_rad - step : r.kd_max_Nm_s_rad, 1e-12);
      if (t >= 0xF00) ++corrected;
    }
    EXPECT_EQ(corrected, 256);
  }
}

TEST(MotorProtocol, NoRandomCommandAliasesASpecialFrame) {
  Random random(4);
  const auto draw = [&random](double range) {  // half of the draws saturate
    const double x = random.uniform(-2.0 * range, 3.0 * range);
    return x;
  };
  for (int i = 0; i < tests::samples(10'000'000, 500'000); ++i) {
    DriveCommand command;
    command.position_rad = draw(12.5);
    command.velocity_rad_s = draw(45.0);
    command.kp_Nm_rad = draw(500.0);
    command.kd_Nm_s_rad = draw(5.0);
    command.torque_Nm = draw(18.0);
    CommandBytes bytes;
    if (!ok(encode_command(kMiniCheetah, command, bytes)) || is_special(bytes)) {
      FAIL() << "draw " << i;
    }
  }
}

TEST(MotorProtocol, SpecialFramesAreRecognisedAndAreNotCommands) {
  for (const FrameKind kind :
       {FrameKind::kEnterMotorMode, FrameKind::kExitMotorMode, FrameKind::kSetZero}) {
    const CommandBytes bytes = encode_special(kind);
    const Result<FrameKind> found = classify(bytes);
    ASSERT_TRUE(found.ok());
    EXPECT_EQ(found.value(), kind);
    EXPECT_EQ(decode_command(kMiniCheetah, bytes).status(), Status::kInvalid);
  }
  EXPECT_EQ(encode_special(FrameKind::kEnterMotorMode)[7], 0xFC);
  EXPECT_EQ(encode_special(FrameKind::kExitMotorMode)[7], 0xFD);
  EXPECT_EQ(encode_special(FrameKind::kSetZero)[7], 0xFE);
}

TEST(MotorProtocol, WrongLengthsAreRefused) {
  const std::array<std::uint8_t, 16> bytes{1};
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    const std::span<const std::uint8_t> part = std::span(bytes).first(size);
    const bool reply = size >= 6 && size <= 8;
    EXPECT_EQ(decode_reply(kMiniCheetah, part).ok(), reply) << size;
    EXPECT_EQ(reply_drive_id(part).ok(), reply) << size;
    EXPECT_EQ(decode_command(kMiniCheetah, part).ok(), size == 8) << size;
    EXPECT_EQ(classify(part).ok(), size == 8) << size;
  }
}

TEST(MotorProtocol, RepliesOfSixSevenAndEightBytes) {
  const std::array<std::uint8_t, 8> bytes{3, 0x7F, 0xFF, 0x7F, 0xF7, 0xFF, 153, 4};
  const Result<Reply> six = decode_reply(kMiniCheetah, std::span(bytes).first(6));
  const Result<Reply> seven = decode_reply(kMiniCheetah, std::span(bytes).first(7));
  const Result<Reply> eight = decode_reply(kMiniCheetah, bytes);
  for (const Result<Reply>& reply : {six, seven, eight}) {
    ASSERT_TRUE(reply.ok());
    EXPECT_EQ(reply.value().drive_id, 3);
    EXPECT_NEAR(reply.value().position_rad, -12.5 / 65535.0, 1e-12);
    EXPECT_NEAR(reply.value().velocity_rad_s, -45.0 / 4095.0, 1e-12);
    EXPECT_NEAR(reply.value().torque_Nm, -18.0 / 4095.0, 1e-12);
  }
  EXPECT_FALSE(six.value().has_voltage || six.value().has_health);
  EXPECT_TRUE(seven.value().has_voltage && !seven.value().has_health);
  EXPECT_NEAR(seven.value().voltage_V, 24.0, 1e-12);
  EXPECT_TRUE(eight.value().has_health && !eight.value().has_voltage);
  EXPECT_EQ(eight.value().temperature_code, 153);
  EXPECT_EQ(eight.value().error, DriveError::kUnderVoltage);
}

// The ranges are configuration because they matter: one frame means different things.
TEST(MotorProtocol, RangesDecideWhatAFrameMeans) {
  const CommandBytes bytes = bytes_of(kMiniCheetah, {.velocity_rad_s = 10.0});
  const Result<DriveCommand> v2 = decode_command(kAllRanges[1], bytes);
  ASSERT_TRUE(v2.ok());
  EXPECT_NEAR(v2.value().velocity_rad_s, 10.0 * 65.0 / 45.0, 65.0 * 2 / 4095.0);
}

}  // namespace
}  // namespace surefoot::actuation
