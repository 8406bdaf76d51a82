// Workloads of core/motions and of the edge finder.
#include <memory>

#include "core/autonomy/ledge.h"
#include "core/base/random.h"
#include "core/math/elementary.h"
#include "tests/rules/core_hash/workloads.h"
#include "tests/support/jump_parts.h"
#include "tests/support/ledge_map.h"

namespace surefoot::tests {

// Jumps with random touchdowns and trunk attitudes.
void hash_jump(Fnv64& hash) {
  const robot::RobotModel model = robot::full_mini_cheetah();
  const motions::Motion motion = small_motion();
  Random random(12);
  motions::JumpController jump;
  for (int i = 0; i < 20; ++i) {
    jump.reset(jump_config(), model, 0.29);
    estimation::RobotState state = robot_at(model, -0.8, 1.6);
    jump.begin(motion, state);
    for (int tick = 0; tick < 900; ++tick) {
      const actuation::JointCommands& commands = jump.update(state, 0.002);
      follow(model, commands, state);
      if (jump.holds()) jump.play();
      hash.byte(static_cast<std::uint8_t>(jump.stage()));
      for (const actuation::JointCommand& joint : commands) {
        mix(hash, joint.position_rad);
        mix(hash, joint.velocity_rad_s);
        mix(hash, joint.torque_Nm);
      }
      if (jump.stage() != motions::JumpStage::kFlight) continue;
      const double roll = random.uniform(-0.2, 0.2);
      const double pitch = random.uniform(-0.2, 0.2);
      state.R_OB = geometry::from_roll_pitch_yaw(roll, pitch, 0.0);
      state.feet[0].force_O_N[2] = random.uniform(0.0, 45.0);
    }
  }
}

// Edges at random places under noise, some of them gaps.
void hash_ledge(Fnv64& hash) {
  Random random(13);
  autonomy::LedgeQuery query;
  query.from_m = 0.24;
  query.half_width_m = 0.18;
  query.min_rise_m = 0.11;
  query.min_drop_m = 0.10;
  for (int i = 0; i < 100; ++i) {
    const double distance_m = random.uniform(0.25, 0.7);
    const double slope = random.uniform(-0.3, 0.3);
    const double rise_m = i % 3 == 0 ? -0.3 : random.uniform(0.1, 0.3);
    const double length_m = i % 3 == 0 ? 0.15 : 2.0;
    const auto window = window_of(0.0, 0.0, [&](double x, double y) {
      const double behind_m = x - distance_m - slope * y;
      const double noise_m = 0.004 * random.normal();
      return noise_m + (behind_m > 0 && behind_m < length_m ? rise_m : 0.0);
    });
    query.yaw_rad = random.uniform(-0.2, 0.2);
    const Result<autonomy::Ledge> found = autonomy::find_ledge(*window, query);
    hash.byte(static_cast<std::uint8_t>(found.status()));
    if (!found.ok()) continue;
    const autonomy::Ledge& ledge = found.value();
    hash.byte(static_cast<std::uint8_t>(ledge.kind));
    mix(hash, ledge.edge_O_m);
    mix(hash, ledge.yaw_rad);
    mix(hash, ledge.rise_m);
    mix(hash, ledge.gap_m);
    const autonomy::LandingArea area{0.04, 0.3, 0.18, 0.035, 0.6};
    hash.byte(autonomy::landing_is_free(*window, ledge, 0.0, area) ? 1 : 0);
  }
}

}  // namespace surefoot::tests
