// The robot on its legs: bodies and contacts on ODE, drives behind CAN.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sim_hal/plant.h"
#include "sim_hal/robot/articulation.h"
#include "sim_hal/robot/contacts.h"
#include "sim_hal/robot/ode_world.h"
#include "sim_hal/robot/pushes.h"
#include "sim_hal/robot/sim_can_port.h"
#include "sim_hal/simulator_config.h"
#include "sim_hal/world/terrain_index.h"

namespace surefoot::sim {

class LeggedPlant final : public Plant {
 public:
  // Terrain and index must outlive it.
  LeggedPlant(const robot::RobotModel& robot, const SimulatorConfig& config, const Terrain& terrain,
              const TerrainIndex& index, const SolidIndex& solids, std::uint64_t seed);

  void set_down(std::uint64_t seed) override;
  void step(TimeNs now) override;
  void place_obstacle(const TerrainBox& box) override { contacts_.place_obstacle(box); }
  void place_walkers(const Walkers& walkers) override { contacts_.place_walkers(walkers); }
  void set_force(const Vector3& force_W_N) override { force_W_N_ = force_W_N; }
  bool on_obstacle() const override { return contacts_.on_obstacle(); }

  Vector3 position_m() const override { return robot_.trunk_position_m(); }
  Matrix3 rotation() const override { return robot_.trunk_rotation(); }
  Vector3 angular_velocity_W() const override { return robot_.trunk_angular_velocity_W(); }
  Vector3 point_velocity_W(const Vector3& p_B_m) const override {
    return robot_.trunk_point_velocity_W(p_B_m);
  }
  std::span<const Capsule> leg_shapes() override;

  void attach(hal::Board& board) override { board.can = &can_; }
  void tell(Truth& truth) const override;
  void count(SimulatorCounters& counters) const override;
  void hash(Fnv64& digest) const override { robot_.hash(digest); }

 private:
  void come_to_rest();
  void step_bodies();
  void exchange_can(TimeNs now);
  void track_slip();

  SimulatorConfig config_;
  double step_s_;
  const TerrainIndex& index_;
  OdeWorld ode_;
  Articulation robot_;
  Contacts contacts_;
  Pushes pushes_;
  SimCanPort can_;
  Vector3 force_W_N_ = Vector3::Zero();
  std::array<double, robot::kJoints> torques_Nm_{};
  std::array<double, robot::kLegs> slip_m_{};
  std::array<Capsule, 3 * robot::kLegs> shapes_;
};

}  // namespace surefoot::sim
