// The simulator's ports against the rules of the HAL interfaces.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "apps/common/config_root.h"
#include "core/actuation/motor_protocol.h"
#include "sim_hal/sensors/sim_stereo_camera_port.h"
#include "sim_hal/simulator.h"
#include "tests/conformance/can_port_rules.h"
#include "tests/conformance/clock_rules.h"
#include "tests/conformance/sensor_rules.h"

namespace surefoot::conformance {
namespace {

apps::Config robot_named(const char* name) {
  apps::ConfigIssues issues;
  apps::RunRequest request;
  request.robot = name;
  const apps::Config config =
      apps::load_config_parts(request, SUREFOOT_SOURCE_DIR "/config", issues);
  EXPECT_EQ(apps::to_string(issues), "");
  return config;
}

// The trunk on a stand: the robot stays where it is while the suites let time pass.
class Stand {
 public:
  explicit Stand(const char* robot = "mini_cheetah", sim::PlantKind plant = sim::PlantKind::kLegged)
      : simulator_(robot_named(robot).robot, {}, config(plant), 1), board_(simulator_.board()) {}

  const hal::Board& board() const { return board_; }
  void pass(TimeNs time) { EXPECT_TRUE(ok(board_.clock->wait_until(board_.clock->now() + time))); }

 private:
  static sim::SimulatorConfig config(sim::PlantKind plant) {
    sim::SimulatorConfig config;
    config.start.drop_height_m = 0.3;
    config.start.trunk_fixed = true;
    config.stereo.present = true;
    config.stereo.latency_s = 0.004;
    config.lidar.present = true;
    config.lidar.latency_s = 0.004;
    config.plant = plant;
    return config;
  }
  sim::Simulator simulator_;
  hal::Board board_;
};

class SimCanBench final : public CanBench {
 public:
  hal::CanPort& port() override { return *stand_.board().can; }
  // A drive answers every frame that is sent to it. A bus passes about four of these in a
  // millisecond.
  std::size_t arrive(std::uint8_t bus, std::size_t count) override {
    const actuation::CommandBytes poll =
        actuation::encode_special(actuation::FrameKind::kEnterMotorMode);
    for (std::size_t i = 0; i < count; ++i) {
      hal::CanFrame frame;
      frame.bus = bus;
      frame.id = static_cast<std::uint32_t>(1 + i % 3);
      frame.size = 8;
      std::copy(poll.begin(), poll.end(), frame.data.begin());
      EXPECT_TRUE(ok(port().send(frame)));
      if (i % 16 == 15) stand_.pass(milliseconds(10));
    }
    stand_.pass(milliseconds(10));
    return count;
  }
  std::size_t bus_count() const override { return 4; }
  std::size_t receive_capacity() const override { return 64; }  // per bus

 private:
  Stand stand_;
};

// `period` is a little more than the sensor's.
template <class Bench>
class SimSensorBench final : public Bench {
 public:
  SimSensorBench(typename Bench::Port* hal::Board::*port, TimeNs period, std::size_t capacity)
      : port_(port), period_(period), capacity_(capacity) {
    stand_.pass(period);
  }
  typename Bench::Port& port() override { return *(stand_.board().*port_); }
  std::size_t arrive(std::size_t count) override {
    for (std::size_t i = 0; i < count; ++i) stand_.pass(period_);
    return count;
  }
  std::size_t capacity() const override { return capacity_; }

 private:
  Stand stand_;
  typename Bench::Port* hal::Board::*port_;
  TimeNs period_;
  std::size_t capacity_;
};

TEST(Simulator, CanPortKeepsTheRules) {
  SimCanBench bench;
  EXPECT_EQ(joined(can_port_violations(bench)), "");
}

TEST(Simulator, ImuPortKeepsTheRules) {
  SimSensorBench<ImuBench> bench(&hal::Board::imu, milliseconds(1), 64);
  EXPECT_EQ(joined(sensor_violations<ImuBench>(bench)), "");
}

TEST(Simulator, PosePortKeepsTheRules) {
  SimSensorBench<PoseBench> bench(&hal::Board::pose, milliseconds(5), 64);
  EXPECT_EQ(joined(sensor_violations<PoseBench>(bench)), "");
}

TEST(Simulator, DepthCameraPortKeepsTheRules) {
  SimSensorBench<DepthBench> bench(&hal::Board::depth_camera, milliseconds(34), 8);
  EXPECT_EQ(joined(sensor_violations<DepthBench>(bench)), "");
}

TEST(Simulator, LidarPortKeepsTheRules) {
  SimSensorBench<LidarBench> bench(&hal::Board::lidar, milliseconds(14), 8);
  EXPECT_EQ(joined(sensor_violations<LidarBench>(bench)), "");
}

// Neither port of the other plant: a board has legs or a gait.
TEST(Simulator, ABoardHasLegsOrAGait) {
  const Stand legged;
  EXPECT_NE(legged.board().can, nullptr);
  EXPECT_EQ(legged.board().gait, nullptr);
  const Stand fast("mini_cheetah", sim::PlantKind::kFast);
  EXPECT_EQ(fast.board().can, nullptr);
  EXPECT_NE(fast.board().gait, nullptr);
  EXPECT_NE(fast.board().lidar, nullptr);
}

class SimStereoBench final : public StereoBench {
 public:
  hal::StereoCameraPort& port() override { return *stand_.board().stereo_camera; }
  std::size_t arrive(std::size_t count) override {
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_TRUE(ok(port().trigger()));
      stand_.pass(milliseconds(2));
    }
    stand_.pass(milliseconds(6));
    return count;
  }
  std::size_t capacity() const override { return sim::SimStereoCameraPort::kQueue; }

 private:
  Stand stand_{"littledog"};
};

TEST(Simulator, StereoCameraPortKeepsTheRules) {
  SimStereoBench bench;
  EXPECT_EQ(joined(sensor_violations<StereoBench>(bench)), "");
}

TEST(Simulator, ClockKeepsTheRules) {
  Stand stand;
  const ClockBench bench{.clock = stand.board().clock,
                         .period = milliseconds(2),
                         .allowed_overshoot = microseconds(500)};
  EXPECT_EQ(joined(clock_violations(bench)), "");
}

}  // namespace
}  // namespace surefoot::conformance
