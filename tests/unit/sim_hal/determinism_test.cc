// Same seed, same bits; whatever ran before.
#include <gtest/gtest.h>

#include "core/base/fields.h"
#include "tests/unit/sim_hal/sim_fixture.h"

namespace surefoot::sim {
namespace {

SimulatorConfig noisy() {
  SimulatorConfig config;
  config.imu = {0.0002, 0.01, 1e-5, 0.002, 0.05, 1e-4};
  config.depth = {0.03, 0.5, 0.01, 0.5};
  config.can.encoder_noise_rad = 0.0002;
  config.can.reply_loss = 0.01;
  return config;
}

struct Outcome {
  std::uint64_t state = 0;
  std::uint64_t sensors = 0;
  bool operator==(const Outcome&) const = default;
};

Outcome run(const WorldSpec& world, std::uint64_t seed, double seconds) {
  Rig rig(world, noisy(), seed);
  Fnv64 digest;
  FieldHasher hasher(digest);
  const auto depth = std::make_unique<hal::DepthFrame>();
  std::array<hal::ImuSample, 16> imu;
  rig.send_special(actuation::FrameKind::kEnterMotorMode);
  rig.tick();
  for (int i = 0; i < static_cast<int>(seconds * 500); ++i) {
    // Hops, so that contacts come and go.
    const double knee = (i / 60) % 2 == 0 ? 1.2 : 2.2;
    rig.send_all({0.05, -knee / 2, knee}, 120, 1.5);
    const std::size_t replies = rig.tick();
    for (std::size_t k = 0; k < replies; ++k) hasher.members(rig.replies[k]);
    const std::size_t samples = rig.board.imu->receive(imu);
    for (std::size_t k = 0; k < samples; ++k) hasher.members(imu[k]);
    if (ok(rig.board.depth_camera->receive(*depth))) hasher.members(*depth);
  }
  return {rig.simulator->state_hash(), digest.value()};
}

WorldSpec clutter() {
  WorldSpec world;
  world.generator = Generator::kClutter;
  world.height_m = 0.05;
  world.cover = 0.5;
  return world;
}

TEST(Determinism, SameSeedSameBitsAlsoAfterOtherWorlds) {
  const Outcome first = run(clutter(), 7, 1.5);
  WorldSpec other;
  other.generator = Generator::kRamps;
  other.slope_rad = 0.2;
  run(other, 3, 0.5);
  EXPECT_EQ(run(clutter(), 7, 1.5), first);
}

TEST(Determinism, InterleavedWorldsDoNotDisturbEachOther) {
  const auto hash_after = [](Rig& rig) {
    rig.send_all({0, -0.8, 1.6}, 60, 1);
    rig.tick();
    return rig.simulator->state_hash();
  };
  Rig alone(clutter(), noisy(), 2);
  Rig left(clutter(), noisy(), 2);
  Rig right(clutter(), noisy(), 9);
  for (Rig* rig : {&alone, &left, &right}) rig->send_special(actuation::FrameKind::kEnterMotorMode);
  std::uint64_t expected = 0;
  for (int i = 0; i < 200; ++i) expected = hash_after(alone);
  std::uint64_t got = 0;
  for (int i = 0; i < 200; ++i) {
    got = hash_after(left);
    hash_after(right);
  }
  EXPECT_EQ(got, expected);
}

TEST(Determinism, OtherSeedOtherBits) {
  const Outcome a = run(clutter(), 7, 0.5);
  const Outcome b = run(clutter(), 8, 0.5);
  EXPECT_NE(a.sensors, b.sensors);
}

TEST(Determinism, StateHashSeesTheLastBit) {
  Rig a;
  Rig b;
  EXPECT_EQ(a.simulator->state_hash(), b.simulator->state_hash());
  a.tick();
  EXPECT_NE(a.simulator->state_hash(), b.simulator->state_hash());
  b.tick();
  EXPECT_EQ(a.simulator->state_hash(), b.simulator->state_hash());
  b.simulator->set_trunk_force({1e-9, 0, 0});
  a.tick();
  b.tick();
  EXPECT_NE(a.simulator->state_hash(), b.simulator->state_hash());
}

TEST(Clock, SaysWhenADeadlineHasPassed) {
  Rig rig;
  ASSERT_TRUE(ok(rig.board.clock->wait_until(microseconds(1200))));
  EXPECT_EQ(rig.board.clock->now(), microseconds(1500));  // whole physics steps
  EXPECT_EQ(rig.board.clock->wait_until(microseconds(1000)), Status::kTimeout);
  EXPECT_TRUE(ok(rig.board.clock->wait_until(microseconds(1500))));
}

}  // namespace
}  // namespace surefoot::sim
