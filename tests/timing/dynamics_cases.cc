// Rigid-body dynamics.
#include "core/robot/dynamics.h"
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

}  // namespace

const WorkEntry kDynamicsCases[] = {
    {"dynamics", "links, mass matrix and its inverse, bias forces, four feet",
     [] { return std::unique_ptr<WorkCase>(std::make_unique<RigidBodies>()); }},
    {nullptr, nullptr, nullptr}};

}  // namespace surefoot::timing
