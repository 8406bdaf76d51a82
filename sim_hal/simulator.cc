#include "sim_hal/simulator.h"

#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/math/gravity.h"
#include "sim_hal/robot/articulation.h"
#include "sim_hal/robot/contacts.h"
#include "sim_hal/robot/ode_runtime.h"
#include "sim_hal/robot/pushes.h"
#include "sim_hal/robot/random_pose.h"
#include "sim_hal/robot/sim_can_port.h"
#include "sim_hal/sensors/sim_depth_camera_port.h"
#include "sim_hal/sensors/sim_imu_port.h"
#include "sim_hal/sensors/sim_pose_port.h"
#include "sim_hal/sensors/sim_stereo_camera_port.h"
#include "sim_hal/world/obstacle.h"
#include "sim_hal/world/terrain.h"
#include "sim_hal/world/terrain_index.h"

namespace surefoot::sim {

namespace {

constexpr double kSlipThreshold_m_s = 0.005;  // below: creep of the contact solver

// A random start: let go at this clearance; at rest when slower than this for kQuiet_s.
constexpr std::uint64_t kStartStream = 6;
constexpr int kMaxPoseDraws = 1000;
constexpr double kDropHeight_m = 0.02;
constexpr double kMaxFall_s = 15.0;
constexpr double kQuiet_s = 0.3;
constexpr double kQuietJoint_rad_s = 0.02;
constexpr double kQuietTrunk_rad_s = 0.002;

// Under a robot that is set down at (x, 0), whichever way it lies.
double highest_ground_m(const TerrainIndex& index, double x_m) {
  constexpr double kReach_m = 0.6;
  constexpr double kAcross_m = 0.5;
  return std::max(0.0, index.max_height_m(x_m - kReach_m, -kAcross_m, x_m + kReach_m, kAcross_m));
}

std::array<double, 3> array(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

std::array<double, 4> quaternion(dBodyID body) {
  const dReal* q = dBodyGetQuaternion(body);
  return {q[0], q[1], q[2], q[3]};
}

// The ODE world; owns bodies and joints.
class OdeWorld {
 public:
  OdeWorld() {
    start_ode();
    id_ = dWorldCreate();
    dWorldSetGravity(id_, 0, 0, -kGravity_m_s2);
    dWorldSetAutoDisableFlag(id_, 0);
    dWorldSetERP(id_, 0.2);
    dWorldSetCFM(id_, 1e-10);
    dWorldSetMaxAngularSpeed(id_, dInfinity);
    dWorldStepReserveInfo reserve{};
    reserve.struct_size = sizeof reserve;
    reserve.reserve_factor = 1.5F;
    reserve.reserve_minimum = 8U << 20U;  // enough for every contact at once: no growth later
    dWorldSetStepMemoryReservationPolicy(id_, &reserve);
  }
  ~OdeWorld() { dWorldDestroy(id_); }
  OdeWorld(const OdeWorld&) = delete;
  OdeWorld& operator=(const OdeWorld&) = delete;
  dWorldID id() const { return id_; }

 private:
  dWorldID id_;
};

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

}  // namespace

struct Simulator::Implementation final : hal::Clock {
  Implementation(const robot::RobotModel& robot_model, const WorldSpec& world,
                 const SimulatorConfig& configuration, std::uint64_t seed)
      : config(configuration),
        step{std::llround(configuration.physics.step_s * 1e9)},
        terrain(make_terrain(world, seed)),
        index(terrain),
        robot(ode.id(), robot_model, configuration.start, step.seconds()),
        contacts(ode.id(), robot, terrain, index, configuration.physics),
        pushes(configuration.scenario.push, seed),
        obstacle(configuration.scenario.obstacle, terrain.obstacle, seed),
        can(robot_model, configuration.can, configuration.faults, seed),
        imu(robot_model.imu, configuration.imu, configuration.faults, seed),
        camera(robot_model.depth_camera, configuration.depth, configuration.faults, index, seed),
        tracking(robot_model.tracking_camera, configuration.tracking, configuration.faults, seed,
                 robot.trunk_position_m(), robot.trunk_rotation()) {
    dWorldSetContactMaxCorrectingVel(ode.id(), configuration.physics.max_correcting_velocity_m_s);
    if (robot_model.stereo_camera.present) {
      stereo = std::make_unique<SimStereoCameraPort>(
          robot_model.stereo_camera, configuration.stereo, configuration.faults, index, seed);
    }
    if (obstacle.exists()) {
      index.show(&obstacle.box());
      contacts.place_obstacle(obstacle.box());
    }
    set_down(seed);
    mount_velocity_W = robot.trunk_point_velocity_W(imu.mount_B_m());
    exchange_can();
  }

  TimeNs do_now() const override { return now; }
  Status do_wait_until(TimeNs deadline) override;

  void set_down(std::uint64_t seed);
  void come_to_rest();
  void advance();
  void step_bodies();
  void exchange_can();
  void advance_imu();
  std::array<Capsule, 3 * robot::kLegs> leg_shapes() const;
  void advance_cameras();
  void track_slip();

  SimulatorConfig config;
  TimeNs step;
  TimeNs now;
  OdeWorld ode;
  Terrain terrain;
  TerrainIndex index;
  Articulation robot;
  Contacts contacts;
  Pushes pushes;
  Obstacle obstacle;
  SimCanPort can;
  SimImuPort imu;
  SimDepthCameraPort camera;
  std::unique_ptr<SimStereoCameraPort> stereo;  // null: the robot has none
  SimPosePort tracking;
  Vector3 mount_velocity_W;
  Vector3 trunk_force_N = Vector3::Zero();
  std::array<double, robot::kJoints> torques_Nm{};
  std::array<double, robot::kLegs> slip_m{};
  std::uint64_t steps = 0;
  std::uint64_t obstacle_steps = 0;
};

Status Simulator::Implementation::do_wait_until(TimeNs deadline) {
  if (now > deadline) return Status::kTimeout;
  while (now < deadline) advance();
  return Status::kOk;
}

void Simulator::Implementation::exchange_can() {
  std::array<double, robot::kJoints> positions;
  std::array<double, robot::kJoints> velocities;
  for (std::size_t i = 0; i < robot::kJoints; ++i) {
    positions[i] = robot.joint_position_rad(i);
    velocities[i] = robot.joint_velocity_rad_s(i);
  }
  can.advance(now, positions, velocities);
}

void Simulator::Implementation::advance_imu() {
  const Vector3 velocity = robot.trunk_point_velocity_W(imu.mount_B_m());
  const Vector3 acceleration = (velocity - mount_velocity_W) / step.seconds();
  mount_velocity_W = velocity;
  const Matrix3 to_B = robot.trunk_rotation().transpose();
  imu.advance(now, step.seconds(), to_B * (acceleration + Vector3(0, 0, kGravity_m_s2)),
              to_B * robot.trunk_angular_velocity_W());
}

std::array<Capsule, 3 * robot::kLegs> Simulator::Implementation::leg_shapes() const {
  const robot::RobotModel& model = robot.model();
  std::array<Capsule, 3 * robot::kLegs> shapes;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const std::size_t thigh = body_of(robot::joint_index(leg, 1));
    const std::size_t shank = body_of(robot::joint_index(leg, 2));
    const double knee_y = robot::left_sign(leg) * model.knee_offset_m;
    const Vector3 hip = robot.point_W_m(thigh, Vector3(0, knee_y, 0));
    const Vector3 knee = robot.point_W_m(shank, Vector3::Zero());
    const Vector3 foot = robot.point_W_m(shank, Vector3(0, 0, -model.shank_length_m));
    shapes[3 * leg] = {hip, knee, model.thigh_radius_m};
    shapes[3 * leg + 1] = {knee, foot, model.shank_radius_m};
    shapes[3 * leg + 2] = {foot, foot, model.foot_radius_m};
  }
  return shapes;
}

void Simulator::Implementation::advance_cameras() {
  camera.advance(now);
  if (camera.due(now)) {
    camera.expose(now, robot.trunk_position_m(), robot.trunk_rotation(), leg_shapes());
  }
  if (stereo == nullptr) return;
  stereo->advance(now);
  if (stereo->triggered()) {
    stereo->expose(now, robot.trunk_position_m(), robot.trunk_rotation(), leg_shapes());
  }
}

void Simulator::Implementation::track_slip() {
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const ShapeContact& foot = contacts.shape(Contacts::shape_of(leg, Shape::kFoot));
    const double speed = foot.slip_velocity_m_s.norm();
    if (foot.touching && speed > kSlipThreshold_m_s) slip_m[leg] += speed * step.seconds();
  }
}

void Simulator::Implementation::step_bodies() {
  contacts.collide();
  dWorldStep(ode.id(), step.seconds());
  contacts.collect();
  robot.update();
}

// Before the run begins. A draw in which the robot is inside itself is no pose.
void Simulator::Implementation::set_down(std::uint64_t seed) {
  const StartConfig& start = config.scenario.start;
  if (start.kind == StartConfig::Kind::kFolded) {
    if (start.x_m != 0.0) {
      const Vector3 place = robot.trunk_position_m();
      const double ground_m = highest_ground_m(index, start.x_m);
      robot.set_down(robot.trunk_rotation(), robot.leg_angles_rad(), place.x() + start.x_m,
                     place.y(), ground_m + config.start.drop_height_m);
    }
    return;
  }
  Random random(seed, kStartStream);
  const double lowest_m = highest_ground_m(index, start.x_m) + kDropHeight_m;
  for (int draw = 0; draw < kMaxPoseDraws; ++draw) {
    const Matrix3 R_WB = random_rotation(random);
    robot.set_down(R_WB, random_legs(robot.model(), random), start.x_m, 0.0, lowest_m);
    if (contacts.self_overlap_m() == 0.0) break;
  }
  come_to_rest();
}

// Limp, drives off, until nothing has moved for a while.
void Simulator::Implementation::come_to_rest() {
  double quiet_s = 0;
  const auto most = static_cast<int>(kMaxFall_s / step.seconds());
  for (int i = 0; i < most && quiet_s < kQuiet_s; ++i) {
    robot.apply({});
    step_bodies();
    quiet_s = robot.fastest_joint_rad_s() < kQuietJoint_rad_s &&
                      robot.trunk_angular_velocity_W().norm() < kQuietTrunk_rad_s
                  ? quiet_s + step.seconds()
                  : 0.0;
  }
}

// One physics step: torques from the drives at `now`, then everything that happens by now + step.
void Simulator::Implementation::advance() {
  torques_Nm = can.torques_Nm(now);
  robot.apply(torques_Nm);
  const Matrix3 R_WB = robot.trunk_rotation();
  const Vector3 left_W = Vector3(-R_WB(1, 0), R_WB(0, 0), 0).normalized();
  const Vector3 force = trunk_force_N + pushes.force_W_N(now, left_W);
  if (force.squaredNorm() > 0) {
    const Vector3 p = robot.trunk_position_m();
    dBodyAddForceAtPos(robot.body(0), force.x(), force.y(), force.z(), p.x(), p.y(), p.z());
  }
  step_bodies();
  if (contacts.on_obstacle()) ++obstacle_steps;
  if (obstacle.follow(robot.trunk_position_m().x())) contacts.place_obstacle(obstacle.box());
  ++steps;
  now = now + step;
  track_slip();
  exchange_can();
  advance_imu();
  if (robot.model().tracking_camera.rate_Hz > 0) {
    tracking.advance(now, robot.trunk_position_m(), robot.trunk_rotation());
  }
  advance_cameras();
}

Simulator::Simulator(const robot::RobotModel& robot, const WorldSpec& world,
                     const SimulatorConfig& config, std::uint64_t seed) {
  check(config, robot);
  implementation_ = std::make_unique<Implementation>(robot, world, config, seed);
}

Simulator::~Simulator() = default;

hal::Board Simulator::board() {
  hal::Board board;
  board.clock = implementation_.get();
  board.can = &implementation_->can;
  board.imu = &implementation_->imu;
  const bool sees_depth = implementation_->robot.model().depth_camera.rate_Hz > 0;
  board.depth_camera = sees_depth ? &implementation_->camera : nullptr;
  board.stereo_camera = implementation_->stereo.get();
  const bool tracks = implementation_->robot.model().tracking_camera.rate_Hz > 0;
  board.pose = tracks ? &implementation_->tracking : nullptr;
  return board;
}

Truth Simulator::truth() const {
  const Implementation& sim = *implementation_;
  const Articulation& robot = sim.robot;
  Truth truth;
  truth.stamp = sim.now;
  truth.p_WB_m = array(robot.trunk_position_m());
  truth.q_WB_wxyz = quaternion(robot.body(0));
  truth.v_WB_m_s = array(robot.trunk_point_velocity_W(Vector3::Zero()));
  truth.angular_velocity_B_rad_s =
      array(robot.trunk_rotation().transpose() * robot.trunk_angular_velocity_W());
  for (std::size_t i = 0; i < robot::kJoints; ++i) {
    truth.joints[i] = {robot.joint_position_rad(i), robot.joint_velocity_rad_s(i),
                       sim.torques_Nm[i]};
  }
  const Vector3 foot_m(0, 0, -robot.model().shank_length_m);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const std::size_t shank = body_of(robot::joint_index(leg, 2));
    const ShapeContact& contact = sim.contacts.shape(Contacts::shape_of(leg, Shape::kFoot));
    FootTruth& foot = truth.feet[leg];
    foot.p_WF_m = array(robot.point_W_m(shank, foot_m));
    foot.v_WF_m_s = array(robot.point_velocity_W(shank, foot_m));
    foot.force_W_N = array(contact.force_N);
    foot.contact = contact.touching;
    foot.slip_speed_m_s = contact.touching ? contact.slip_velocity_m_s.norm() : 0.0;
    foot.slip_m = sim.slip_m[leg];
    truth.leg_contact[leg] = sim.contacts.shape(Contacts::shape_of(leg, Shape::kShank)).touching ||
                             sim.contacts.shape(Contacts::shape_of(leg, Shape::kThigh)).touching;
  }
  truth.trunk_contact = sim.contacts.shape(Contacts::kTrunk).touching;
  truth.obstacle_steps = sim.obstacle_steps;
  if (sim.obstacle.exists()) {
    const TerrainBox& box = sim.obstacle.box();
    truth.obstacle = {box.x_m, box.y_m, std::atan2(box.sin_yaw, box.cos_yaw)};
  }
  truth.mechanical_energy_J = robot.mechanical_energy_J(kGravity_m_s2);
  return truth;
}

std::uint64_t Simulator::state_hash() const {
  Fnv64 digest;
  implementation_->robot.hash(digest);
  return digest.value();
}

double Simulator::terrain_height_m(double x_m, double y_m) const {
  const double ground = implementation_->index.height_m(x_m, y_m);
  const Obstacle& obstacle = implementation_->obstacle;
  if (!obstacle.exists() || !obstacle.box().covers(x_m, y_m)) return ground;
  return std::max(ground, obstacle.box().top_m);
}

TerrainFigures Simulator::terrain_figures() const {
  constexpr double kCell_m = 0.01;
  const auto nx = static_cast<std::size_t>(std::llround(kGoalX_m / kCell_m)) + 1;
  const auto ny = static_cast<std::size_t>(std::llround(kLaneWidth_m / kCell_m)) + 1;
  std::vector<double> z(nx * ny);
  TerrainFigures figures;
  double sum = 0;
  double squares = 0;
  for (std::size_t j = 0; j < ny; ++j) {
    for (std::size_t i = 0; i < nx; ++i) {
      const double x = kCell_m * static_cast<double>(i);
      const double y = kCell_m * static_cast<double>(j) - kLaneWidth_m / 2;
      const double height = implementation_->index.height_m(x, y);
      z[j * nx + i] = height;
      sum += height;
      squares += height * height;
      figures.max_height_m = std::max(figures.max_height_m, height);
      if (i > 0)
        figures.max_step_m = std::max(figures.max_step_m, std::fabs(height - z[j * nx + i - 1]));
      if (j > 0)
        figures.max_step_m = std::max(figures.max_step_m, std::fabs(height - z[(j - 1) * nx + i]));
    }
  }
  const auto count = static_cast<double>(nx * ny);
  const double mean = sum / count;
  figures.rms_m = std::sqrt(std::max(0.0, squares / count - mean * mean));
  const Terrain& terrain = implementation_->terrain;
  figures.boxes = static_cast<std::uint32_t>(terrain.boxes.size());
  figures.cover = clutter_cover(terrain);
  figures.bridged_cells = terrain.bridged_cells;
  figures.tiles = terrain.tiles;
  return figures;
}

SimulatorCounters Simulator::counters() const {
  const Implementation& sim = *implementation_;
  const DepthCounters& depth = sim.camera.depth_counters();
  SimulatorCounters counters;
  counters.steps = sim.steps;
  counters.ode_messages = ode_messages();
  counters.contacts_dropped = sim.contacts.dropped();
  counters.replies_lost = sim.can.replies_lost();
  counters.frames_unanswered = sim.can.frames_unanswered();
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
  counters.imu_samples_lost = sim.imu.lost();
  counters.pose_samples_lost = sim.tracking.pose_counters().lost;
  counters.pose_jumps = sim.tracking.pose_counters().jumps;
  counters.deepest_self_overlap_m = sim.contacts.deepest_self_overlap_m();
  return counters;
}

void Simulator::set_trunk_force(const std::array<double, 3>& force_W_N) {
  implementation_->trunk_force_N = Vector3(force_W_N[0], force_W_N[1], force_W_N[2]);
}

}  // namespace surefoot::sim
