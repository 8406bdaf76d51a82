// Contact between the robot's collision shapes and the ground: foot spheres, shank and thigh
// capsules, trunk box, against plane, boxes (ODE's collider) and grid of heights (grid_contacts.h).
// The robot also collides with itself: shanks and feet with the trunk, legs with each other. Not
// the thighs with the trunk: their upper ends turn inside the abduction housings beside it.
//
// Friction is Coulomb's cone as far as ODE's pyramid can: one side of the pyramid follows the slip,
// or, while a contact sticks, its last tangential force. README.md "Friction" has the measured
// figures.
#pragma once

#include <ode/ode.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/math/linear.h"
#include "sim_hal/robot/articulation.h"
#include "sim_hal/simulator_config.h"
#include "sim_hal/world/grid_contacts.h"
#include "sim_hal/world/solid_index.h"
#include "sim_hal/world/terrain_index.h"
#include "sim_hal/world/walkers.h"

namespace surefoot::sim {

// What one shape felt in the last step, axes of W.
struct ShapeContact {
  double pressure_N = 0;  // normal force of one contact, mean over those that press
  Vector3 force_N = Vector3::Zero();
  Vector3 slip_velocity_m_s = Vector3::Zero();  // of the surface point with the largest force
  bool touching = false;
};

enum class Shape : std::uint8_t { kFoot = 0, kShank, kThigh };

class Contacts {
 public:
  static constexpr std::size_t kShapes = 1 + 3 * robot::kLegs;  // trunk first
  static constexpr int kMaxPerPair = 4;
  static constexpr std::size_t kMaxPerStep = 128;

  static constexpr std::size_t kTrunk = 0;
  static constexpr std::size_t shape_of(std::size_t leg, Shape shape) {
    return 1 + 3 * leg + static_cast<std::size_t>(shape);
  }

  Contacts(dWorldID world, const Articulation& robot, const Terrain& terrain,
           const TerrainIndex& index, const SolidIndex& solids, const PhysicsConfig& config);
  ~Contacts();
  Contacts(const Contacts&) = delete;
  Contacts& operator=(const Contacts&) = delete;

  // Puts the obstacle there; it was nowhere before the first call.
  void place_obstacle(const TerrainBox& box);
  // Puts the people where they are now.
  void place_walkers(const Walkers& walkers);
  // Whether any part of the robot met it, or a solid, in the last collide().
  bool on_obstacle() const { return on_obstacle_; }

  // Before the step: finds contacts and makes their joints.
  void collide();
  // How deep parts of the robot overlap in its present pose; 0: not at all.
  double self_overlap_m() const;
  // The deepest that collide() has found.
  double deepest_self_overlap_m() const { return deepest_self_m_; }
  // After the step: sums forces per shape and discards the joints.
  void collect();

  const ShapeContact& shape(std::size_t i) const { return shapes_[i]; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  using SelfPair = std::array<std::uint8_t, 2>;  // two shapes that can meet
  static constexpr std::size_t kSelfPairs = 62;  // 8 with the trunk, 9 for each pair of legs
  struct Record {                                // one contact joint of the present step
    std::size_t shape = 0;
    Vector3 normal = Vector3::Zero();
    Vector3 slip = Vector3::Zero();
  };

  void make_shapes(const Articulation& robot);
  void make_terrain(const Terrain& terrain);
  void collide_ground(std::size_t shape);
  void collide_shape(std::size_t shape);
  void make_solids();
  void collide_solids(std::size_t shape);
  int collide_pair(std::size_t shape, dGeomID ground);  // number of contacts
  void collide_grid(std::size_t shape);
  void touch_grid(std::size_t shape, const Vector3& centre_m, double radius_m);
  // other: the body it is in contact with; null: the world.
  void add(std::size_t shape, const dContactGeom& geometry, dBodyID other = nullptr);
  void make_self_pairs();
  void collide_self();
  void add_self(const dContactGeom& geometry);

  dWorldID world_;
  const TerrainIndex& index_;
  PhysicsConfig config_;
  double friction_;
  std::array<dGeomID, kShapes> geoms_{};
  dGeomID plane_ = nullptr;
  const HeightGrid& grid_;
  std::vector<dGeomID> boxes_;
  const SolidIndex& solids_;
  std::vector<dGeomID> solid_geoms_;
  std::vector<dGeomID> walker_geoms_;
  std::vector<dBodyID> walker_bodies_;
  dGeomID obstacle_ = nullptr;
  bool on_obstacle_ = false;
  dJointGroupID group_ = nullptr;
  std::array<Record, kMaxPerStep> records_;
  std::array<dJointFeedback, kMaxPerStep> feedback_{};
  std::size_t count_ = 0;       // records: contacts with the ground
  std::size_t self_count_ = 0;  // contacts of the robot with itself
  std::array<ShapeContact, kShapes> shapes_;
  std::array<SelfPair, kSelfPairs> self_pairs_{};
  double deepest_self_m_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace surefoot::sim
