// Which feet bear load: ground forces from a momentum observer on the joint torques, judged
// together with the gait's phase.
//
// A torque command alone proves nothing (a leg pushing into the air reports the torque too). The
// observer compares the torque with the momentum the leg gains; what is missing went into the
// ground (generalised-momentum residual, De Luca and Mattone, ICRA 2003), with a constant diagonal
// inertia per joint, which the reflected rotors dominate. A swinging leg that brakes leaves a
// residual too, so a touchdown also needs the foot to have stopped sinking, and far above the
// expected ground it takes a larger force (surprise_force_N): something unmapped was hit.
#pragma once

#include <array>

#include "core/actuation/joint_bus.h"
#include "core/estimation/config.h"
#include "core/math/linear.h"
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

struct FootContact {
  bool in_contact = false;
  std::uint32_t ticks_since_change = 0;
  Vector3 force_O_N = Vector3::Zero();  // ground on foot, estimated
};

class ContactEstimator {
 public:
  void reset(const ContactConfig& config, const robot::RobotModel& model, double tick_s);

  // Joint states in the order of robot::joint_index; R_OB from the attitude estimator.
  void update(const std::array<actuation::JointState, robot::kJoints>& joints,
              const std::array<GaitPhase, robot::kLegs>& gait,
              const std::array<FootMotion, robot::kLegs>& motion, const Matrix3& R_OB);

  const std::array<FootContact, robot::kLegs>& feet() const { return feet_; }

 private:
  Vector3 external_torque_Nm(std::size_t leg, const Vector3& qd_rad_s, const Vector3& torque_Nm);
  void decide(std::size_t leg, const GaitPhase& gait, const FootMotion& motion);

  ContactConfig config_;
  robot::RobotModel model_;
  double tick_s_ = 0;
  Vector3 inertia_kg_m2_ = Vector3::Zero();  // diagonal, per joint of a leg
  bool started_ = false;
  std::array<Vector3, robot::kLegs> integral_Nm_s_;
  std::array<Vector3, robot::kLegs> residual_Nm_;
  std::array<int, robot::kLegs> confirmations_{};
  std::array<FootContact, robot::kLegs> feet_;
};

}  // namespace surefoot::estimation
