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
}

}  // namespace
}  // namespace surefoot::sim
