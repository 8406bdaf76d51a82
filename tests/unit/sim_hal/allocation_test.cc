// After construction and a first landing the simulator allocates nothing, ODE included.
#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include "tests/unit/sim_hal/sim_fixture.h"

namespace {
std::atomic<bool> armed{false};
std::atomic<long> calls{0};
void note() {
  if (armed.load(std::memory_order_relaxed)) calls.fetch_add(1, std::memory_order_relaxed);
}
}  // namespace

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* malloc(std::size_t size) {
  note();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  note();
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  note();
  return __libc_realloc(block, size);
}
}

namespace surefoot::sim {
namespace {

long allocations_of(const WorldSpec& world) {
  Rig rig(world);
  const auto frame = std::make_unique<hal::DepthFrame>();
  std::array<hal::ImuSample, 16> imu;
  rig.send_special(actuation::FrameKind::kEnterMotorMode);
  rig.tick();
  calls = 0;
  armed = true;
  rig.simulator->set_trunk_force({25, 3, 0});  // drags the robot over the field, falling about
  for (int i = 0; i < 1500; ++i) {
    const double knee = (i / 60) % 2 == 0 ? 1.2 : 2.2;
    rig.send_all({0.05, -knee / 2, knee}, 120, 1.5);
    rig.tick();
    rig.board.imu->receive(imu);
    static_cast<void>(rig.board.depth_camera->receive(*frame));
    rig.simulator->truth();
  }
  armed = false;
  return calls;
}

// Without legs, with a scanner that is listened to, among people.
long allocations_of_the_fast_plant() {
  robot::RobotModel robot = mini_cheetah();
  robot.lidar.beams = 361;
  robot.lidar.view_rad = 3.14;
  robot.lidar.rate_Hz = 75;
  robot.lidar.max_range_m = 30;
  WorldSpec world;
  world.generator = Generator::kWalkers;
  world.goal_x_m = 14;
  SimulatorConfig config;
  config.plant = PlantKind::kFast;
  config.lidar.present = true;
  Simulator simulator(robot, world, config, 1);
  const hal::Board board = simulator.board();
  const auto frame = std::make_unique<hal::DepthFrame>();
  const auto scan = std::make_unique<hal::LidarScan>();
  hal::GaitSample sample;
  TimeNs time;
  calls = 0;
  armed = true;
  for (int i = 0; i < 2000; ++i) {
    time = time + milliseconds(2);
    static_cast<void>(board.gait->send({true, 0.8, 0.1, 0.1}));
    static_cast<void>(board.clock->wait_until(time));
    static_cast<void>(board.gait->receive(sample));
    static_cast<void>(board.depth_camera->receive(*frame));
    static_cast<void>(board.lidar->receive(*scan));
    simulator.truth();
  }
  armed = false;
  return calls;
}

TEST(Allocation, NoneAfterConstruction) {
  armed = true;
  std::vector<int>* volatile probe = new std::vector<int>(100);  // the counter itself works
  armed = false;
  delete probe;
  ASSERT_GT(calls.load(), 0);
  EXPECT_EQ(allocations_of({}), 0);
  WorldSpec world;
  world.generator = Generator::kClutter;
  world.height_m = 0.08;
  world.cover = 0.5;
  EXPECT_EQ(allocations_of(world), 0);
  world.generator = Generator::kRamps;
  world.slope_rad = 0.2;
  EXPECT_EQ(allocations_of(world), 0);
  world.generator = Generator::kWalkers;
  world.goal_x_m = 14;
  EXPECT_EQ(allocations_of(world), 0);
  EXPECT_EQ(allocations_of_the_fast_plant(), 0);
}

}  // namespace
}  // namespace surefoot::sim
