// What moves in the simulated world: a body and whatever carries it. One of two: legs on ODE's
// physics behind CAN (robot/legged_plant.h), or a body that follows velocities without legs
// (robot/fast_plant.h).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/hash.h"
#include "core/base/time.h"
#include "core/math/linear.h"
#include "hal/api/board.h"
#include "sim_hal/sensors/capsule.h"
#include "sim_hal/simulator.h"
#include "sim_hal/world/terrain_box.h"
#include "sim_hal/world/walkers.h"

namespace surefoot::sim {

inline std::array<double, 3> to_array(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

class Plant {
 public:
  Plant() = default;
  virtual ~Plant() = default;
  Plant(const Plant&) = delete;
  Plant& operator=(const Plant&) = delete;

  // Puts the robot where the run begins, after the obstacle was placed.
  virtual void set_down(std::uint64_t seed) = 0;
  // One physics step, from `now` on.
  virtual void step(TimeNs now) = 0;
  // A box that must not be touched stands there from now on.
  virtual void place_obstacle(const TerrainBox& box) = 0;
  // The people are there now.
  virtual void place_walkers(const Walkers& walkers) = 0;
  // A force on the trunk's origin, axes of W, until the next one.
  virtual void set_force(const Vector3& force_W_N) = 0;
  // Whether a part met a solid or the obstacle in the last step.
  virtual bool on_obstacle() const = 0;

  // Trunk frame B in W.
  virtual Vector3 position_m() const = 0;
  virtual Matrix3 rotation() const = 0;
  virtual Vector3 angular_velocity_W() const = 0;
  // Of the point p_B_m fixed to the trunk, axes of W.
  virtual Vector3 point_velocity_W(const Vector3& p_B_m) const = 0;
  // What cameras see of the legs, in W. Valid until the next call.
  virtual std::span<const Capsule> leg_shapes() = 0;

  virtual void attach(hal::Board& board) = 0;  // its own ports
  virtual void tell(Truth& truth) const = 0;   // what is not told by the simulator
  virtual void count(SimulatorCounters& counters) const = 0;
  virtual void hash(Fnv64& digest) const = 0;
};

}  // namespace surefoot::sim
