// Workload of core/obstacles: boxes that come and go in a window, and a robot led past them.
#include <memory>

#include "core/base/random.h"
#include "core/obstacles/avoidance.h"
#include "tests/rules/core_hash/workloads.h"
#include "tests/unit/obstacles/windows.h"

namespace surefoot::tests {

void hash_obstacles(Fnv64& hash) {
  using namespace obstacles;
  const auto window = std::make_unique<mapping::MapWindow>();
  const auto pool = std::make_unique<FieldPool>();
  const ObstacleConfig config = obstacles::test::config();
  pool->reset(config);
  Avoidance avoidance;
  avoidance.reset(config, {0.19, 0.13});
  Random random(16);
  for (int i = 0; i < 300; ++i) {
    if (i % 10 == 0) obstacles::test::make_level(*window);
    const auto x = static_cast<std::int32_t>(random.below(80));
    const auto y = static_cast<std::int32_t>(random.below(80));
    const auto size = static_cast<std::int32_t>(1 + random.below(20));
    for (std::int32_t k = 0; k < size; ++k) {
      obstacles::test::cell(*window, x + k, y).height_m =
          static_cast<float>(random.uniform(0, 0.5));
    }
    pool->update(*window, {.jump_only = true, .min_rise_m = 0.12}, Vector2::Zero());
    RobotPlace place;
    place.p_O_m[0] = random.uniform(-0.5, 0.5);
    place.p_O_m[1] = random.uniform(-0.5, 0.5);
    place.yaw_rad = random.uniform(-3.0, 3.0);
    Wish wish;
    wish.velocity_O_m_s[0] = random.uniform(-0.5, 0.5);
    wish.velocity_O_m_s[1] = random.uniform(-0.5, 0.5);
    wish.off_path_m = random.uniform(-0.3, 0.3);
    mix(hash, avoidance.velocity_O_m_s(pool->fields(), place, wish));
    mix(hash, avoidance.potential(pool->fields(), place));
    for (const Field& field : pool->fields()) mix(hash, field.centre_O_m);
    hash.word(pool->counters().made, 8);
    hash.word(pool->counters().forgotten, 8);
    hash.word(pool->counters().refused, 8);
  }
}

}  // namespace surefoot::tests
