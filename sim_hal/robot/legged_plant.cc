#include "sim_hal/robot/legged_plant.h"

#include <algorithm>
#include <cmath>

#include "core/math/gravity.h"
#include "sim_hal/robot/random_pose.h"

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

}  // namespace

LeggedPlant::LeggedPlant(const robot::RobotModel& robot, const SimulatorConfig& config,
                         const Terrain& terrain, const TerrainIndex& index,
                         const SolidIndex& solids, std::uint64_t seed)
    : config_(config),
      step_s_(TimeNs{std::llround(config.physics.step_s * 1e9)}.seconds()),
      index_(index),
      robot_(ode_.id(), robot, config.start, step_s_),
      contacts_(ode_.id(), robot_, terrain, index, solids, config.physics),
      pushes_(config.scenario.push, seed),
      can_(robot, config.can, config.faults, seed) {
  dWorldSetContactMaxCorrectingVel(ode_.id(), config.physics.max_correcting_velocity_m_s);
}

void LeggedPlant::exchange_can(TimeNs now) {
  std::array<double, robot::kJoints> positions;
  std::array<double, robot::kJoints> velocities;
  for (std::size_t i = 0; i < robot::kJoints; ++i) {
    positions[i] = robot_.joint_position_rad(i);
    velocities[i] = robot_.joint_velocity_rad_s(i);
  }
  can_.advance(now, positions, velocities);
}

std::span<const Capsule> LeggedPlant::leg_shapes() {
  const robot::RobotModel& model = robot_.model();
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const std::size_t thigh = body_of(robot::joint_index(leg, 1));
    const std::size_t shank = body_of(robot::joint_index(leg, 2));
    const double knee_y = robot::left_sign(leg) * model.knee_offset_m;
    const Vector3 hip = robot_.point_W_m(thigh, Vector3(0, knee_y, 0));
    const Vector3 knee = robot_.point_W_m(shank, Vector3::Zero());
    const Vector3 foot = robot_.point_W_m(shank, Vector3(0, 0, -model.shank_length_m));
    shapes_[3 * leg] = {hip, knee, model.thigh_radius_m};
    shapes_[3 * leg + 1] = {knee, foot, model.shank_radius_m};
    shapes_[3 * leg + 2] = {foot, foot, model.foot_radius_m};
  }
  return shapes_;
}

void LeggedPlant::track_slip() {
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const ShapeContact& foot = contacts_.shape(Contacts::shape_of(leg, Shape::kFoot));
    const double speed = foot.slip_velocity_m_s.norm();
    if (foot.touching && speed > kSlipThreshold_m_s) slip_m_[leg] += speed * step_s_;
  }
}

void LeggedPlant::step_bodies() {
  contacts_.collide();
  dWorldStep(ode_.id(), step_s_);
  contacts_.collect();
  robot_.update();
}

// Before the run begins. A draw in which the robot is inside itself is no pose.
void LeggedPlant::set_down(std::uint64_t seed) {
  const StartConfig& start = config_.scenario.start;
  if (start.kind == StartConfig::Kind::kFolded) {
    if (start.x_m != 0.0) {
      const Vector3 place = robot_.trunk_position_m();
      const double ground_m = highest_ground_m(index_, start.x_m);
      robot_.set_down(robot_.trunk_rotation(), robot_.leg_angles_rad(), place.x() + start.x_m,
                      place.y(), ground_m + config_.start.drop_height_m);
    }
  } else {
    Random random(seed, kStartStream);
    const double lowest_m = highest_ground_m(index_, start.x_m) + kDropHeight_m;
    for (int draw = 0; draw < kMaxPoseDraws; ++draw) {
      const Matrix3 R_WB = random_rotation(random);
      robot_.set_down(R_WB, random_legs(robot_.model(), random), start.x_m, 0.0, lowest_m);
      if (contacts_.self_overlap_m() == 0.0) break;
    }
    come_to_rest();
  }
  exchange_can({});
}

// Limp, drives off, until nothing has moved for a while.
void LeggedPlant::come_to_rest() {
  double quiet_s = 0;
  const auto most = static_cast<int>(kMaxFall_s / step_s_);
  for (int i = 0; i < most && quiet_s < kQuiet_s; ++i) {
    robot_.apply({});
    step_bodies();
    quiet_s = robot_.fastest_joint_rad_s() < kQuietJoint_rad_s &&
                      robot_.trunk_angular_velocity_W().norm() < kQuietTrunk_rad_s
                  ? quiet_s + step_s_
                  : 0.0;
  }
}

// Torques from the drives at `now`, then what the legs do by now + step.
void LeggedPlant::step(TimeNs now) {
  torques_Nm_ = can_.torques_Nm(now);
  robot_.apply(torques_Nm_);
  const Matrix3 R_WB = robot_.trunk_rotation();
  const Vector3 left_W = Vector3(-R_WB(1, 0), R_WB(0, 0), 0).normalized();
  const Vector3 force = force_W_N_ + pushes_.force_W_N(now, left_W);
  if (force.squaredNorm() > 0) {
    const Vector3 p = robot_.trunk_position_m();
    dBodyAddForceAtPos(robot_.body(0), force.x(), force.y(), force.z(), p.x(), p.y(), p.z());
  }
  step_bodies();
  track_slip();
  exchange_can(now + TimeNs{std::llround(config_.physics.step_s * 1e9)});
}

void LeggedPlant::tell(Truth& truth) const {
  const dReal* q = dBodyGetQuaternion(robot_.body(0));
  truth.q_WB_wxyz = {q[0], q[1], q[2], q[3]};
  for (std::size_t i = 0; i < robot::kJoints; ++i) {
    truth.joints[i] = {robot_.joint_position_rad(i), robot_.joint_velocity_rad_s(i),
                       torques_Nm_[i]};
  }
  const Vector3 foot_m(0, 0, -robot_.model().shank_length_m);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const std::size_t shank = body_of(robot::joint_index(leg, 2));
    const ShapeContact& contact = contacts_.shape(Contacts::shape_of(leg, Shape::kFoot));
    FootTruth& foot = truth.feet[leg];
    foot.p_WF_m = to_array(robot_.point_W_m(shank, foot_m));
    foot.v_WF_m_s = to_array(robot_.point_velocity_W(shank, foot_m));
    foot.force_W_N = to_array(contact.force_N);
    foot.contact = contact.touching;
    foot.slip_speed_m_s = contact.touching ? contact.slip_velocity_m_s.norm() : 0.0;
    foot.slip_m = slip_m_[leg];
    truth.leg_contact[leg] = contacts_.shape(Contacts::shape_of(leg, Shape::kShank)).touching ||
                             contacts_.shape(Contacts::shape_of(leg, Shape::kThigh)).touching;
  }
  truth.trunk_contact = contacts_.shape(Contacts::kTrunk).touching;
  truth.mechanical_energy_J = robot_.mechanical_energy_J(kGravity_m_s2);
}

void LeggedPlant::count(SimulatorCounters& counters) const {
  counters.contacts_dropped = contacts_.dropped();
  counters.replies_lost = can_.replies_lost();
  counters.frames_unanswered = can_.frames_unanswered();
  counters.deepest_self_overlap_m = contacts_.deepest_self_overlap_m();
}

}  // namespace surefoot::sim
