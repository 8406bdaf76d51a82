// The robot as 13 ODE bodies and 12 hinges. Bodies: 0 trunk, then per leg (FR, FL, HR, HL) abad,
// thigh, shank. ODE keeps a body's origin at its centre of mass; this class speaks of link frames,
// whose origins are the joints (robot_model.h).
#pragma once

#include <ode/ode.h>

#include <array>
#include <cstddef>

#include "core/base/hash.h"
#include "core/math/linear.h"
#include "core/robot/kinematics.h"
#include "core/robot/robot_model.h"
#include "sim_hal/simulator_config.h"

namespace surefoot::sim {

inline constexpr std::size_t kBodies = 1 + robot::kJoints;

constexpr std::size_t body_of(std::size_t joint) { return 1 + joint; }

Matrix3 rotation_x(double angle_rad);
Matrix3 rotation_y(double angle_rad);
Matrix3 rotation_z(double angle_rad);
Matrix3 mount_rotation(const robot::SensorMount& mount);  // R_BX
// R_BC: optical axes of a camera in that housing, right = -y, down = -z, forward = x.
Matrix3 optical_rotation(const robot::SensorMount& mount);

class Articulation {
 public:
  // Builds the robot upright over W's origin, its lowest point start.drop_height_m above z = 0. The
  // start pose's abduction angle is mirrored on the right: positive spreads the feet.
  Articulation(dWorldID world, const robot::RobotModel& model, const StartPose& start,
               double step_s);
  Articulation(const Articulation&) = delete;
  Articulation& operator=(const Articulation&) = delete;

  // Moves the bodies, at rest, so that the joints have these angles, the trunk's origin lies over
  // (x, y) of W and the lowest point of the robot at height lowest_m.
  void set_down(const Matrix3& R_WB, const std::array<robot::LegVector, robot::kLegs>& legs_rad,
                double x_m, double y_m, double lowest_m);

  dBodyID body(std::size_t i) const { return bodies_[i]; }
  const robot::RobotModel& model() const { return model_; }

  // Trunk frame B in W.
  Vector3 trunk_position_m() const;
  Matrix3 trunk_rotation() const;
  Vector3 trunk_angular_velocity_W() const;
  // Of the point p_B_m fixed to the trunk, axes of W.
  Vector3 trunk_point_velocity_W(const Vector3& p_B_m) const;
  // A point given in a link's frame, in W.
  Vector3 point_W_m(std::size_t body, const Vector3& p_link_m) const;
  Vector3 point_velocity_W(std::size_t body, const Vector3& p_link_m) const;
  // Link frame origin relative to the body's centre of mass, body axes.
  const Vector3& centre_of_mass_m(std::size_t body) const { return centres_[body]; }

  double joint_position_rad(std::size_t joint) const { return positions_[joint]; }
  double joint_velocity_rad_s(std::size_t joint) const { return velocities_[joint]; }

  std::array<robot::LegVector, robot::kLegs> leg_angles_rad() const;
  double fastest_joint_rad_s() const;

  // Puts motor torques (at the joint, already limited), joint friction and mechanical stops on the
  // bodies for the next step.
  void apply(const std::array<double, robot::kJoints>& motor_torque_Nm);
  // Reads joint angles and speeds after a step. Angles count full turns.
  void update();

  double mechanical_energy_J(double gravity_m_s2) const;
  void hash(Fnv64& digest) const;

 private:
  void build_trunk();
  void build_leg(dWorldID world, std::size_t leg);
  void set_mass(std::size_t body, double mass_kg, const Vector3& centre_m, const Matrix3& inertia);
  void apply_gyroscopic_torques();
  void place(const StartPose& start);
  double lowest_point_m() const;

  robot::RobotModel model_;
  double step_s_;
  std::array<dBodyID, kBodies> bodies_{};
  std::array<dJointID, robot::kJoints> hinges_{};
  std::array<Vector3, kBodies> centres_;               // centre of mass in the link frame
  std::array<Matrix3, kBodies> inertias_;              // about the centre of mass
  std::array<double, robot::kJoints> axis_inertia_{};  // about the joint axis, child link and rotor
  std::array<double, robot::kJoints> positions_{};
  std::array<double, robot::kJoints> velocities_{};
};

}  // namespace surefoot::sim
