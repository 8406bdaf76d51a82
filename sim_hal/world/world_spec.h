// Which ground a run is made on. Plain data; the seed decides every draw (world/terrain.h builds
// it).
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "core/base/parameters.h"
#include "core/base/random.h"

namespace surefoot::sim {

enum class Generator : std::uint8_t {
  kFlat = 0,
  kSteps,
  kRamps,
  kClutter,
  kHeightMap,
  kPlatform,
  kGap,
  kGauntlet,
  kRocks,
  kForest,
  kWall,
  kCuldesac,
  kWalkers,
};

inline constexpr std::array<const char*, 13> kGeneratorNames{
    "flat",     "steps", "ramps",  "clutter", "heightmap", "platform", "gap",
    "gauntlet", "rocks", "forest", "wall",    "culdesac",  "walkers"};

// rocks: slabs stacked flat on each other, or convex bodies as they fell (rock_field.h).
enum class RockStyle : std::uint8_t { kFlat = 0, kJagged };
inline constexpr std::array<const char*, 2> kRockStyleNames{"flat", "jagged"};

// The world frame W has its origin on the ground under the robot's start, x towards the goal, y
// left, z up. Every generated world keeps x < 0.4 m level at z = 0.
struct WorldSpec {
  Generator generator = Generator::kFlat;
  double height_m = 0;   // clutter, steps: tallest; platform: of it; rocks: range, 0: usual
  double cover = 0;      // clutter: fraction of the field under boxes
  double slope_rad = 0;  // ramps: steepest slope
  double length_m = 0;   // gap: from edge to edge
  double scale = 1;      // heightmap: factor on x, y and z of the file
  RockStyle style = RockStyle::kFlat;
  double length_to_goal_m = 0;  // forest; 0: drawn
  bool enclosed = false;        // wall: all around the robot
  double goal_x_m = 3.0;        // of a mission that leaves it to the world
  double friction = 0.6;        // Coulomb coefficient of the whole ground
  std::string file;             // heightmap: .asc, or .png with a .yaml beside it; unused otherwise

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("generator", self.generator, kGeneratorNames, "how the ground is made");
    visit.real("height_m", self.height_m, {0.0, 0.5}, "clutter, steps: greatest; platform: of it");
    visit.real("cover", self.cover, {0.0, 0.6}, "clutter: part of the field under boxes");
    visit.real("slope_rad", self.slope_rad, {0.0, 0.45}, "ramps: steepest slope");
    visit.real("length_m", self.length_m, {0.0, 1.0}, "gap: from edge to edge");
    visit.real("scale", self.scale, {0.001, 100.0}, "heightmap: factor on x, y and z");
    visit.choice("style", self.style, kRockStyleNames, "rocks: which kind");
    visit.real("length_to_goal_m", self.length_to_goal_m, {0.0, 200.0}, "forest; 0: drawn");
    visit.boolean("enclosed", self.enclosed, "wall: all around the robot, no way out");
    visit.real("goal_x_m", self.goal_x_m, {0.1, 1000.0},
               "of a mission that leaves it to the world");
    visit.real("friction", self.friction, {0.01, 2.0}, "Coulomb coefficient");
    if constexpr (requires { visit.text("file", self.file, "doc"); }) {
      visit.text("file", self.file, "heightmap: .asc or .png; empty otherwise");
    }
  }
};

// Where the world has its goal: goal_x_m but in forests. There it is the length that was asked for
// or, as in the paper's tests, one of its distances between start and goal (003, table I, 7 to 130
// m).
inline constexpr std::array<double, 25> kPaperDistances_m{
    28.01, 29.68, 32.27, 27.45, 32.11, 31.56, 38.52, 35.96, 32.00, 68.91, 130.0, 39.08, 40.97,
    9.32,  17.89, 31.64, 7.07,  10.10, 9.58,  34.09, 20.65, 9.85,  28.86, 78.84, 15.40};

inline double goal_of(const WorldSpec& spec, std::uint64_t seed) {
  constexpr std::uint64_t kGoalStream = 23;
  if (spec.generator != Generator::kForest) return spec.goal_x_m;
  if (spec.length_to_goal_m > 0) return spec.length_to_goal_m;
  Random random(seed, kGoalStream);
  return kPaperDistances_m[random.below(static_cast<std::uint32_t>(kPaperDistances_m.size()))];
}

// Geometry of the mission's lane, contract.md "The worlds". All in W.
inline constexpr double kGoalX_m = 3.0;
inline constexpr double kLaneWidth_m = 1.2;
inline constexpr double kFieldBegin_m = 0.4;
inline constexpr double kFieldLength_m = 2.3;
inline constexpr double kBoardLength_m = 1.5;  // rocks: begins where the field does
inline constexpr double kBoardWidth_m = 0.8;
inline constexpr double kEdgeX_m = 1.0;  // of platform and gap, on the line to the goal

}  // namespace surefoot::sim
