// What happens to the robot beside the ground it is set on. Given by the mission's file, group
// `scenario`; the seed decides every draw.
#pragma once

#include <cstdint>

#include "core/base/fixed_vector.h"
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

// Where the obstacle stands, in W. It is taken away and put down here while the robot goes on: when
// the trunk passes x = when_x_m for the first time after the last move, whichever way. The first
// place is taken at the start.
struct ObstaclePlace {
  double x_m = 0;
  double y_m = 0;
  double yaw_rad = 0;
  double when_x_m = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("x_m", self.x_m, {-100.0, 100.0}, "centre");
    visit.real("y_m", self.y_m, {-100.0, 100.0}, "centre");
    visit.real("yaw_rad", self.yaw_rad, {-3.2, 3.2}, "of its length");
    visit.real("when_x_m", self.when_x_m, {-100.0, 100.0},
               "moved here when the trunk passes; without meaning for the first");
  }
};

inline constexpr std::size_t kMaxObstaclePlaces = 16;

// A box that the robot must not touch. Every place is shifted and turned by draws.
struct ObstacleConfig {
  double length_m = 0;
  double width_m = 0;
  double height_m = 0;
  double shift_m = 0;                                     // drawn from -shift_m to shift_m, x and y
  double turn_rad = 0;                                    // drawn from -turn_rad to turn_rad
  FixedVector<ObstaclePlace, kMaxObstaclePlaces> places;  // none: no obstacle

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("length_m", self.length_m, {0.01, 50.0}, "along its own x");
    visit.real("width_m", self.width_m, {0.01, 50.0}, "across");
    visit.real("height_m", self.height_m, {0.01, 5.0}, "over the level ground");
    visit.real("shift_m", self.shift_m, {0.0, 5.0}, "drawn, either way, x and y");
    visit.real("turn_rad", self.turn_rad, {0.0, 3.2}, "drawn, either way");
    visit.list("places", self.places);
  }
};

struct ScenarioConfig {
  StartConfig start;
  PushConfig push;
  ObstacleConfig obstacle;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("start", self.start);
    visit.group("push", self.push);
    visit.group("obstacle", self.obstacle);
  }
};

}  // namespace surefoot::sim
