// Rigid-body dynamics and what stands on it.
#include "core/control/whole_body.h"
#include "core/robot/dynamics.h"
#include "core/robot/kinematics.h"
#include "tests/timing/work_case.h"

namespace surefoot::timing {
namespace {

// A moving robot: all of what whole-body control asks of the dynamics in one tick.
class RigidBodies final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    dynamics_.reset(load({}).robot);
    for (int i = 0; i < robot::kVelocities; ++i) state_.velocity[i] = 0.1 * (i - 8);
    for (int i = 0; i < 12; ++i) state_.q_rad[i] = i % 3 == 0 ? 0.1 : (i % 3 == 1 ? -0.8 : 1.6);
    return true;
  }
  void run() override {
    dynamics_.update(state_);
    dynamics_.mass_matrix(mass_);
    bias_ = dynamics_.bias();
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) feet_[leg] = dynamics_.foot(leg);
    positive_ = factor_.factor(mass_);
    factor_.inverse(inverse_);
  }
  bool did_the_work() override {
    const double error = (mass_ * inverse_ - robot::MassMatrix::Identity()).norm();
    return positive_ && error < 1e-9 && bias_.allFinite() && feet_[3].p_B_m[0] < 0;
  }

 private:
  robot::Dynamics dynamics_;
  robot::MotionState state_;
  robot::MassMatrix mass_;
  robot::MassMatrix inverse_;
  robot::MassFactor factor_;
  robot::GeneralisedVector bias_;
  std::array<robot::PointMotion, robot::kLegs> feet_;
  bool positive_ = false;
};

// One tick of whole-body control while the robot trots (two feet on the ground) or stands on four
// feet that are asked for more than friction gives.
template <bool kTrot>
class WholeBodyTick final : public WorkCase {
 public:
  bool prepare(std::size_t round) override {
    if (round > 0) return false;
    const apps::Config config = load({});
    control_.reset(config.autonomy.control.whole_body, config.robot);
    state_.p_OB_m = Vector3(0, 0, config.autonomy.control.body.height_m);
    state_.v_OB_m_s = Vector3(0.5, 0.02, -0.03);
    state_.angular_velocity_B_rad_s = Vector3(0.1, -0.2, 0.05);
    body_.p_OB_m = state_.p_OB_m + Vector3(0.01, 0.0, 0.005);
    body_.v_OB_m_s = Vector3(0.5, 0, 0);
    for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
      Vector3 foot = robot::hip_joint_B_m(config.robot, leg);
      foot[2] = config.robot.foot_radius_m - state_.p_OB_m[2];
      state_.q_rad.segment<3>(static_cast<Eigen::Index>(3 * leg)) =
          robot::solve_leg(config.robot, leg, foot).q_rad;
      LegTask& task = legs_[leg];
      task.in_contact = !kTrot || leg == 0 || leg == 3;
      task.force_O_N = kTrot ? Vector3(5, 2, 44) : Vector3(30, -25, 22);
      task.position_O_m = state_.p_OB_m + foot + Vector3(0.02, 0, 0.04);
      task.velocity_O_m_s = Vector3(1.5, 0, 0.3);
      for (int i = 0; i < 3; ++i) state_.qd_rad_s[static_cast<int>(3 * leg) + i] = 1.0 - i;
    }
    return true;
  }
  void run() override { command_ = &control_.update(state_, body_, legs_); }
  bool did_the_work() override {
    const bool loaded = command_->force_O_N[0][2] > 5.0 && command_->force_O_N[3][2] > 5.0;
    return control_.counters().refused == 0 && loaded && command_->torque_Nm.norm() > 1.0;
  }

 private:
  using LegTask = control::LegTask;

  control::WholeBody control_;
  control::WholeBodyState state_;
  control::BodyTask body_;
  control::LegTasks legs_;
  const control::WholeBodyCommand* command_ = nullptr;
};

template <class Case>
std::unique_ptr<WorkCase> make() {
  return std::make_unique<Case>();
}

}  // namespace

const WorkEntry kDynamicsCases[] = {
    {"dynamics", "links, mass matrix and its inverse, bias forces, four feet", make<RigidBodies>},
    {"whole_body_trot", "whole-body control, two feet on the ground", make<WholeBodyTick<true>>},
    {"whole_body_stand", "whole-body control, four feet beyond friction",
     make<WholeBodyTick<false>>},
    {nullptr, nullptr, nullptr}};

}  // namespace surefoot::timing
