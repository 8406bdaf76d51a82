#include "sim_hal/world/obstacle.h"

#include <cmath>

#include "core/base/random.h"

namespace surefoot::sim {
namespace {

constexpr std::uint64_t kObstacleStream = 7;

}  // namespace

Obstacle::Obstacle(const ObstacleConfig& config, const std::optional<TerrainBox>& of_world,
                   std::uint64_t seed) {
  Random random(seed, kObstacleStream);
  for (const ObstaclePlace& place : config.places) {
    TerrainBox& box = boxes_[places_];
    box.x_m = place.x_m + random.uniform(-config.shift_m, config.shift_m);
    box.y_m = place.y_m + random.uniform(-config.shift_m, config.shift_m);
    const double yaw = place.yaw_rad + random.uniform(-config.turn_rad, config.turn_rad);
    box.cos_yaw = std::cos(yaw);
    box.sin_yaw = std::sin(yaw);
    box.half_length_m = 0.5 * config.length_m;
    box.half_width_m = 0.5 * config.width_m;
    box.top_m = config.height_m;
    when_x_m_[places_] = place.when_x_m;
    ++places_;
  }
  if (places_ == 0 && of_world.has_value()) boxes_[places_++] = *of_world;
  box_ = boxes_[0];
}

bool Obstacle::follow(double trunk_x_m) {
  const double before = last_x_m_;
  last_x_m_ = trunk_x_m;
  if (!followed_) {
    followed_ = true;
    return false;
  }
  if (place_ + 1 >= places_) return false;
  const double when = when_x_m_[place_ + 1];
  if ((before < when) == (trunk_x_m < when)) return false;
  box_ = boxes_[++place_];
  return true;
}

}  // namespace surefoot::sim
