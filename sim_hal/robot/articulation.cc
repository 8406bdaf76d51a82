#include "sim_hal/robot/articulation.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/robot/kinematics.h"

namespace surefoot::sim {

namespace {

constexpr double kTwoPi = 6.28318530717958647693;

Vector3 vector(const dReal* v) { return {v[0], v[1], v[2]}; }

Matrix3 matrix(const dReal* r) {  // ODE pads rows to four
  Matrix3 result;
  result << r[0], r[1], r[2], r[4], r[5], r[6], r[8], r[9], r[10];
  return result;
}

void set_rotation(dBodyID body, const Matrix3& rotation) {
  dMatrix3 r{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) r[row * 4 + column] = rotation(row, column);
  }
  dBodySetRotation(body, r);
}

Vector3 centre(const robot::Link& link) {
  return {link.centre_of_mass_m[0], link.centre_of_mass_m[1], link.centre_of_mass_m[2]};
}

Matrix3 inertia(const robot::Link& link) {
  const auto& i = link.inertia_kg_m2;
  Matrix3 result;
  result << i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2];
  return result;
}

// Inertia of a point mass about the origin.
Matrix3 point_inertia(double mass_kg, const Vector3& p) {
  return mass_kg * (p.squaredNorm() * Matrix3::Identity() - p * p.transpose());
}

// A body put together from parts: mass, first moment and inertia about the link's origin.
struct MassSum {
  double mass_kg = 0;
  Vector3 moment = Vector3::Zero();
  Matrix3 about_origin = Matrix3::Zero();

  void add(double mass, const Vector3& place, const Matrix3& about_place) {
    mass_kg += mass;
    moment += mass * place;
    about_origin += about_place + point_inertia(mass, place);
  }
  Vector3 middle() const { return moment / mass_kg; }
  Matrix3 about_centre() const { return about_origin - point_inertia(mass_kg, middle()); }
};

double stop_torque(double q, double qd, double min_rad, double max_rad, double inertia, double h) {
  // As stiff as one explicit step allows: omega * h = 0.14, damping ratio 0.35.
  const double stiffness = 0.02 * inertia / (h * h);
  const double damping = 0.1 * inertia / h;
  if (q < min_rad) return std::max(0.0, stiffness * (min_rad - q) - damping * qd);
  if (q > max_rad) return std::min(0.0, stiffness * (max_rad - q) - damping * qd);
  return 0.0;
}

}  // namespace

Matrix3 rotation_x(double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  Matrix3 r;
  r << 1, 0, 0, 0, c, -s, 0, s, c;
  return r;
}

Matrix3 rotation_y(double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  Matrix3 r;
  r << c, 0, s, 0, 1, 0, -s, 0, c;
  return r;
}

Matrix3 rotation_z(double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  Matrix3 r;
  r << c, -s, 0, s, c, 0, 0, 0, 1;
  return r;
}

Matrix3 mount_rotation(const robot::SensorMount& mount) {
  const auto& rpy = mount.roll_pitch_yaw_rad;
  return rotation_z(rpy[2]) * rotation_y(rpy[1]) * rotation_x(rpy[0]);
}

Matrix3 optical_rotation(const robot::SensorMount& mount) {
  Matrix3 rotation_XC;
  rotation_XC << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return mount_rotation(mount) * rotation_XC;
}

Articulation::Articulation(dWorldID world, const robot::RobotModel& model, const StartPose& start,
                           double step_s)
    : model_(model), step_s_(step_s) {
  for (dBodyID& body : bodies_) {
    body = dBodyCreate(world);
    dBodySetAutoDisableFlag(body, 0);
    // ODE's own gyroscopic term is implicit for the body as if it were free. The shank, with 6e-6
    // kg m^2 about its long axis and forty times that across, lost energy to it at any step length;
    // apply() adds the explicit term instead.
    dBodySetGyroscopicMode(body, 0);
  }
  build_trunk();
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) build_leg(world, leg);
  place(start);
  if (start.trunk_fixed) {
    const dJointID stand = dJointCreateFixed(world, nullptr);
    dJointAttach(stand, bodies_[0], nullptr);
    dJointSetFixed(stand);
  }
  update();
}

void Articulation::set_mass(std::size_t body, double mass_kg, const Vector3& centre_m,
                            const Matrix3& inertia) {
  dMass mass;
  dMassSetParameters(&mass, mass_kg, 0, 0, 0, inertia(0, 0), inertia(1, 1), inertia(2, 2),
                     inertia(0, 1), inertia(0, 2), inertia(1, 2));
  dBodySetMass(bodies_[body], &mass);
  centres_[body] = centre_m;
  inertias_[body] = inertia;
}

// The abduction motors' rotors sit in the trunk, at their joints.
void Articulation::build_trunk() {
  MassSum sum;
  sum.add(model_.trunk.mass_kg, centre(model_.trunk), inertia(model_.trunk));
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    sum.add(model_.actuators[0].rotor_mass_kg, robot::abduction_joint_B_m(model_, leg),
            Matrix3::Zero());
  }
  set_mass(0, sum.mass_kg, sum.middle(), sum.about_centre());
  dBodySetPosition(bodies_[0], centres_[0].x(), centres_[0].y(), centres_[0].z());
  set_rotation(bodies_[0], Matrix3::Identity());
}

// Built with all joint angles zero. The hip's rotor sits in the abad link at the hip joint, the
// knee's in the thigh at the hip joint (coaxial drives).
//
// ODE has no armature. The reflected inertia n^2 J of a rotor resists the acceleration of its joint
// alone, not that of the parent link, so it is no part of the child's inertia (there, the knee's
// 0.0054 kg m^2 would double what the hip has to turn). It is a hinge motor without a force limit
// that wants the present rate r, softened by the constraint force mixing cfm = step / (n^2 J):
// ODE solves r_new = r - cfm * force, so the force is -n^2 J (r_new - r) / step, implicitly.
void Articulation::build_leg(dWorldID world, std::size_t leg) {
  const double side = robot::left_sign(leg);
  const Vector3 abad_W = robot::abduction_joint_B_m(model_, leg);
  const Vector3 hip_in_abad(0, side * model_.hip_offset_m, 0);
  const Vector3 knee_in_thigh(0, side * model_.knee_offset_m, -model_.thigh_length_m);
  const std::array<Vector3, 3> origins{abad_W, abad_W + hip_in_abad,
                                       abad_W + hip_in_abad + knee_in_thigh};
  const std::array<Vector3, 3> axes{Vector3(1, 0, 0), Vector3(0, -1, 0), Vector3(0, -1, 0)};
  const std::array<const robot::Link*, 3> links{&model_.abad, &model_.thigh, &model_.shank};
  const std::array<double, 3> rotors{model_.actuators[1].rotor_mass_kg,
                                     model_.actuators[2].rotor_mass_kg, 0.0};
  const std::array<Vector3, 3> rotor_places{hip_in_abad, Vector3::Zero(), Vector3::Zero()};
  for (std::size_t k = 0; k < robot::kJointsPerLeg; ++k) {
    const std::size_t joint = robot::joint_index(leg, k);
    const std::size_t body = body_of(joint);
    MassSum sum;
    const robot::Link link = model_.link_of(leg, *links[k]);
    sum.add(link.mass_kg, centre(link), inertia(link));
    if (rotors[k] > 0) sum.add(rotors[k], rotor_places[k], Matrix3::Zero());
    const double armature_kg_m2 = model_.actuators[k].reflected_inertia_kg_m2();
    set_mass(body, sum.mass_kg, sum.middle(), sum.about_centre());
    axis_inertia_[joint] = axes[k].dot(sum.about_origin * axes[k]) + armature_kg_m2;
    const Vector3 centre = origins[k] + centres_[body];
    dBodySetPosition(bodies_[body], centre.x(), centre.y(), centre.z());
    set_rotation(bodies_[body], Matrix3::Identity());
    hinges_[joint] = dJointCreateHinge(world, nullptr);
    const std::size_t parent = k == 0 ? 0 : body - 1;
    dJointAttach(hinges_[joint], bodies_[body], bodies_[parent]);
    dJointSetHingeAnchor(hinges_[joint], origins[k].x(), origins[k].y(), origins[k].z());
    dJointSetHingeAxis(hinges_[joint], axes[k].x(), axes[k].y(), axes[k].z());
    if (armature_kg_m2 > 0.0) {
      dJointSetHingeParam(hinges_[joint], dParamFMax, dInfinity);
      dJointSetHingeParam(hinges_[joint], dParamCFM, step_s_ / armature_kg_m2);
    }
  }
}

void Articulation::place(const StartPose& start) {
  std::array<robot::LegVector, robot::kLegs> legs_rad;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const std::array<double, robot::kJointsPerLeg> pose = model_.pose_of(leg, start.leg_rad);
    legs_rad[leg] = robot::LegVector(pose[0], pose[1], pose[2]);
  }
  set_down(Matrix3::Identity(), legs_rad, 0.0, 0.0, start.drop_height_m);
}

void Articulation::set_down(const Matrix3& R_WB,
                            const std::array<robot::LegVector, robot::kLegs>& legs_rad, double x_m,
                            double y_m, double lowest_m) {
  const Vector3 trunk = R_WB * centres_[0];
  dBodySetPosition(bodies_[0], trunk.x(), trunk.y(), trunk.z());
  set_rotation(bodies_[0], R_WB);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const robot::LegVector& q = legs_rad[leg];
    const Matrix3 abad = R_WB * rotation_x(q[0]);
    const Matrix3 thigh = abad * rotation_y(-q[1]);
    const std::array<Matrix3, 3> rotations{abad, thigh, thigh * rotation_y(-q[2])};
    const robot::LegPoints points = robot::leg_points_B(model_, leg, q);
    for (std::size_t k = 0; k < robot::kJointsPerLeg; ++k) {
      const std::size_t joint = robot::joint_index(leg, k);
      const std::size_t body = body_of(joint);
      const Vector3 p = R_WB * points.p_B_m[k] + rotations[k] * centres_[body];
      dBodySetPosition(bodies_[body], p.x(), p.y(), p.z());
      set_rotation(bodies_[body], rotations[k]);
      positions_[joint] = q[static_cast<Eigen::Index>(k)];
    }
  }
  const double lift = lowest_m - lowest_point_m();
  for (dBodyID body : bodies_) {
    const dReal* p = dBodyGetPosition(body);
    dBodySetPosition(body, p[0] + x_m, p[1] + y_m, p[2] + lift);
    dBodySetLinearVel(body, 0, 0, 0);
    dBodySetAngularVel(body, 0, 0, 0);
  }
}

double Articulation::lowest_point_m() const {
  double lowest = trunk_position_m().z();
  const Matrix3 rotation = trunk_rotation();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    lowest -=
        0.5 * std::fabs(rotation(2, axis)) * model_.trunk_size_m[static_cast<std::size_t>(axis)];
  }
  const double knee_radius = std::max(model_.thigh_radius_m, model_.shank_radius_m);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const std::size_t thigh = body_of(robot::joint_index(leg, 1));
    const std::size_t shank = body_of(robot::joint_index(leg, 2));
    const double hip = point_W_m(thigh, Vector3::Zero()).z();
    const double knee = point_W_m(shank, Vector3::Zero()).z();
    const double foot = point_W_m(shank, Vector3(0, 0, -model_.shank_length_m)).z();
    lowest = std::min(
        {lowest, hip - model_.thigh_radius_m, knee - knee_radius, foot - model_.foot_radius_m});
  }
  return lowest;
}

Matrix3 Articulation::trunk_rotation() const { return matrix(dBodyGetRotation(bodies_[0])); }

Vector3 Articulation::trunk_position_m() const { return point_W_m(0, Vector3::Zero()); }

Vector3 Articulation::trunk_angular_velocity_W() const {
  return vector(dBodyGetAngularVel(bodies_[0]));
}

Vector3 Articulation::trunk_point_velocity_W(const Vector3& p_B_m) const {
  return point_velocity_W(0, p_B_m);
}

Vector3 Articulation::point_W_m(std::size_t body, const Vector3& p_link_m) const {
  return vector(dBodyGetPosition(bodies_[body])) +
         matrix(dBodyGetRotation(bodies_[body])) * (p_link_m - centres_[body]);
}

Vector3 Articulation::point_velocity_W(std::size_t body, const Vector3& p_link_m) const {
  const Vector3 arm = matrix(dBodyGetRotation(bodies_[body])) * (p_link_m - centres_[body]);
  return vector(dBodyGetLinearVel(bodies_[body])) +
         vector(dBodyGetAngularVel(bodies_[body])).cross(arm);
}

void Articulation::apply_gyroscopic_torques() {
  for (std::size_t i = 0; i < kBodies; ++i) {
    const Matrix3 rotation = matrix(dBodyGetRotation(bodies_[i]));
    const Vector3 w = rotation.transpose() * vector(dBodyGetAngularVel(bodies_[i]));
    const Vector3 torque = -w.cross(Vector3(inertias_[i] * w));
    dBodyAddRelTorque(bodies_[i], torque.x(), torque.y(), torque.z());
  }
}

void Articulation::apply(const std::array<double, robot::kJoints>& motor_torque_Nm) {
  apply_gyroscopic_torques();
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    const robot::Actuator& actuator = model_.actuators[joint % robot::kJointsPerLeg];
    const robot::JointRange range = model_.joint_range(joint);
    const double q = positions_[joint];
    const double qd = velocities_[joint];
    // Dry friction, rounded at zero speed; not steeper than one explicit step can carry.
    const double rounding_rad_s =
        std::max(0.1, 2.0 * actuator.dry_friction_Nm * step_s_ / axis_inertia_[joint]);
    const double friction = -actuator.dry_friction_Nm * std::tanh(qd / rounding_rad_s) -
                            actuator.viscous_friction_Nm_s * qd;
    const double stop =
        stop_torque(q, qd, range.min_rad, range.max_rad, axis_inertia_[joint], step_s_);
    dJointAddHingeTorque(hinges_[joint], motor_torque_Nm[joint] + friction + stop);
  }
}

void Articulation::update() {
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    const double angle = dJointGetHingeAngle(hinges_[joint]);  // within one turn
    const double turns = std::round((positions_[joint] - angle) / kTwoPi);
    positions_[joint] = angle + kTwoPi * turns;
    velocities_[joint] = dJointGetHingeAngleRate(hinges_[joint]);
    dJointSetHingeParam(hinges_[joint], dParamVel, velocities_[joint]);  // armature: build_leg()
  }
}

std::array<robot::LegVector, robot::kLegs> Articulation::leg_angles_rad() const {
  std::array<robot::LegVector, robot::kLegs> legs;
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    legs[joint / robot::kJointsPerLeg][static_cast<Eigen::Index>(joint % robot::kJointsPerLeg)] =
        positions_[joint];
  }
  return legs;
}

double Articulation::fastest_joint_rad_s() const {
  double fastest = 0;
  for (const double velocity : velocities_) fastest = std::max(fastest, std::fabs(velocity));
  return fastest;
}

double Articulation::mechanical_energy_J(double gravity_m_s2) const {
  double energy = 0;
  for (dBodyID body : bodies_) {
    dMass mass;
    dBodyGetMass(body, &mass);
    const Vector3 v = vector(dBodyGetLinearVel(body));
    const Matrix3 r = matrix(dBodyGetRotation(body));
    const Vector3 w = r.transpose() * vector(dBodyGetAngularVel(body));
    energy += 0.5 * mass.mass * v.squaredNorm() + 0.5 * w.dot(matrix(mass.I) * w);
    energy += mass.mass * gravity_m_s2 * dBodyGetPosition(body)[2];
  }
  for (std::size_t joint = 0; joint < robot::kJoints; ++joint) {
    const robot::Actuator& actuator = model_.actuators[joint % robot::kJointsPerLeg];
    energy += 0.5 * actuator.reflected_inertia_kg_m2() * velocities_[joint] * velocities_[joint];
  }
  return energy;
}

void Articulation::hash(Fnv64& digest) const {
  const auto put = [&](const dReal* values, int count) {
    for (int i = 0; i < count; ++i) digest.word(std::bit_cast<std::uint64_t>(values[i]), 8);
  };
  for (dBodyID body : bodies_) {
    put(dBodyGetPosition(body), 3);
    put(dBodyGetQuaternion(body), 4);
    put(dBodyGetLinearVel(body), 3);
    put(dBodyGetAngularVel(body), 3);
  }
}

}  // namespace surefoot::sim
