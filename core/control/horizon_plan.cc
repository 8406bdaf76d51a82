#include "core/control/horizon_plan.h"

#include "core/math/elementary.h"
#include "core/robot/kinematics.h"

namespace surefoot::control {
namespace {

// Angular velocity of the reference is its yaw rate alone: roll and pitch follow the ground slowly.
void plan_reference(const HorizonInputs& in, MpcProblem& problem) {
  const BodyReference& reference = in.reference;
  const double step_s = in.config.mpc.step_s;
  Vector3 p_OB_m = reference.p_OB_m;
  double yaw_rad = reference.yaw_rad;
  for (MpcState& state : problem.reference) {
    yaw_rad += reference.yaw_rate_rad_s * step_s;
    const math::SinCos yaw = math::sin_cos(yaw_rad);
    state.v_OB_m_s = Vector3(yaw.cos * in.command.forward_m_s - yaw.sin * in.command.left_m_s,
                             yaw.sin * in.command.forward_m_s + yaw.cos * in.command.left_m_s, 0.0);
    p_OB_m += state.v_OB_m_s * step_s;
    state.p_OB_m = p_OB_m;
    state.roll_pitch_yaw_rad = Vector3(reference.roll_rad, reference.pitch_rad, yaw_rad);
    state.angular_velocity_O_rad_s = Vector3(0.0, 0.0, reference.yaw_rate_rad_s);
  }
}

bool stands_at(const HorizonInputs& in, std::size_t leg, double ahead_s) {
  if (!in.gait_running) return true;
  const bool standing = in.legs[leg].mode == LegMode::kStance;
  const LegPhase& now = in.gait.legs()[leg];
  if (standing && !now.stance && ahead_s < now.remaining_s) return true;
  return in.gait.leg_at(leg, ahead_s).stance;
}

// Where the contact is now, or will be when the swing under way ends.
Vector3 first_contact_O_m(const HorizonInputs& in, std::size_t leg) {
  const LegStatus& status = in.legs[leg];
  const Vector3 centre_O_m =
      status.mode == LegMode::kSwing ? status.foothold.position_O_m : in.state.feet[leg].p_O_m;
  return centre_O_m - Vector3(0.0, 0.0, in.model.foot_radius_m);
}

// Of a step that is not decided yet, taken at the body's reference `at`.
Vector3 next_contact_O_m(const HorizonInputs& in, std::size_t leg, const MpcState& at) {
  const math::SinCos yaw = math::sin_cos(at.roll_pitch_yaw_rad[2]);
  const Vector3 hip_B = stance_hip_B_m(in.model, in.config.foothold, leg);
  const Vector3 symmetry_O_m = at.v_OB_m_s * (0.5 * in.gait.config().stance_s());
  return {at.p_OB_m[0] + yaw.cos * hip_B[0] - yaw.sin * hip_B[1] + symmetry_O_m[0],
          at.p_OB_m[1] + yaw.sin * hip_B[0] + yaw.cos * hip_B[1] + symmetry_O_m[1],
          in.reference.ground_z_m};
}

void plan_contacts(const HorizonInputs& in, std::size_t leg, MpcProblem& problem) {
  const double step_s = in.config.mpc.step_s;
  bool standing = in.legs[leg].mode == LegMode::kStance;
  bool decided = true;  // the next touchdown is the end of a swing under way
  Vector3 contact_O_m = first_contact_O_m(in, leg);
  for (std::size_t k = 0; k < kMpcHorizon; ++k) {
    const double middle_s = (static_cast<double>(k) + 0.5) * step_s;
    const bool stands = k == 0 ? standing : stands_at(in, leg, middle_s);
    if (standing && !stands) decided = false;
    if (!standing && stands && !decided) {
      contact_O_m = next_contact_O_m(in, leg, problem.reference[k]);
    }
    problem.stands[k][leg] = stands;
    problem.contact_O_m[k][leg] = contact_O_m;
    standing = stands;
  }
}

}  // namespace

void plan_horizon(const HorizonInputs& in, MpcProblem& problem) {
  problem.R_OB = in.state.R_OB;
  problem.p_OB_m = in.state.p_OB_m;
  problem.v_OB_m_s = in.state.v_OB_m_s;
  problem.angular_velocity_O_rad_s = in.state.R_OB * in.state.angular_velocity_B_rad_s;
  problem.mass_kg = in.model.total_mass_kg();
  const auto& inertia = in.config.body.inertia_kg_m2;
  problem.inertia_B_kg_m2 = Vector3(inertia[0], inertia[1], inertia[2]).asDiagonal();
  plan_reference(in, problem);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) plan_contacts(in, leg, problem);
}

}  // namespace surefoot::control
