// Rigid-body dynamics of the floating-base quadruped: 13 links, 18 velocities, closed memory.
//
// Algorithms (R. Featherstone, Rigid Body Dynamics Algorithms, 2008): recursive Newton-Euler
// (section 5.3), composite rigid bodies (6.2), branch-induced sparsity (6.5: legs couple through
// the trunk alone), floating base (9.1 to 9.4). All spatial vectors of all links are written in ONE
// frame, B (axes and origin), so that no transform is needed between links: composite inertias and
// forces just add up. B is treated as an inertial frame that coincides with the trunk now.
//
// Generalised velocity nu (18), in this order:
//   0..2   angular velocity of the trunk, axes of B [rad/s]
//   3..5   velocity of B's origin relative to O, AXES OF B [m/s] (v_B = R_OB^T v_OB)
//   6..17  joint velocities, index 6 + joint_index(leg, joint) [rad/s]
// Generalised acceleration: the time derivatives of these NUMBERS. So, of the trunk,
//   angular acceleration of the trunk in O:    R_OB * acceleration[0..2]
//   acceleration of B's origin in O:           R_OB * (acceleration[3..5] + w_B x v_B)
// Generalised force: moment on the trunk about B's origin, force on the trunk (both in axes of B),
// then the joint torques; its product with nu is power.
//
// Rotors: their mass sits where the simulator puts it (abduction's in the trunk at the joint, hip's
// in the abad link at the hip, knee's in the thigh at the hip), as points. Their reflected inertia
// n^2 J is added to the joint's DIAGONAL entry of the mass matrix: exact for the joint's own
// acceleration, it leaves out the gyroscopic coupling n J of a rotor with the trunk's rotation.
//
// Memory: sizeof(Dynamics) about 5 kB, no heap. Cost: tests/timing, case dynamics.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Cholesky>

#include "core/math/linear.h"
#include "core/robot/robot_model.h"

namespace surefoot::robot {

inline constexpr int kVelocities = 6 + static_cast<int>(kJoints);
inline constexpr std::size_t kLinks = 1 + kJoints;  // trunk, then abad, thigh, shank of each leg

using JointVector = Eigen::Matrix<double, static_cast<int>(kJoints), 1>;
using GeneralisedVector = Eigen::Matrix<double, kVelocities, 1>;
using MassMatrix = Eigen::Matrix<double, kVelocities, kVelocities>;
using Matrix6x3 = Eigen::Matrix<double, 6, 3>;

// First row of a leg's joints in a generalised vector.
constexpr Eigen::Index velocity_row(std::size_t leg) {
  return 6 + static_cast<Eigen::Index>(leg * kJointsPerLeg);
}

// Spatial motion: angular, and linear of the point at B's origin. Axes of B.
struct Motion {
  Vector3 angular = Vector3::Zero();
  Vector3 linear = Vector3::Zero();
};

// Spatial force: moment about B's origin, force. Axes of B.
struct Wrench {
  Vector3 moment = Vector3::Zero();
  Vector3 force = Vector3::Zero();
};

// Spatial inertia in B: mass, first moment, second moment about B's origin.
struct SpatialInertia {
  double mass_kg = 0;
  Vector3 moment_kg_m = Vector3::Zero();
  Matrix3 inertia_kg_m2 = Matrix3::Zero();

  void add(const SpatialInertia& other);
  Wrench operator*(const Motion& motion) const;  // momentum, or force of an acceleration
};

struct MotionState {
  Matrix3 R_OB = Matrix3::Identity();
  JointVector q_rad = JointVector::Zero();
  GeneralisedVector velocity = GeneralisedVector::Zero();
};

// A point of a shank, axes of B. Its velocity relative to O is
//   trunk_linear + trunk_angular x p_B + jacobian_B * qd_leg = point_jacobian_B * nu,
// and its acceleration relative to O, in axes of B, point_jacobian_B * nu' + bias_B_m_s2.
struct PointMotion {
  Vector3 p_B_m = Vector3::Zero();
  Vector3 v_B_m_s = Vector3::Zero();      // relative to O, axes of B
  Vector3 bias_B_m_s2 = Vector3::Zero();  // Jdot nu
  Matrix3 jacobian_B = Matrix3::Zero();   // with respect to the leg's joints alone
};

// The whole robot as one body, axes of B.
struct Centroid {
  double mass_kg = 0;
  Vector3 p_B_m = Vector3::Zero();                       // centre of mass
  Matrix3 inertia_B_kg_m2 = Matrix3::Zero();             // about the centre of mass, joints locked
  Vector3 momentum_B_kg_m_s = Vector3::Zero();           // linear
  Vector3 angular_momentum_B_kg_m2_s = Vector3::Zero();  // about the centre of mass
};

class Dynamics {
 public:
  void reset(const RobotModel& model);

  // Kinematics, velocities and inertias of all links; everything below speaks of this state.
  void update(const MotionState& state);

  // Mass matrix, symmetric positive definite.
  void mass_matrix(MassMatrix& m) const;

  // Generalised force that gives this acceleration under gravity and no contact:
  // M nu' + C nu + g.
  GeneralisedVector inverse_dynamics(const GeneralisedVector& acceleration) const;
  // C nu + g.
  GeneralisedVector bias() const { return inverse_dynamics(GeneralisedVector::Zero()); }

  // The material point of the leg's shank at the foot's centre plus `offset_B_m`. With an offset
  // the bias is that of a ROLLING sphere's contact point: the offset does not turn with the shank.
  PointMotion foot(std::size_t leg, const Vector3& offset_B_m = Vector3::Zero()) const;

  Centroid centroid() const;
  double kinetic_energy_J() const;  // rotors included

  const Vector3& link_position_B_m(std::size_t link) const { return links_[link].p_B_m; }
  const Motion& link_velocity_B(std::size_t link) const { return links_[link].velocity; }

 private:
  struct LinkConstants {  // axes of the link, from its joint; rotor masses included
    double mass_kg = 0;
    Vector3 centre_m = Vector3::Zero();
    Matrix3 inertia_kg_m2 = Matrix3::Zero();  // about the centre of mass
  };
  struct LinkState {
    Vector3 p_B_m = Vector3::Zero();  // its joint
    Motion axis;                      // motion per joint velocity (none for the trunk)
    Motion velocity;
    Motion bias;  // acceleration with nu' = 0, no gravity
    SpatialInertia inertia;
  };

  void set_link(std::size_t link, const Link& data, double rotor_kg, const Vector3& rotor_place_m);
  void place_link(std::size_t link, std::size_t parent, const Matrix3& R_BL, const Vector3& axis_B,
                  const Vector3& p_B_m, double velocity_rad_s);
  static SpatialInertia in_B(const LinkConstants& link, const Matrix3& R_BL, const Vector3& p_B_m);

  RobotModel model_;
  std::array<LinkConstants, kLinks> constants_;
  std::array<double, kJointsPerLeg> armature_kg_m2_{};
  std::array<LinkState, kLinks> links_;
  std::array<Vector3, kLegs> feet_B_m_;
  Matrix3 R_OB_ = Matrix3::Identity();
  JointVector qd_rad_s_ = JointVector::Zero();
};

// 3 x 18 Jacobian of a leg's point in axes of B: velocity = J nu. Multiply by R_OB for axes of O.
Eigen::Matrix<double, 3, kVelocities> point_jacobian_B(std::size_t leg, const PointMotion& point);

// Block factor of a mass matrix that uses its arrow shape (Featherstone 2008, section 6.5): each
// leg's 3 x 3 block is eliminated, what remains on the trunk is its articulated-body inertia.
class MassFactor {
 public:
  // false: not positive definite (never for a valid model and finite joint angles); no solve then.
  bool factor(const MassMatrix& m);
  GeneralisedVector solve(const GeneralisedVector& force) const;
  void inverse(MassMatrix& result) const;

 private:
  std::array<Matrix3, kLegs> leg_inverse_;
  std::array<Matrix6x3, kLegs> coupling_;  // M_0l M_ll^-1
  Eigen::LLT<Matrix6> trunk_;
};

}  // namespace surefoot::robot
