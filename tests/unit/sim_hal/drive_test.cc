// Motors behind the CAN port: the drive's protocol, law, limits and time-out.
#include <gtest/gtest.h>

#include <cmath>

#include "sim_hal/robot/drive.h"
#include "tests/unit/sim_hal/sim_fixture.h"

namespace surefoot::sim {
namespace {

using actuation::FrameKind;

// A robot on a stand, legs hanging.
SimulatorConfig on_stand() {
  SimulatorConfig config;
  config.start.trunk_fixed = true;
  config.start.drop_height_m = 0.5;
  config.start.leg_rad = {0, -0.2, 0.4};
  return config;
}

actuation::Reply reply_of(const Rig& rig, const hal::CanFrame& frame, std::size_t& joint) {
  const std::uint8_t id = frame.data[0];
  joint = frame.bus * 3u + id - 1u;
  return actuation::decode_reply(ranges(rig.model.wiring[joint]), {frame.data.data(), frame.size})
      .value();
}

TEST(SimCan, EveryFrameOfATickIsAnsweredByTheNext) {
  for (std::uint8_t size = 6; size <= 8; ++size) {
    SimulatorConfig config = on_stand();
    config.can.reply_size = size;
    config.can.reply_id = 0x55;
    Rig rig({}, config);
    rig.send_special(FrameKind::kEnterMotorMode);
    ASSERT_EQ(rig.tick(), 12u);
    EXPECT_EQ(rig.replies[0].size, size);
    EXPECT_EQ(rig.replies[0].id, 0x55u);
    for (std::size_t i = 0; i < 12; ++i) {
      EXPECT_GT(rig.replies[i].stamp, TimeNs{});
      EXPECT_LE(rig.replies[i].stamp, rig.time);
      if (i > 0) {
        EXPECT_GE(rig.replies[i].stamp, rig.replies[i - 1].stamp);
      }
    }
    EXPECT_EQ(rig.tick(), 0u);  // a drive never talks unasked
  }
}

TEST(SimCan, RepliesDecodeToTheTruth) {
  Rig rig({}, on_stand());
  rig.send_special(FrameKind::kEnterMotorMode);
  rig.tick();
  for (int i = 0; i < 100; ++i) {
    rig.send_all({0.1, -0.5, 0.9}, 20, 0.5);
    ASSERT_EQ(rig.tick(), 12u);
  }
  const Truth truth = rig.simulator->truth();
  for (std::size_t i = 0; i < 12; ++i) {
    std::size_t joint = 0;
    const actuation::Reply reply = reply_of(rig, rig.replies[i], joint);
    const robot::JointWiring& w = rig.model.wiring[joint];
    const double factor = w.direction * w.belt_ratio;
    EXPECT_NEAR((reply.position_rad - w.offset_rad) / factor, truth.joints[joint].position_rad,
                0.01);
    EXPECT_NEAR(reply.velocity_rad_s / factor, truth.joints[joint].velocity_rad_s, 0.2);
    EXPECT_NEAR(reply.torque_Nm * factor, truth.joints[joint].motor_torque_Nm, 0.3);
    EXPECT_NEAR(truth.joints[joint].position_rad,
                joint % 3 == 0   ? 0.1
                : joint % 3 == 1 ? -0.5
                                 : 0.9,
                0.15);
  }
}

TEST(SimCan, GoesLimpWhenCommandsStop) {
  Rig rig({}, on_stand());
  rig.send_special(FrameKind::kEnterMotorMode);
  rig.tick();
  for (std::size_t i = 0; i < 12; ++i) rig.send(i, {0, 0, 0, 5.0});
  // The frames are through within 0.8 ms; each drive's 25 ms begin then.
  double last_torque_s = 0;
  for (int us = 500; us <= 40'000; us += 500) {
    ASSERT_TRUE(ok(rig.board.clock->wait_until(rig.time + microseconds(us))));
    if (std::fabs(rig.simulator->truth().joints[0].motor_torque_Nm) > 0.1)
      last_torque_s = us * 1e-6;
  }
  EXPECT_GE(last_torque_s, 0.0245);
  EXPECT_LE(last_torque_s, 0.0260);
}

TEST(SimCan, FeelsNothingOutOfMotorModeAndAfterExit) {
  Rig rig({}, on_stand());
  for (std::size_t i = 0; i < 12; ++i) rig.send(i, {0, 0, 0, 5.0});
  EXPECT_EQ(rig.tick(), 12u);  // answered, but no torque
  EXPECT_EQ(rig.simulator->truth().joints[4].motor_torque_Nm, 0.0);
  rig.send_special(FrameKind::kEnterMotorMode);
  for (std::size_t i = 0; i < 12; ++i) rig.send(i, {0, 0, 0, 5.0});
  rig.tick();
  EXPECT_NEAR(rig.simulator->truth().joints[4].motor_torque_Nm, 5.0, 0.02);
  rig.send_special(FrameKind::kExitMotorMode);
  rig.tick();
  EXPECT_EQ(rig.simulator->truth().joints[4].motor_torque_Nm, 0.0);
}

TEST(SimCan, RefusesAndCountsWhatIsWrong) {
  Rig rig;
  hal::CanFrame frame;
  frame.size = 9;
  EXPECT_EQ(rig.board.can->send(frame), Status::kInvalid);
  frame.size = 8;
  frame.id = 0x800;
  EXPECT_EQ(rig.board.can->send(frame), Status::kInvalid);
  frame.id = 99;
  EXPECT_EQ(rig.board.can->send(frame), Status::kOk);  // nobody there
  rig.tick();
  EXPECT_EQ(rig.simulator->counters().frames_unanswered, 1u);
  for (std::size_t i = 0; i < 64; ++i) ASSERT_EQ(rig.board.can->send(frame), Status::kOk);
  EXPECT_EQ(rig.board.can->send(frame), Status::kExhausted);
  frame.bus = 9;
  EXPECT_EQ(rig.board.can->send(frame), Status::kUnavailable);
  EXPECT_EQ(rig.board.can->counters().send_dropped, 2u);
}

TEST(SimCan, InjectedFaultsAreSilentAndCounted) {
  SimulatorConfig config = on_stand();
  config.can.reply_loss = 0.25;
  config.faults.silent_joint = 7;
  config.faults.silent_from_s = 0.1;
  Rig rig({}, config);
  std::size_t replies = 0;
  std::size_t from_silent = 0;
  for (int i = 0; i < 500; ++i) {
    rig.send_special(FrameKind::kEnterMotorMode);
    const std::size_t count = rig.tick();
    replies += count;
    for (std::size_t k = 0; k < count; ++k) {
      from_silent += rig.replies[k].bus == 2 && rig.replies[k].data[0] == 2 ? 1u : 0u;
    }
  }
  EXPECT_EQ(replies + rig.simulator->counters().replies_lost, 6000u);
  EXPECT_NEAR(static_cast<double>(replies), 11 * 375 + 37.5, 120);
  EXPECT_LE(from_silent, 51u);
  EXPECT_GE(from_silent, 25u);
}

TEST(SimCan, EncoderNoiseHasTheStatedDeviation) {
  SimulatorConfig config = on_stand();
  config.start.leg_rad = {0, 0, 0.3};
  config.can.encoder_noise_rad = 0.01;
  Rig rig({}, config);
  for (int i = 0; i < 1500; ++i) rig.tick();  // hang still
  double sum = 0;
  double squares = 0;
  for (int i = 0; i < 500; ++i) {
    rig.send_special(FrameKind::kEnterMotorMode);
    ASSERT_EQ(rig.tick(), 12u);
    std::size_t joint = 0;
    const double p = reply_of(rig, rig.replies[0], joint).position_rad;
    sum += p;
    squares += p * p;
  }
  const double mean = sum / 500;
  EXPECT_NEAR(std::sqrt(squares / 500 - mean * mean), 0.01, 0.002);
}

// One drive alone.
Drive lone_drive(double belt_ratio, double direction) {
  robot::JointWiring w = wiring(0, 0);
  w.belt_ratio = belt_ratio;
  w.direction = direction;
  w.offset_rad = 0.3;
  Drive drive(w, mini_cheetah().actuators[2], 0.025);
  drive.sense(0, 0);
  drive.receive(actuation::encode_special(FrameKind::kEnterMotorMode), {});
  return drive;
}

void ask_torque(Drive& drive, double drive_torque_Nm) {
  const actuation::WireRanges r = ranges(wiring(0, 0));
  actuation::CommandBytes bytes{};
  ASSERT_TRUE(ok(actuation::encode_command(r, {0, 0, 0, 0, drive_torque_Nm}, bytes)));
  ASSERT_TRUE(drive.receive(bytes, {}));
}

TEST(Drive, TorqueStaysUnderLimitAndTorqueSpeedLine) {
  // Limit 26 N m, stall 64.7 N m, no-load speed 25.7 rad/s: the line cuts in above 15.4 rad/s.
  const robot::Actuator actuator = mini_cheetah().actuators[2];
  Drive drive = lone_drive(kKneeBelt, 1.0);
  ask_torque(drive, 18.0);
  for (const double speed : {-30.0, -10.0, 0.0, 10.0, 20.0, 24.0, 25.7, 40.0}) {
    drive.sense(0, speed);
    const double line = actuator.stall_torque_Nm * (1.0 - speed / actuator.no_load_speed_rad_s);
    const double expected = std::max(0.0, std::min({26.0, 18.0 * kKneeBelt, line}));
    EXPECT_NEAR(drive.joint_torque_Nm({}), expected, 1e-9) << speed;
  }
  ask_torque(drive, -18.0);
  drive.sense(0, -20.0);
  const double line = actuator.stall_torque_Nm * (1.0 - 20.0 / actuator.no_load_speed_rad_s);
  EXPECT_NEAR(drive.joint_torque_Nm({}), -line, 1e-9);
}

TEST(Drive, BeltAndDirectionTurnTorqueAndAngle) {
  for (const double direction : {1.0, -1.0}) {
    Drive drive = lone_drive(2.0, direction);
    ask_torque(drive, 3.0);
    EXPECT_NEAR(drive.joint_torque_Nm({}), direction * 6.0, 0.02);
    drive.sense(0.5, 0.25);
    const actuation::WireRanges r = ranges(wiring(0, 0));
    const actuation::Reply reply = actuation::decode_reply(r, drive.reply(8, 0, 0).bytes()).value();
    EXPECT_NEAR(reply.position_rad, direction * 1.0 + 0.3, 0.0005);
    EXPECT_NEAR(reply.velocity_rad_s, direction * 0.5, 0.04);
    EXPECT_NEAR(reply.torque_Nm, 3.0, 0.01);
  }
}

TEST(Drive, ZeroFrameCountsOnlyOutOfMotorMode) {
  Drive drive = lone_drive(1.0, 1.0);
  const auto zero = actuation::encode_special(FrameKind::kSetZero);
  const actuation::WireRanges r = ranges(wiring(0, 0));
  const auto angle = [&] {
    drive.sense(0.5, 0);
    return actuation::decode_reply(r, drive.reply(6, 0, 0).bytes()).value().position_rad;
  };
  EXPECT_NEAR(angle(), 0.8, 0.001);
  drive.receive(zero, {});
  EXPECT_NEAR(angle(), 0.8, 0.001);
  drive.receive(actuation::encode_special(FrameKind::kExitMotorMode), {});
  drive.receive(zero, {});
  EXPECT_NEAR(angle(), 0.0, 0.001);
}

TEST(Drive, ZeroTorqueCommandIsHalfAStepAtMost) {
  Drive drive = lone_drive(1.0, 1.0);
  ask_torque(drive, 0.0);
  EXPECT_LE(std::fabs(drive.joint_torque_Nm({})), 0.0045);
}

}  // namespace
}  // namespace surefoot::sim
