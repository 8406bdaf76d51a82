// The robot in its sagittal plane: five links (trunk, front thigh and shank, hind thigh and shank;
// each leg link stands for a left and right pair), for jumps that are the same left and right
// (paper 002, section V).
//
// State q = (x, z, b, f1, f2, h1, h2): trunk origin in the plane, then the absolute angles of the
// trunk (nose up), front thigh, front shank, hind thigh, hind shank; all about -y, 0 = as with the
// legs straight down. Joint angles: hip = thigh - trunk, knee = shank - thigh. Pitch = -b.
// Torques are those of a pair of legs: twice a joint's.
//
// The rotors' reflected inertia resists the acceleration of its joint alone, as in
// core/robot/dynamics.h and in the simulator.
#pragma once

#include <array>
#include <cmath>

#include "core/math/gravity.h"
#include "core/robot/robot_model.h"

namespace surefoot::apps::jump {

inline constexpr int kCoordinates = 7;
inline constexpr int kPairJoints = 4;  // front hip, front knee, hind hip, hind knee
inline constexpr int kPairForces = 4;  // front x, front z, hind x, hind z

struct PlanarLink {
  double mass_kg = 0;
  double inertia_kg_m2 = 0;  // about the centre of mass
  double centre_x_m = 0;     // from the link's joint, link axes
  double centre_z_m = 0;
};

struct PlanarModel {
  PlanarLink trunk;
  PlanarLink thigh;  // of a pair
  PlanarLink shank;  // of a pair
  double hip_x_m = 0;
  double thigh_length_m = 0;
  double shank_length_m = 0;
  double foot_radius_m = 0;
  double hip_rotor_kg_m2 = 0;  // reflected inertia of a pair
  double knee_rotor_kg_m2 = 0;
  double hip_viscous_Nm_s = 0;  // of a pair
  double knee_viscous_Nm_s = 0;
  double mass_kg() const { return trunk.mass_kg + 2.0 * (thigh.mass_kg + shank.mass_kg); }
};

PlanarModel make_planar_model(const robot::RobotModel& robot);

template <class T>
struct Plane {
  T x{};
  T z{};
};
template <class T>
Plane<T> operator+(const Plane<T>& a, const Plane<T>& b) {
  return {a.x + b.x, a.z + b.z};
}

// A vector fixed to a link, with its derivative by the link's angle and its acceleration.
template <class T>
struct Arm {
  Plane<T> r;
  Plane<T> dr;
  Plane<T> acceleration;
};

template <class T>
struct Rotation {
  T cos{};
  T sin{};
  T rate_squared{};
  T acceleration{};

  Arm<T> arm(double px, double pz) const {
    Arm<T> arm;
    arm.r = {cos * px - sin * pz, sin * px + cos * pz};
    arm.dr = {-arm.r.z, arm.r.x};
    arm.acceleration = {acceleration * arm.dr.x - rate_squared * arm.r.x,
                        acceleration * arm.dr.z - rate_squared * arm.r.z};
    return arm;
  }
};

template <class T>
Rotation<T> rotation(const T& angle, const T& rate, const T& acceleration) {
  using std::cos;
  using std::sin;
  return {cos(angle), sin(angle), rate * rate, acceleration};
}

template <class T>
struct LegPlane {
  Plane<T> knee;  // place
  Plane<T> foot;
  Plane<T> foot_acceleration;
};

template <class T>
struct PlanarMotion {
  std::array<T, kCoordinates> residual{};  // equations of motion: zero when they hold
  std::array<LegPlane<T>, 2> legs;         // front, hind
};

template <class T>
T dot(const Plane<T>& a, const Plane<T>& b) {
  return a.x * b.x + a.z * b.z;
}

// Newton-Euler by virtual work: inertial and weight forces of every link along each coordinate,
// minus those of torques and ground forces. force: ground on a pair of feet, at the contact point
// one radius below the foot's centre (it rolls).
template <class T>
PlanarMotion<T> planar_motion(const PlanarModel& model, const T* q, const T* v, const T* a,
                              const T* torque, const T* force) {
  PlanarMotion<T> out;
  const Rotation<T> trunk = rotation(q[2], v[2], a[2]);
  const Plane<T> weightless{a[0], a[1] + kGravity_m_s2};  // acceleration of the origin, minus g
  const Arm<T> centre = trunk.arm(model.trunk.centre_x_m, model.trunk.centre_z_m);
  const auto inertial = [](double mass, const Plane<T>& acceleration) {
    return Plane<T>{acceleration.x * mass, acceleration.z * mass};
  };
  const Plane<T> trunk_load = inertial(model.trunk.mass_kg, weightless + centre.acceleration);
  out.residual[0] = trunk_load.x;
  out.residual[1] = trunk_load.z;
  out.residual[2] = dot(trunk_load, centre.dr) + a[2] * model.trunk.inertia_kg_m2;
  for (int leg = 0; leg < 2; ++leg) {
    const int i1 = 3 + 2 * leg;
    const int i2 = i1 + 1;
    const Rotation<T> upper = rotation(q[i1], v[i1], a[i1]);
    const Rotation<T> lower = rotation(q[i2], v[i2], a[i2]);
    const Arm<T> hip = trunk.arm(leg == 0 ? model.hip_x_m : -model.hip_x_m, 0.0);
    const Arm<T> thigh = upper.arm(model.thigh.centre_x_m, model.thigh.centre_z_m);
    const Arm<T> knee = upper.arm(0.0, -model.thigh_length_m);
    const Arm<T> shank = lower.arm(model.shank.centre_x_m, model.shank.centre_z_m);
    const Arm<T> foot = lower.arm(0.0, -model.shank_length_m);
    const Plane<T> at_hip = weightless + hip.acceleration;
    const Plane<T> at_knee = at_hip + knee.acceleration;
    const Plane<T> thigh_load = inertial(model.thigh.mass_kg, at_hip + thigh.acceleration);
    const Plane<T> shank_load = inertial(model.shank.mass_kg, at_knee + shank.acceleration);
    const T& fx = force[2 * leg];
    const T& fz = force[2 * leg + 1];
    const Plane<T> ground{fx, fz};
    const Plane<T> below{shank_load.x - fx, shank_load.z - fz};  // carried by the knee
    const Plane<T> all{thigh_load.x + below.x, thigh_load.z + below.z};
    // What the motors' torques leave for the links.
    const T hip_torque = torque[2 * leg] - (v[i1] - v[2]) * model.hip_viscous_Nm_s -
                         (a[i1] - a[2]) * model.hip_rotor_kg_m2;
    const T knee_torque = torque[2 * leg + 1] - (v[i2] - v[i1]) * model.knee_viscous_Nm_s -
                          (a[i2] - a[i1]) * model.knee_rotor_kg_m2;
    out.residual[0] += all.x;
    out.residual[1] += all.z;
    out.residual[2] += dot(all, hip.dr) + hip_torque;
    out.residual[static_cast<std::size_t>(i1)] = dot(thigh_load, thigh.dr) +
                                                 a[i1] * model.thigh.inertia_kg_m2 +
                                                 dot(below, knee.dr) - hip_torque + knee_torque;
    out.residual[static_cast<std::size_t>(i2)] =
        dot(shank_load, shank.dr) + a[i2] * model.shank.inertia_kg_m2 - dot(ground, foot.dr) -
        fx * model.foot_radius_m - knee_torque;
    LegPlane<T>& place = out.legs[static_cast<std::size_t>(leg)];
    const Plane<T> origin{q[0], q[1]};
    place.knee = origin + hip.r + knee.r;
    place.foot = place.knee + foot.r;
    place.foot_acceleration = {
        a[0] + hip.acceleration.x + knee.acceleration.x + foot.acceleration.x,
        a[1] + hip.acceleration.z + knee.acceleration.z + foot.acceleration.z};
  }
  return out;
}

}  // namespace surefoot::apps::jump
