#include "core/actuation/joint_bus.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace surefoot::actuation {
namespace {

using hal::CanFrame;
using Frames = FixedVector<CanFrame, 64>;

constexpr double kBelt = 1.5549;

// One leg per bus, ids 1..3, knees behind a belt, directions mixed.
robot::RobotModel test_robot() {
  robot::RobotModel model;
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    robot::JointWiring& w = model.wiring[joint];
    const bool knee = joint % 3 == 2;
    w.bus = static_cast<std::uint8_t>(joint / 3);
    w.can_id = static_cast<std::uint16_t>(joint % 3 + 1);
    w.direction = joint % 2 == 0 ? 1.0 : -1.0;
    w.belt_ratio = knee ? kBelt : 1.0;
    w.offset_rad = knee ? 4.35 : 0.1;
    w.position_range_rad = 12.5;
    w.velocity_range_rad_s = 45.0;
    w.kp_max_Nm_rad = 500.0;
    w.kd_max_Nm_s_rad = 5.0;
    w.torque_range_Nm = 18.0;
  }
  for (robot::Actuator& actuator : model.actuators) {
    actuator.torque_limit_Nm = 17.0;
    actuator.min_rad = -2.0;
    actuator.max_rad = 2.0;
  }
  model.actuators[2].torque_limit_Nm = 26.0;
  return model;
}

const WireRanges kRanges{12.5, 45.0, 500.0, 5.0, 18.0};

CanFrame reply_frame(std::size_t joint, double wire_position, double wire_velocity = 0,
                     double wire_torque = 0, std::int64_t stamp_ns = 0) {
  const Result<ReplyBytes> bytes =
      encode_reply(kRanges, {.drive_id = static_cast<std::uint8_t>(joint % 3 + 1),
                             .position_rad = wire_position,
                             .velocity_rad_s = wire_velocity,
                             .torque_Nm = wire_torque});
  CanFrame frame;
  frame.bus = static_cast<std::uint8_t>(joint / 3);
  frame.size = bytes.value().size;
  frame.stamp = {stamp_ns};
  for (std::size_t i = 0; i < frame.size; ++i) frame.data[i] = bytes.value().data[i];
  return frame;
}

DriveCommand drive_command(const CanFrame& frame) {
  const Result<DriveCommand> command =
      decode_command(kRanges, std::span(frame.data).first(frame.size));
  EXPECT_TRUE(command.ok());
  return command.value();
}

class JointBusTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(ok(bus_.configure(test_robot()))); }

  void answer_all(std::int64_t stamp_ns = 0) {
    for (std::size_t joint = 0; joint < robot::kJoints; ++joint) answer(joint, stamp_ns);
  }
  void answer(std::size_t joint, std::int64_t stamp_ns = 0) {
    const CanFrame frame = reply_frame(joint, 0.0, 0.0, 0.0, stamp_ns);
    bus_.receive({&frame, 1});
  }
  Frames sent(const JointCommands& commands = {}) {
    Frames out;
    EXPECT_TRUE(ok(bus_.encode(commands, out)));
    return out;
  }

  JointBus bus_;
};

TEST_F(JointBusTest, FramesGoOutByBusThenJointToTheRightDrives) {
  const Frames out = sent();
  ASSERT_EQ(out.size(), robot::kJoints);
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    EXPECT_EQ(out[joint].bus, joint / 3);
    EXPECT_EQ(out[joint].id, joint % 3 + 1);
    EXPECT_EQ(out[joint].size, 8);
    EXPECT_EQ(out[joint].flags, 0);
  }
}

TEST(JointBus, OrderFollowsTheWiringNotTheJointNumber) {
  robot::RobotModel model = test_robot();
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {  // two buses, hind legs first
    model.wiring[joint].bus = joint < 6 ? 1 : 0;
    model.wiring[joint].can_id = static_cast<std::uint16_t>(joint + 1);
  }
  JointBus bus;
  ASSERT_TRUE(ok(bus.configure(model)));
  Frames out;
  ASSERT_TRUE(ok(bus.encode({}, out)));
  for (std::size_t i = 0; i < robot::kJoints; ++i) EXPECT_EQ(out[i].id, (i + 6) % 12 + 1);
}

TEST_F(JointBusTest, JointCommandComesBackThroughTheWire) {
  Random random(5);
  for (int i = 0; i < 2000; ++i) {
    JointCommands commands;
    for (JointCommand& c : commands) {
      c.position_rad = random.uniform(-1.9, 1.9);
      c.velocity_rad_s = random.uniform(-20.0, 20.0);
      c.kp_Nm_rad = random.uniform(0.0, 400.0);
      c.kd_Nm_s_rad = random.uniform(0.0, 4.0);
      c.torque_Nm = random.uniform(-16.0, 16.0);
    }
    Frames out;
    ASSERT_TRUE(ok(bus_.encode(commands, out)));
    for (const CanFrame& frame : out) {
      std::size_t joint = 99;
      JointCommand got;
      ASSERT_TRUE(ok(bus_.decode_command_frame(frame, joint, got)));
      const JointCommand& asked = commands[joint];
      const double belt = joint % 3 == 2 ? kBelt : 1.0;
      EXPECT_NEAR(got.position_rad, asked.position_rad, 25.0 / 65535 / belt * 1.01);
      EXPECT_NEAR(got.velocity_rad_s, asked.velocity_rad_s, 90.0 / 4095 / belt * 1.01);
      EXPECT_NEAR(got.kp_Nm_rad, asked.kp_Nm_rad, 500.0 / 4095 * belt * belt * 1.01);
      EXPECT_NEAR(got.kd_Nm_s_rad, asked.kd_Nm_s_rad, 5.0 / 4095 * belt * belt * 1.01);
      EXPECT_NEAR(got.torque_Nm, asked.torque_Nm, 36.0 / 4095 * belt * 1.01);
    }
  }
}

// The belt neither makes nor eats power, and the drive's law, evaluated at the drive and brought
// back to the joint, is the joint law that was asked for.
TEST(JointBusPhysics, PowerIsTheSameOnBothSidesOfTheBelt) {
  Random random(6);
  for (int i = 0; i < 10'000; ++i) {
    const double scale = (i % 2 == 0 ? 1.0 : -1.0) * random.uniform(0.3, 3.0);
    JointCommand joint;
    joint.velocity_rad_s = random.uniform(-20.0, 20.0);
    joint.torque_Nm = random.uniform(-20.0, 20.0);
    const DriveCommand drive = to_wire(joint, scale, 1.0);
    EXPECT_NEAR(drive.torque_Nm * drive.velocity_rad_s, joint.torque_Nm * joint.velocity_rad_s,
                1e-9);
  }
}

TEST(JointBusPhysics, TheDriveLawIsTheJointLaw) {
  Random random(7);
  for (int i = 0; i < 10'000; ++i) {
    const double scale = (i % 2 == 0 ? 1.0 : -1.0) * random.uniform(0.3, 3.0);
    const double offset = random.uniform(-5.0, 5.0);
    JointCommand c;
    c.position_rad = random.uniform(-2.0, 2.0);
    c.velocity_rad_s = random.uniform(-5.0, 5.0);
    c.kp_Nm_rad = random.uniform(0.0, 100.0);
    c.kd_Nm_s_rad = random.uniform(0.0, 3.0);
    c.torque_Nm = random.uniform(-10.0, 10.0);
    const double q = random.uniform(-2.0, 2.0);
    const double qd = random.uniform(-10.0, 10.0);
    const double joint_law =
        c.kp_Nm_rad * (c.position_rad - q) + c.kd_Nm_s_rad * (c.velocity_rad_s - qd) + c.torque_Nm;
    const DriveCommand d = to_wire(c, scale, offset);
    const double drive_law = d.kp_Nm_rad * (d.position_rad - (scale * q + offset)) +
                             d.kd_Nm_s_rad * (d.velocity_rad_s - scale * qd) + d.torque_Nm;
    EXPECT_NEAR(drive_law * scale, joint_law, 1e-9);
  }
}

// Through the codec: a knee with kp 80 pushed 0.1 rad away pulls back with 8 N m, not 19.3.
TEST_F(JointBusTest, KneeStiffnessIsWhatWasAskedFor) {
  JointCommands commands;
  for (JointCommand& c : commands) c.kp_Nm_rad = 80.0;
  const Frames out = sent(commands);
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    const robot::JointWiring wiring = test_robot().wiring[joint];
    const double scale = wiring.direction * wiring.belt_ratio;
    const DriveCommand drive = drive_command(out[joint]);
    const double wire_angle = scale * 0.1 + wiring.offset_rad;
    const double torque = scale * drive.kp_Nm_rad * (drive.position_rad - wire_angle);
    EXPECT_NEAR(torque, -8.0, 0.1) << joint;
  }
}

TEST_F(JointBusTest, RepliesBecomeJointStates) {
  const robot::RobotModel model = test_robot();
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    const robot::JointWiring& w = model.wiring[joint];
    const double scale = w.direction * w.belt_ratio;
    const double q = 0.1 * static_cast<double>(joint) - 0.5;
    const CanFrame frame = reply_frame(joint, scale * q + w.offset_rad, scale * 3.0, 5.0 / scale,
                                       static_cast<std::int64_t>(1000 + joint));
    bus_.receive({&frame, 1});
    const JointState& state = bus_.states()[joint];
    EXPECT_TRUE(state.valid);
    EXPECT_EQ(state.stamp.ns, static_cast<std::int64_t>(1000 + joint));
    EXPECT_NEAR(state.position_rad, q, 25.0 / 65535);
    EXPECT_NEAR(state.velocity_rad_s, 3.0, 90.0 / 4095);
    EXPECT_NEAR(state.torque_Nm, 5.0, 36.0 / 4095 * kBelt);
    // Half a code nearer to the upper end on the wire, whichever way the joint turns there.
    const JointState& measured = bus_.measured()[joint];
    EXPECT_TRUE(measured.valid);
    EXPECT_NEAR(measured.position_rad - state.position_rad, 12.5 / 65535 / scale, 1e-12);
    EXPECT_NEAR(measured.velocity_rad_s - state.velocity_rad_s, 45.0 / 4095 / scale, 1e-12);
    EXPECT_NEAR(measured.torque_Nm - state.torque_Nm, 18.0 / 4095 * scale, 1e-12);
  }
  EXPECT_TRUE(bus_.all_valid());
}

TEST_F(JointBusTest, NoStateBeforeTheFirstReply) {
  EXPECT_FALSE(bus_.all_valid());
  for (const JointState& state : bus_.states()) EXPECT_FALSE(state.valid);
}

TEST_F(JointBusTest, ReplyIsAttributedByBusAndByteZeroWhateverItsCanId) {
  CanFrame frame = reply_frame(4, 0.5);
  frame.id = 0x123;
  bus_.receive({&frame, 1});
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    EXPECT_EQ(bus_.states()[joint].valid, joint == 4);
  }
}

TEST_F(JointBusTest, BadFramesAreCountedByCauseAndChangeNothing) {
  std::vector<CanFrame> frames(8, reply_frame(0, 0.0));
  frames[0].size = 5;
  frames[1].size = 9;
  frames[2].flags = CanFrame::kExtendedId;
  frames[3].flags = CanFrame::kFlexibleDataRate;
  frames[4].data[0] = 9;  // no such drive
  frames[5].bus = 7;      // no such bus
  frames[6].flags = CanFrame::kErrorFrame;
  frames[7].id = 2;  // a command to a drive, heard back
  frames[7].size = 8;
  bus_.receive(frames);
  EXPECT_EQ(bus_.counters().invalid, 4u);
  EXPECT_EQ(bus_.counters().unknown, 2u);
  EXPECT_EQ(bus_.counters().errors, 1u);
  EXPECT_EQ(bus_.counters().commands, 1u);
  EXPECT_EQ(bus_.counters().replies, 0u);
  for (const JointState& state : bus_.states()) EXPECT_FALSE(state.valid);
}

TEST_F(JointBusTest, MissedAndDuplicateReplies) {
  sent();
  answer_all();
  EXPECT_EQ(bus_.counters().duplicates, 0u);
  answer(3);
  EXPECT_EQ(bus_.counters().duplicates, 1u);
  sent();
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    if (joint != 7) answer(joint);
  }
  EXPECT_EQ(bus_.counters().missed, 0u);  // nothing is late before the next command
  sent();
  EXPECT_EQ(bus_.counters().missed, 1u);
  EXPECT_EQ(bus_.missed(7), 1u);
  EXPECT_EQ(bus_.missed_in_a_row(7), 1u);
  answer_all();
  EXPECT_EQ(bus_.missed(7), 1u);
  EXPECT_EQ(bus_.missed_in_a_row(7), 0u);
}

TEST_F(JointBusTest, ADriveThatStopsAnsweringBecomesSilentAndComesBack) {
  const std::uint32_t limit = ActuationParameters{}.silent_after_ticks;
  sent();
  answer_all();
  for (std::uint32_t tick = 0; tick <= limit; ++tick) {
    EXPECT_EQ(bus_.silent_joints(), 0u) << tick;
    EXPECT_TRUE(bus_.all_valid());
    sent();
    for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
      if (joint != 5) answer(joint);
    }
  }
  sent();
  EXPECT_EQ(bus_.silent_joints(), 1u << 5u);
  EXPECT_FALSE(bus_.states()[5].valid);
  EXPECT_FALSE(bus_.measured()[5].valid);
  answer_all();
  EXPECT_EQ(bus_.silent_joints(), 0u);
  EXPECT_TRUE(bus_.all_valid());
}

TEST_F(JointBusTest, DriveErrorsAreReported) {
  CanFrame frame = reply_frame(2, 0.0);
  frame.size = 8;
  frame.data[6] = 71;
  frame.data[7] = 1;
  bus_.receive({&frame, 1});
  EXPECT_EQ(bus_.faulty_joints(), 1u << 2u);
  EXPECT_EQ(bus_.health(2).error, DriveError::kOverTemperature);
  EXPECT_EQ(bus_.health(2).temperature_code, 71);
  frame.data[7] = 0;
  bus_.receive({&frame, 1});
  EXPECT_EQ(bus_.faulty_joints(), 0u);
}

TEST_F(JointBusTest, PositionAndTorqueStayInsideTheLimits) {
  JointCommands commands;
  for (JointCommand& c : commands) {
    c.position_rad = 9.0;
    c.kp_Nm_rad = 10.0;
    c.torque_Nm = -100.0;
  }
  const Frames out = sent(commands);
  for (const CanFrame& frame : out) {
    std::size_t joint = 0;
    JointCommand got;
    ASSERT_TRUE(ok(bus_.decode_command_frame(frame, joint, got)));
    EXPECT_NEAR(got.position_rad, 1.97, 1e-3);
    EXPECT_NEAR(got.torque_Nm, joint % 3 == 2 ? -26.0 : -17.0, 36.0 / 4095 * kBelt);
  }
  EXPECT_EQ(bus_.counters().limited, robot::kJoints);
}

TEST_F(JointBusTest, AtTheSoftStopNothingPushesFurtherOut) {
  const robot::JointWiring w = test_robot().wiring[0];
  const CanFrame at_stop = reply_frame(0, w.direction * 1.99 + w.offset_rad);
  bus_.receive({&at_stop, 1});
  JointCommands commands;
  commands[0].torque_Nm = 10.0;
  commands[0].velocity_rad_s = 5.0;
  commands[0].kd_Nm_s_rad = 1.0;
  DriveCommand drive = drive_command(sent(commands)[0]);
  EXPECT_NEAR(drive.torque_Nm, 0.0, 36.0 / 4095);
  EXPECT_NEAR(drive.velocity_rad_s, 0.0, 90.0 / 4095);
  commands[0].torque_Nm = -10.0;  // inwards is free
  drive = drive_command(sent(commands)[0]);
  EXPECT_NEAR(drive.torque_Nm, -10.0, 36.0 / 4095);
}

TEST_F(JointBusTest, NotFiniteBecomesDampingAndTheOthersGetTheirs) {
  const double bad_values[] = {std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity(),
                               1.7e308};  // finite here, infinite behind the belt
  for (const double bad : bad_values) {
    JointCommands commands;
    for (JointCommand& c : commands) c.kp_Nm_rad = 50.0;
    commands[8].velocity_rad_s = bad;
    commands[8].kd_Nm_s_rad = bad;
    commands[8].torque_Nm = 3.0;
    Frames out;
    EXPECT_EQ(bus_.encode(commands, out), Status::kInvalid);
    ASSERT_EQ(out.size(), robot::kJoints);
    const DriveCommand drive = drive_command(out[8]);
    EXPECT_EQ(drive.kp_Nm_rad, 0.0);
    EXPECT_NEAR(drive.kd_Nm_s_rad, 1.0 / (kBelt * kBelt), 5.0 / 4095);
    EXPECT_NEAR(drive.torque_Nm, 0.0, 36.0 / 4095);
    EXPECT_NEAR(drive_command(out[7]).kp_Nm_rad, 50.0, 500.0 / 4095);
  }
  EXPECT_EQ(bus_.counters().refused, 3u);
}

TEST_F(JointBusTest, EnableDisableAndPollAreSpecialFramesToAllDrives) {
  Frames enter;
  ASSERT_TRUE(ok(bus_.enable(enter)));
  Frames exit;
  ASSERT_TRUE(ok(bus_.disable(exit)));
  ASSERT_EQ(enter.size(), robot::kJoints);
  ASSERT_EQ(exit.size(), robot::kJoints);
  for (std::size_t i = 0; i < robot::kJoints; ++i) {
    EXPECT_EQ(classify(std::span(enter[i].data).first(8)).value(), FrameKind::kEnterMotorMode);
    EXPECT_EQ(classify(std::span(exit[i].data).first(8)).value(), FrameKind::kExitMotorMode);
  }
  Frames none;
  EXPECT_EQ(bus_.encode_special_to_all(FrameKind::kSetZero, none), Status::kInvalid);
  EXPECT_TRUE(none.empty());
}

TEST_F(JointBusTest, FullOutputListIsRefusedWhole) {
  FixedVector<CanFrame, 20> out;
  ASSERT_TRUE(ok(bus_.encode({}, out)));
  EXPECT_EQ(bus_.encode({}, out), Status::kExhausted);
  EXPECT_EQ(out.size(), robot::kJoints);
}

// A bus commanded by somebody else: silence there is missed replies too.
TEST_F(JointBusTest, ListeningCountsWhatTheCommanderMissed) {
  JointBus commander;
  ASSERT_TRUE(ok(commander.configure(test_robot())));
  for (int tick = 0; tick < 3; ++tick) {
    Frames out;
    ASSERT_TRUE(ok(commander.encode({}, out)));
    bus_.listen({out.data(), out.size()});
    for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
      if (joint == 6) continue;
      const CanFrame frame = reply_frame(joint, 0.0);
      bus_.listen({&frame, 1});
    }
  }
  EXPECT_EQ(bus_.counters().commands, 36u);
  EXPECT_EQ(bus_.counters().replies, 33u);
  EXPECT_EQ(bus_.counters().duplicates, 0u);
  EXPECT_EQ(bus_.missed(6), 2u);
}

TEST(JointBus, WrongWiringIsRefused) {
  const auto status_of = [](auto change) {
    robot::RobotModel model = test_robot();
    change(model);
    JointBus bus;
    const Status status = bus.configure(model);
    Frames out;
    if (!ok(status)) {
      EXPECT_EQ(bus.encode({}, out), Status::kUnavailable);
    }
    return status;
  };
  using Model = robot::RobotModel;
  EXPECT_EQ(status_of([](Model&) {}), Status::kOk);
  EXPECT_EQ(status_of([](Model& m) { m.wiring[4].direction = 0.5; }), Status::kInvalid);
  EXPECT_EQ(status_of([](Model& m) { m.wiring[4].belt_ratio = 0.0; }), Status::kInvalid);
  EXPECT_EQ(status_of([](Model& m) { m.wiring[4].can_id = 1; }), Status::kInvalid);  // taken
  EXPECT_EQ(status_of([](Model& m) { m.wiring[4].can_id = 0; }), Status::kInvalid);
  EXPECT_EQ(status_of([](Model& m) { m.wiring[4].can_id = 256; }), Status::kInvalid);
  EXPECT_EQ(status_of([](Model& m) { m.wiring[4].bus = 4; }), Status::kInvalid);
  EXPECT_EQ(status_of([](Model& m) { m.wiring[4].torque_range_Nm = 0.0; }), Status::kInvalid);
  EXPECT_EQ(status_of([](Model& m) { m.actuators[1].torque_limit_Nm = 0.0; }), Status::kInvalid);
  EXPECT_EQ(status_of([](Model& m) { m.wiring[4].offset_rad = 12.0; }), Status::kOutOfRange);
  EXPECT_EQ(status_of([](Model& m) { m.actuators[1].max_rad = -1.99; }), Status::kOutOfRange);
}

// Same inputs, same frames: no hidden state beyond what was received.
TEST_F(JointBusTest, TwoBusesWithTheSameHistorySendTheSameBytes) {
  JointBus other;
  ASSERT_TRUE(ok(other.configure(test_robot())));
  Random random(8);
  for (int tick = 0; tick < 200; ++tick) {
    JointCommands commands;
    for (JointCommand& c : commands) {
      c.position_rad = random.uniform(-3.0, 3.0);
      c.torque_Nm = random.uniform(-30.0, 30.0);
      c.kp_Nm_rad = 20.0;
    }
    const std::uint32_t joint = random.below(12);
    const CanFrame frame = reply_frame(joint, random.uniform(-12.0, 12.0));
    bus_.receive({&frame, 1});
    other.receive({&frame, 1});
    Frames a;
    Frames b;
    ASSERT_TRUE(ok(bus_.encode(commands, a)));
    ASSERT_TRUE(ok(other.encode(commands, b)));
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(a[i].data, b[i].data);
      ASSERT_EQ(a[i].bus, b[i].bus);
      ASSERT_EQ(a[i].id, b[i].id);
    }
  }
}

}  // namespace
}  // namespace surefoot::actuation
