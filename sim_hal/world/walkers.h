// People: upright capsules that walk to and fro between two places at a constant speed and look at
// nothing. Where one is follows from the time alone.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/math/linear.h"
#include "sim_hal/world/solid.h"

namespace surefoot::sim {

inline constexpr double kWalkerRadius_m = 0.25;
inline constexpr double kWalkerHeight_m = 1.75;

struct Walker {
  Vector2 from_m = Vector2::Zero();
  Vector2 to_m = Vector2::Zero();
  double speed_m_s = 0;
  double begin_m = 0;  // along the way there and back, at t = 0

  Vector2 place_m(double t_s) const;
  Vector2 velocity_m_s(double t_s) const;
};

struct Terrain;

class Walkers {
 public:
  // The terrain must outlive it.
  explicit Walkers(const Terrain& terrain);

  // Puts them where they are at t, on the ground's height there.
  void place(double t_s);
  std::span<const Solid> solids() const { return std::span(solids_).first(count_); }
  std::span<const Vector3> velocities_m_s() const { return std::span(velocities_).first(count_); }

 private:
  const Terrain& terrain_;
  std::size_t count_ = 0;
  std::array<Solid, kMaxWalkers> solids_;
  std::array<Vector3, kMaxWalkers> velocities_;
};

}  // namespace surefoot::sim
