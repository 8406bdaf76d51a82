// The obstacle of a scenario, a box that is put elsewhere while the robot goes on; or that of a
// world, which stays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "sim_hal/scenario.h"
#include "sim_hal/world/terrain.h"

namespace surefoot::sim {

class Obstacle {
 public:
  // of_world: stands where the scenario has no places.
  Obstacle(const ObstacleConfig& config, const std::optional<TerrainBox>& of_world,
           std::uint64_t seed);

  bool exists() const { return places_ > 0; }
  // Where it stands now. exists() only.
  const TerrainBox& box() const { return box_; }
  // After each step, with the trunk's x in W; true: it stands somewhere else now.
  bool follow(double trunk_x_m);

 private:
  std::array<TerrainBox, kMaxObstaclePlaces> boxes_;
  std::array<double, kMaxObstaclePlaces> when_x_m_{};
  std::size_t places_ = 0;
  std::size_t place_ = 0;
  TerrainBox box_;
  bool followed_ = false;
  double last_x_m_ = 0;
};

}  // namespace surefoot::sim
