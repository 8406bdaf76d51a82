// The gauntlet: clutter, an obstacle on the line, stacked panels, a platform. contract.md "The
// worlds"; paper 002, section V.
#include <algorithm>
#include <cmath>

#include "sim_hal/world/terrain.h"

namespace surefoot::sim {
namespace {

constexpr double kObstacleX_m = 3.8;
constexpr double kObstacleSide_m = 0.35;
constexpr double kObstacleHeight_m = 0.4;
constexpr double kPanelsX_m = 5.4;
constexpr int kPanels = 4;
constexpr double kPlatformX_m = 7.0;
constexpr double kPlatformHeight_m = 0.13;

void turn(double yaw, TerrainBox& box) {
  box.cos_yaw = std::cos(yaw);
  box.sin_yaw = std::sin(yaw);
}

TerrainBox draw_obstacle(Random& random) {
  TerrainBox box;
  box.x_m = kObstacleX_m + random.uniform(-0.1, 0.1);
  box.y_m = random.uniform(-0.15, 0.15);
  turn(random.uniform(-0.8, 0.8), box);
  box.half_length_m = box.half_width_m = 0.5 * kObstacleSide_m;
  box.top_m = kObstacleHeight_m;
  return box;
}

// Boards, each on all that lie before it, wherever it lies: in the middle they lie on one another.
void stack_panels(Random& random, Terrain& terrain) {
  double top_m = 0;
  for (int i = 0; i < kPanels; ++i) {
    TerrainBox box;
    const double thickness_m = random.uniform(0.015, 0.025);
    box.x_m = kPanelsX_m + random.uniform(-0.15, 0.15);
    box.y_m = random.uniform(-0.15, 0.15);
    turn(random.uniform(-0.3, 0.3), box);
    box.half_length_m = 0.5 * random.uniform(0.5, 0.8);
    box.half_width_m = 0.5 * random.uniform(1.0, 1.4);
    box.bottom_m = top_m;
    top_m += thickness_m;
    box.top_m = top_m;
    terrain.boxes.push_back(box);
  }
}

}  // namespace

void make_gauntlet(double height_m, double cover, Random& random, Terrain& terrain) {
  make_clutter(height_m, cover, random, terrain);
  terrain.obstacle = draw_obstacle(random);
  stack_panels(random, terrain);
  make_platform(kPlatformHeight_m, kPlatformX_m, random, terrain);
}

}  // namespace surefoot::sim
