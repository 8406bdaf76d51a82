// The simulated robot in its world: ODE 0.16 behind the same ports as the real robot's devices.
//
// Frames: W, the world (world/world_spec.h); B, the trunk; I, the IMU (docs/frames_and_units.md).
// Same robot, world, configuration and seed give the same bits, whatever ran before in the process.
// Not thread safe; several simulators may live one after the other or side by side in one thread.
// Nothing of ours allocates after construction; ODE reuses its arenas.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/time.h"
#include "core/robot/robot_model.h"
#include "hal/api/board.h"
#include "sim_hal/simulator_config.h"
#include "sim_hal/simulator_error.h"
#include "sim_hal/world/solid_kind.h"
#include "sim_hal/world/world_spec.h"

namespace surefoot::sim {

struct JointTruth {
  double position_rad = 0;
  double velocity_rad_s = 0;
  double motor_torque_Nm = 0;  // at the joint, after the drive's limits, before friction
};

struct FootTruth {
  std::array<double, 3> p_WF_m{};  // centre of the foot sphere
  std::array<double, 3> v_WF_m_s{};
  std::array<double, 3> force_W_N{};  // ground on foot, mean over the last physics step
  bool contact = false;
  double slip_speed_m_s = 0;  // of the sphere's lowest surface along the ground, in contact
  double slip_m = 0;          // path slipped since the start
};

inline constexpr double kMaxClearance_m = 3.0;

// What only the simulator knows. For summaries, pictures and tests; never an input of core.
struct Truth {
  TimeNs stamp;
  std::array<double, 3> p_WB_m{};
  std::array<double, 4> q_WB_wxyz{1, 0, 0, 0};
  std::array<double, 3> v_WB_m_s{};  // of B's origin, axes of W
  std::array<double, 3> angular_velocity_B_rad_s{};
  std::array<JointTruth, robot::kJoints> joints;
  std::array<FootTruth, robot::kLegs> feet;
  bool trunk_contact = false;                    // the trunk's box touches the ground or obstacle
  std::array<bool, robot::kLegs> leg_contact{};  // thigh or shank touches the ground
  // Physics steps so far in which a part touched the obstacle or a solid.
  std::uint64_t obstacle_steps = 0;
  std::array<double, 3> obstacle{};  // x, y [m] and yaw [rad] in W; only where there is one
  double mechanical_energy_J = 0;    // kinetic (armature included) + potential
  // In plan, between the robot's footprint (a capsule from hip to hip, as wide as its feet stand)
  // and what stands on the ground, people included; at most kMaxClearance_m; negative: overlap.
  double clearance_m = kMaxClearance_m;
  std::uint8_t walker_count = 0;
  std::array<std::array<double, 2>, kMaxWalkers> walkers_W_m{};  // x, y
};

// The outline of a solid in plan.
struct SolidTruth {
  SolidKind kind = SolidKind::kTrunk;
  double x_m = 0;  // centre, W
  double y_m = 0;
  double half_length_m = 0;  // log, wall: along yaw
  double half_width_m = 0;   // everything else: the radius, as is half_length_m
  double yaw_rad = 0;
  double top_m = 0;
};

// Heights on a 1 cm raster of the lane, x in [0, goal], |y| <= half the lane width.
struct TerrainFigures {
  double max_step_m = 0;  // greatest height difference between neighbouring samples
  double rms_m = 0;       // about the mean height
  double max_height_m = 0;
  double cover = 0;  // part of the field (clutter) under boxes
  std::uint32_t boxes = 0;
  std::uint32_t bridged_cells = 0;  // heightmap: nodata cells filled by their lowest neighbour
  std::uint32_t tiles = 1;          // heightmap: copies, mirrored, needed to cover the lane
  double goal_x_m = 0;              // where the world has its goal
  // Worlds with solids.
  double area_m2 = 0;  // on which they are spread
  std::uint32_t trunks = 0;
  std::uint32_t boulders = 0;
  std::uint32_t logs = 0;
  std::uint32_t walls = 0;
  std::uint32_t saplings = 0;
  std::uint32_t walkers = 0;
  double steepest_rad = 0;     // of the ground without its roughness
  double roughness_rms_m = 0;  // of the roughness
  double passage_width_m = 0;  // a way this wide leads to the goal; 0: none was asked for
  std::uint32_t layouts = 0;   // drawn until there was one
};

// Nothing is lost silently.
struct SimulatorCounters {
  std::uint64_t steps = 0;
  std::uint64_t ode_messages = 0;       // warnings of the physics engine, in this process so far
  std::uint64_t contacts_dropped = 0;   // above the cap per pair or per step
  std::uint64_t replies_lost = 0;       // by configured loss or a silent drive
  std::uint64_t frames_unanswered = 0;  // no drive with that bus and id
  std::uint64_t depth_rays = 0;
  std::uint64_t depth_edge_dropouts = 0;
  std::uint64_t depth_random_dropouts = 0;
  std::uint64_t depth_out_of_range = 0;
  std::uint64_t camera_exposures_lost = 0;
  std::uint64_t stereo_exposures = 0;
  std::uint64_t stereo_exposures_lost = 0;
  std::uint64_t stereo_rays = 0;
  std::uint64_t lidar_beams = 0;  // of scans that were fetched, as the next four
  std::uint64_t lidar_mixed = 0;
  std::uint64_t lidar_random_dropouts = 0;
  std::uint64_t lidar_sapling_returns = 0;
  std::uint64_t lidar_no_returns = 0;
  std::uint64_t lidar_scans_lost = 0;
  std::uint64_t imu_samples_lost = 0;
  std::uint64_t pose_samples_lost = 0;
  std::uint64_t pose_jumps = 0;
  double deepest_self_overlap_m = 0;  // of two parts of the robot that touched each other
};

class Simulator {
 public:
  // Throws SimulatorError.
  Simulator(const robot::RobotModel& robot, const WorldSpec& world, const SimulatorConfig& config,
            std::uint64_t seed);
  ~Simulator();
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  // clock, imu, can or (plant: fast) gait and, where the robot has them, depth_camera,
  // stereo_camera, lidar and pose are set; the rest is null.
  // clock->wait_until(t) steps the physics until now() >= t. The ports live as long as the
  // simulator.
  hal::Board board();

  Truth truth() const;
  // Of positions, orientations and velocities of all bodies, bit for bit.
  std::uint64_t state_hash() const;
  // Highest ground, obstacle or solid at (x, y) in W. The true map for pictures and error figures.
  double terrain_height_m(double x_m, double y_m) const;
  // The same without obstacle and solids.
  double ground_height_m(double x_m, double y_m) const;
  // What stays where it is, for pictures.
  std::vector<SolidTruth> solids() const;
  TerrainFigures terrain_figures() const;
  SimulatorCounters counters() const;

  // A force on the trunk's origin, axes of W, held until changed (pushes).
  void set_trunk_force(const std::array<double, 3>& force_W_N);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace surefoot::sim
