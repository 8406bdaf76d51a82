#include "sim_hal/simulator.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/math/gravity.h"
#include "sim_hal/plant.h"
#include "sim_hal/robot/fast_plant.h"
#include "sim_hal/robot/footprint.h"
#include "sim_hal/robot/legged_plant.h"
#include "sim_hal/robot/ode_runtime.h"
#include "sim_hal/sensors/sim_depth_camera_port.h"
#include "sim_hal/sensors/sim_imu_port.h"
#include "sim_hal/sensors/sim_lidar_port.h"
#include "sim_hal/sensors/sim_pose_port.h"
#include "sim_hal/sensors/sim_stereo_camera_port.h"
#include "sim_hal/world/obstacle.h"
#include "sim_hal/world/solid_index.h"
#include "sim_hal/world/terrain.h"
#include "sim_hal/world/terrain_index.h"
#include "sim_hal/world/walkers.h"
#include "sim_hal/world_truth.h"

namespace surefoot::sim {

namespace {

void check(const SimulatorConfig& config, const robot::RobotModel& robot) {
  const double step_s = config.physics.step_s;
  if (!(step_s >= 0.0001 && step_s <= 0.002)) {
    throw SimulatorError("simulator: physics.step_s must lie in 0.0001 to 0.002");
  }
  if (config.can.reply_size < 6 || config.can.reply_size > 8) {
    throw SimulatorError("simulator: can.reply_size must be 6, 7 or 8");
  }
  if (robot.depth_camera.width_px > hal::kMaxDepthWidth_px ||
      robot.depth_camera.height_px > hal::kMaxDepthHeight_px) {
    throw SimulatorError("simulator: depth image larger than the port's frames");
  }
  if (config.depth.latency_s * robot.depth_camera.rate_Hz > SimDepthCameraPort::kQueue - 1) {
    throw SimulatorError("simulator: depth.latency_s is longer than the frame queue");
  }
  if (robot.stereo_camera.present && !config.stereo.present) {
    throw SimulatorError("simulator: the robot has a stereo camera, but there is no group stereo");
  }
  if (robot.lidar.rate_Hz > 0 && !config.lidar.present) {
    throw SimulatorError("simulator: the robot has a laser scanner, but there is no group lidar");
  }
  if (robot.lidar.beams > hal::kMaxLidarBeams) {
    throw SimulatorError("simulator: robot.lidar.beams above what a scan holds");
  }
  if (config.lidar.latency_s * robot.lidar.rate_Hz > SimLidarPort::kQueue - 2) {
    throw SimulatorError("simulator: lidar.latency_s is longer than the scan queue");
  }
  if (config.tracking.latency_s * robot.tracking_camera.rate_Hz > SimPosePort::kQueue - 1) {
    throw SimulatorError("simulator: tracking.latency_s is longer than the sample queue");
  }
  for (std::size_t i = 0; i < robot::kJoints; ++i) {
    if (robot.wiring[i].bus >= hal::kMaxCanBuses) throw SimulatorError("robot: wiring.bus above 3");
    for (std::size_t k = 0; k < i; ++k) {
      if (robot.wiring[i].bus == robot.wiring[k].bus &&
          robot.wiring[i].can_id == robot.wiring[k].can_id) {
        throw SimulatorError("robot: joints " + std::to_string(k) + " and " + std::to_string(i) +
                             " share a bus and can_id");
      }
    }
  }
}

struct PlantWorld {
  const Terrain& terrain;
  const TerrainIndex& index;
  const SolidIndex& solids;
  const Walkers& walkers;
};

std::unique_ptr<Plant> make_plant(const robot::RobotModel& robot, const SimulatorConfig& config,
                                  const PlantWorld& world, std::uint64_t seed) {
  if (config.plant == PlantKind::kFast) {
    return std::make_unique<FastPlant>(robot, config, world.index, world.solids, world.walkers,
                                       seed);
  }
  return std::make_unique<LeggedPlant>(robot, config, world.terrain, world.index, world.solids,
                                       seed);
}

double width_m(const robot::RobotModel& robot) { return 2 * Footprint(robot).half_width_m; }

}  // namespace

struct Simulator::Implementation final : hal::Clock {
  Implementation(const robot::RobotModel& robot_model, const WorldSpec& world,
                 const SimulatorConfig& configuration, std::uint64_t seed)
      : robot(robot_model),
        step{std::llround(configuration.physics.step_s * 1e9)},
        goal_x_m(goal_of(world, seed)),
        terrain(make_terrain(world, seed, width_m(robot_model))),
        index(terrain),
        solids(terrain.solids, terrain.saplings),
        walkers(terrain),
        plant(make_plant(robot_model, configuration, {terrain, index, solids, walkers}, seed)),
        obstacle(configuration.scenario.obstacle, terrain.obstacle, seed),
        imu(robot_model.imu, configuration.imu, configuration.faults, seed),
        camera(robot_model.depth_camera, configuration.depth, configuration.faults, index, seed),
        lidar(robot_model.lidar, configuration.lidar, configuration.faults, index, solids, seed),
        tracking(robot_model.tracking_camera, configuration.tracking, configuration.faults, seed,
                 plant->position_m(), plant->rotation()) {
    if (robot_model.stereo_camera.present) {
      stereo = std::make_unique<SimStereoCameraPort>(
          robot_model.stereo_camera, configuration.stereo, configuration.faults, index, seed);
    }
    if (obstacle.exists()) {
      index.show(&obstacle.box());
      plant->place_obstacle(obstacle.box());
    }
    if (!solids.empty()) index.show(&solids);
    if (!walkers.solids().empty()) {
      index.show(walkers.solids());
      plant->place_walkers(walkers);
    }
    plant->set_down(seed);
    mount_velocity_W = plant->point_velocity_W(imu.mount_B_m());
  }

  TimeNs do_now() const override { return now; }
  Status do_wait_until(TimeNs deadline) override;

  void advance();
  void advance_imu();
  void advance_cameras();
  void advance_lidar();
  double clearance_m() const;

  robot::RobotModel robot;
  TimeNs step;
  TimeNs now;
  double goal_x_m;
  Terrain terrain;
  TerrainIndex index;
  SolidIndex solids;
  Walkers walkers;
  std::unique_ptr<Plant> plant;
  Obstacle obstacle;
  SimImuPort imu;
  SimDepthCameraPort camera;
  std::unique_ptr<SimStereoCameraPort> stereo;  // null: the robot has none
  SimLidarPort lidar;
  SimPosePort tracking;
  Vector3 mount_velocity_W;
  std::uint64_t steps = 0;
  std::uint64_t obstacle_steps = 0;
};

Status Simulator::Implementation::do_wait_until(TimeNs deadline) {
  if (now > deadline) return Status::kTimeout;
  while (now < deadline) advance();
  return Status::kOk;
}

void Simulator::Implementation::advance_imu() {
  const Vector3 velocity = plant->point_velocity_W(imu.mount_B_m());
  const Vector3 acceleration = (velocity - mount_velocity_W) / step.seconds();
  mount_velocity_W = velocity;
  const Matrix3 to_B = plant->rotation().transpose();
  imu.advance(now, step.seconds(), to_B * (acceleration + Vector3(0, 0, kGravity_m_s2)),
              to_B * plant->angular_velocity_W());
}

void Simulator::Implementation::advance_cameras() {
  camera.advance(now);
  if (camera.due(now)) {
    camera.expose(now, plant->position_m(), plant->rotation(), plant->leg_shapes());
  }
  if (stereo == nullptr) return;
  stereo->advance(now);
  if (stereo->triggered()) {
    stereo->expose(now, plant->position_m(), plant->rotation(), plant->leg_shapes());
  }
}

void Simulator::Implementation::advance_lidar() {
  if (robot.lidar.rate_Hz <= 0) return;
  lidar.advance(now, plant->position_m(), plant->rotation(), walkers.solids(),
                obstacle.exists() ? &obstacle.box() : nullptr);
}

double Simulator::Implementation::clearance_m() const {
  if (solids.empty() && walkers.solids().empty()) return kMaxClearance_m;
  return Footprint(robot)
      .clearance(plant->position_m(), plant->rotation(), solids, walkers, kMaxClearance_m)
      .distance_m;
}

// One physics step: everything that happens by now + step.
void Simulator::Implementation::advance() {
  plant->step(now);
  if (plant->on_obstacle()) ++obstacle_steps;
  if (obstacle.follow(plant->position_m().x())) plant->place_obstacle(obstacle.box());
  ++steps;
  now = now + step;
  if (!walkers.solids().empty()) {
    walkers.place(now.seconds());
    plant->place_walkers(walkers);
  }
  advance_imu();
  if (robot.tracking_camera.rate_Hz > 0) {
    tracking.advance(now, plant->position_m(), plant->rotation());
  }
  advance_cameras();
  advance_lidar();
}

Simulator::Simulator(const robot::RobotModel& robot, const WorldSpec& world,
                     const SimulatorConfig& config, std::uint64_t seed) {
  check(config, robot);
  implementation_ = std::make_unique<Implementation>(robot, world, config, seed);
}

Simulator::~Simulator() = default;

hal::Board Simulator::board() {
  Implementation& sim = *implementation_;
  hal::Board board;
  board.clock = &sim;
  board.imu = &sim.imu;
  if (sim.robot.depth_camera.rate_Hz > 0) board.depth_camera = &sim.camera;
  board.stereo_camera = sim.stereo.get();
  if (sim.robot.lidar.rate_Hz > 0) board.lidar = &sim.lidar;
  if (sim.robot.tracking_camera.rate_Hz > 0) board.pose = &sim.tracking;
  sim.plant->attach(board);
  return board;
}

Truth Simulator::truth() const {
  const Implementation& sim = *implementation_;
  const Plant& plant = *sim.plant;
  Truth truth;
  truth.stamp = sim.now;
  truth.p_WB_m = to_array(plant.position_m());
  truth.v_WB_m_s = to_array(plant.point_velocity_W(Vector3::Zero()));
  truth.angular_velocity_B_rad_s =
      to_array(plant.rotation().transpose() * plant.angular_velocity_W());
  plant.tell(truth);
  truth.clearance_m = sim.clearance_m();
  for (const Solid& walker : sim.walkers.solids()) {
    const Vector3& p = walker.capsule.a_m;
    truth.walkers_W_m[truth.walker_count++] = {p.x(), p.y()};
  }
  truth.obstacle_steps = sim.obstacle_steps;
  if (sim.obstacle.exists()) {
    const TerrainBox& box = sim.obstacle.box();
    truth.obstacle = {box.x_m, box.y_m, std::atan2(box.sin_yaw, box.cos_yaw)};
  }
  return truth;
}

std::uint64_t Simulator::state_hash() const {
  Fnv64 digest;
  implementation_->plant->hash(digest);
  return digest.value();
}

double Simulator::ground_height_m(double x_m, double y_m) const {
  return implementation_->index.height_m(x_m, y_m);
}

double Simulator::terrain_height_m(double x_m, double y_m) const {
  double ground =
      std::max(implementation_->index.height_m(x_m, y_m), implementation_->solids.top_m(x_m, y_m));
  for (const Solid& walker : implementation_->walkers.solids()) {
    ground = std::max(ground, top_at(walker, x_m, y_m));
  }
  const Obstacle& obstacle = implementation_->obstacle;
  if (!obstacle.exists() || !obstacle.box().covers(x_m, y_m)) return ground;
  return std::max(ground, obstacle.box().top_m);
}

TerrainFigures Simulator::terrain_figures() const {
  return figures_of(implementation_->terrain, implementation_->index, implementation_->goal_x_m);
}

std::vector<SolidTruth> Simulator::solids() const {
  return outlines_of(implementation_->terrain.solids);
}

SimulatorCounters Simulator::counters() const {
  const Implementation& sim = *implementation_;
  const DepthCounters& depth = sim.camera.depth_counters();
  SimulatorCounters counters;
  counters.steps = sim.steps;
  counters.ode_messages = ode_messages();
  sim.plant->count(counters);
  counters.depth_rays = depth.rays;
  counters.depth_edge_dropouts = depth.edge_dropouts;
  counters.depth_random_dropouts = depth.random_dropouts;
  counters.depth_out_of_range = depth.out_of_range;
  counters.camera_exposures_lost = depth.exposures_lost;
  if (sim.stereo != nullptr) {
    const StereoImageCounters& stereo = sim.stereo->image_counters();
    counters.stereo_exposures = stereo.exposures;
    counters.stereo_exposures_lost = stereo.exposures_lost;
    counters.stereo_rays = stereo.rays;
  }
  const LidarCounters& lidar = sim.lidar.lidar_counters();
  counters.lidar_beams = lidar.beams;
  counters.lidar_mixed = lidar.mixed;
  counters.lidar_random_dropouts = lidar.random_dropouts;
  counters.lidar_sapling_returns = lidar.sapling_returns;
  counters.lidar_no_returns = lidar.no_returns;
  counters.lidar_scans_lost = lidar.scans_lost;
  counters.imu_samples_lost = sim.imu.lost();
  counters.pose_samples_lost = sim.tracking.pose_counters().lost;
  counters.pose_jumps = sim.tracking.pose_counters().jumps;
  return counters;
}

void Simulator::set_trunk_force(const std::array<double, 3>& force_W_N) {
  implementation_->plant->set_force(Vector3(force_W_N[0], force_W_N[1], force_W_N[2]));
}

}  // namespace surefoot::sim
