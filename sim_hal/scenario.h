// What happens to the robot beside the ground it is set on. Given by the mission's file, group
// `scenario`; the seed decides every draw.
#pragma once

#include <cstdint>

#include "core/base/parameters.h"

namespace surefoot::sim {

// Sideways blows on the trunk while it walks: to the left or to the right by a draw, each at a
// drawn moment of the interval that begins at first_s + i * interval_s and is one jitter_s long, so
// that every phase of a gait is met.
struct PushConfig {
  std::uint32_t count = 0;
  double impulse_N_s = 0;
  double duration_s = 0.1;  // of one blow: constant force impulse / duration
  double first_s = 0;       // simulated time
  double interval_s = 0;
  double jitter_s = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.integer("count", self.count, {0, 32}, "how many; 0: none");
    visit.real("impulse_N_s", self.impulse_N_s, {0.0, 200.0}, "sideways, on the trunk's origin");
    visit.real("duration_s", self.duration_s, {0.001, 2.0}, "of one blow");
    visit.real("first_s", self.first_s, {0.0, 1e4}, "simulated time");
    visit.real("interval_s", self.interval_s, {0.0, 1e3}, "between the blows");
    visit.real("jitter_s", self.jitter_s, {0.0, 10.0}, "drawn delay of each, at most");
  }
};

// How the robot is set down. folded: upright on its folded legs. random_pose: trunk turned at
// random (uniform over all rotations), joints anywhere between their stops, dropped limp from a
// small height; it has come to rest when the run begins.
struct StartConfig {
  enum class Kind : std::uint8_t { kFolded = 0, kRandomPose };
  static constexpr const char* kKindNames[] = {"folded", "random_pose"};

  Kind kind = Kind::kFolded;
  double x_m = 0;  // W, where the trunk is let go

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("kind", self.kind, kKindNames, "how the robot is set down");
    visit.real("x_m", self.x_m, {-1.0, 100.0}, "where, ahead of the world's origin");
  }
};

struct ScenarioConfig {
  StartConfig start;
  PushConfig push;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("start", self.start);
    visit.group("push", self.push);
  }
};

}  // namespace surefoot::sim
