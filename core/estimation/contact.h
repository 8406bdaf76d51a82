// Which feet bear load: ground forces from the joint torques, judged together with the gait.
//
// A torque command alone proves nothing (a leg pushing into the air reports the torque too). The
// torques that the motion needs without the ground come from the dynamics of the whole robot
// (robot/dynamics.h) with measured accelerations: joints by difference, trunk from the IMU. What
// is missing came through the feet. First-order low-pass: this is the residual of the momentum
// observer (De Luca and Mattone, ICRA 2003), of M nu' + C nu + g - tau instead of its integral.
//
// A touchdown also needs the foot to have stopped sinking, and far above the expected ground it
// takes a larger force (surprise_force_N): something unmapped was hit.
//
// Cost: one inverse dynamics of 18 velocities, four 3 x 3 inverses.
#pragma once

#include <array>

#include "core/actuation/joint_bus.h"
#include "core/estimation/config.h"
#include "core/math/linear.h"
#include "core/robot/dynamics.h"
#include "core/robot/kinematics.h"
#include "core/robot/robot_model.h"

namespace surefoot::estimation {

// What the gait says about one leg at this tick.
struct GaitPhase {
  bool stance_planned = true;
  double swing_progress = 0;          // 0..1 within a planned swing
  double height_above_landing_m = 0;  // of a swinging foot over the place it is meant to reach
};

// A foot's motion as the joints and the body's velocity show it.
struct FootMotion {
  Matrix3 jacobian_B = Matrix3::Zero();
  double vertical_velocity_O_m_s = 0;
};

// Of the trunk, as the IMU shows it.
struct TrunkMotion {
  Matrix3 R_OB = Matrix3::Identity();
  Vector3 angular_velocity_B_rad_s = Vector3::Zero();
  Vector3 specific_force_B_m_s2 = Vector3::Zero();  // of B's origin
};

struct FootContact {
  bool in_contact = false;
  std::uint32_t ticks_since_change = 0;
  Vector3 force_O_N = Vector3::Zero();  // ground on foot, estimated
};

class ContactEstimator {
 public:
  void reset(const ContactConfig& config, const robot::RobotModel& model, double tick_s);

  // Joint states in the order of robot::joint_index.
  void update(const std::array<actuation::JointState, robot::kJoints>& joints,
              const std::array<GaitPhase, robot::kLegs>& gait,
              const std::array<FootMotion, robot::kLegs>& motion, const TrunkMotion& trunk);

  const std::array<FootContact, robot::kLegs>& feet() const { return feet_; }

 private:
  void observe_torques(const std::array<actuation::JointState, robot::kJoints>& joints,
                       const TrunkMotion& trunk);
  void decide(std::size_t leg, const GaitPhase& gait, const FootMotion& motion);

  ContactConfig config_;
  robot::RobotModel model_;
  double tick_s_ = 0;
  robot::Dynamics dynamics_;
  bool started_ = false;
  robot::GeneralisedVector velocity_ = robot::GeneralisedVector::Zero();  // of the last tick
  robot::JointVector external_Nm_ = robot::JointVector::Zero();           // low-passed
  std::array<int, robot::kLegs> confirmations_{};
  std::array<FootContact, robot::kLegs> feet_;
};

}  // namespace surefoot::estimation
