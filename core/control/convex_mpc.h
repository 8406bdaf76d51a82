// Predictive control of the trunk: the feet's forces over the next ten steps of the horizon.
//
// Model: one rigid body on massless legs (Di Carlo et al., IROS 2018; Kim et al. 2019, whose
// control paper 002 uses, section IV), linear about the reference: angles change as T(yaw) omega,
// the inertia turns with the reference's yaw, levers run from the reference's place to the contacts
// that the gait and the foothold plan name. Zero-order hold is exact: the model is nilpotent, its
// exponential ends at dt^2.
//
//   minimise  sum over steps |x - x_reference|^2_weights + effort |f|^2
//   subject to, per standing foot:  |fx|, |fy| <= mu fz,  min <= fz <= max
//
// Plain data in, plain data out; solve() touches nothing else, so it can run as a slow task.
// Forces are feasible whatever happens: see MpcSource for what they are when there is no solution.
//
// Cost: the same number of operations for every input (README.md, docs/timing.md). Memory: members,
// below 80 kB. Frames: O (gravity-aligned), B; units in the names.
#pragma once

#include <array>
#include <cstdint>

#include "core/control/config.h"
#include "core/control/horizon_qp.h"
#include "core/math/linear.h"
#include "core/robot/robot_model.h"

namespace surefoot::control {

inline constexpr std::size_t kMpcHorizon = HorizonQp::kHorizon;

// Where the body should be, or is predicted to be, at the end of a step.
struct MpcState {
  Vector3 p_OB_m = Vector3::Zero();
  Vector3 v_OB_m_s = Vector3::Zero();
  Vector3 roll_pitch_yaw_rad = Vector3::Zero();
  Vector3 angular_velocity_O_rad_s = Vector3::Zero();
};

struct MpcProblem {
  // Present state. B's origin stands for the centre of mass.
  Matrix3 R_OB = Matrix3::Identity();
  Vector3 p_OB_m = Vector3::Zero();
  Vector3 v_OB_m_s = Vector3::Zero();
  Vector3 angular_velocity_O_rad_s = Vector3::Zero();
  double mass_kg = 0;
  Matrix3 inertia_B_kg_m2 = Matrix3::Identity();

  // Entry k is step k: from k dt to (k + 1) dt after the present; the reference is for its end. Yaw
  // may be wrapped or not.
  std::array<MpcState, kMpcHorizon> reference;
  std::array<std::array<bool, robot::kLegs>, kMpcHorizon> stands{};
  // Where the ground is touched (one radius below the foot's centre); read for feet that stand.
  std::array<std::array<Vector3, robot::kLegs>, kMpcHorizon> contact_O_m;

  // Steps of the horizon since the last problem, 0 when it is the same step still: the last
  // solution, moved by as much, is the start of this one. Anything above the horizon: a new start.
  std::uint32_t steps_since_last = 0;
};

// Where the forces come from.
enum class MpcSource : std::uint8_t {
  kSolved = 0,  // the program's solution
  kShifted,     // the last solution, moved to the present: residual above the bound or not finite
  kWeight,      // the weight shared by the standing feet: no last solution, or another contact plan
};

struct MpcSolution {
  // Ground on foot, constant during a step; zero for feet that do not stand.
  std::array<std::array<Vector3, robot::kLegs>, kMpcHorizon> force_O_N;
  // What the model makes of these forces, at the end of each step. Yaw is continuous from the
  // present one in (-pi, pi].
  std::array<MpcState, kMpcHorizon> predicted;
  double residual_N = 0;  // of the solver, whatever the source is
  std::uint32_t iterations = 0;
  std::uint32_t fallbacks = 0;  // since reset: how often the source was not kSolved
  MpcSource source = MpcSource::kWeight;
};

class ConvexMpc {
 public:
  void reset(const MpcConfig& config);
  // A problem that is not finite, or whose mass or inertia is not positive, gives the fallback and
  // predicts a body at rest in the reference.
  const MpcSolution& solve(const MpcProblem& problem);
  const MpcSolution& solution() const { return solution_; }

 private:
  using Row36 = Eigen::Matrix<double, 3, 6>;
  using Wrench = Vector6;
  using StepForces = std::array<Vector3, robot::kLegs>;

  struct Step {
    Matrix3 angle_rate;       // T: angle rates from angular velocity in O
    Matrix3 inverse_inertia;  // O axes
    std::array<Vector3, robot::kLegs> lever_O_m;
    double force_root = 0;  // C = [force_root I, 0; moment_root]
    Row36 moment_root;
    MpcState reference;  // yaw continuous
    MpcState free;       // end of the step without any force
  };

  void describe_steps(const MpcProblem& problem);
  void describe_contacts(const MpcProblem& problem, std::size_t k);
  void coast(const MpcProblem& problem);
  void condense(const MpcProblem& problem);
  void condense_motion(double mass_kg);
  void condense_turning();
  void bound_forces(const MpcProblem& problem);
  bool take_solution(const MpcProblem& problem);
  void fall_back(const MpcProblem& problem, bool plan_continues);
  void predict(const MpcProblem& problem);
  bool same_first_step(const MpcProblem& problem) const;
  Vector3 feasible(const Vector3& force_O_N) const;

  MpcConfig config_;
  std::array<Step, kMpcHorizon> steps_;
  // Angles at the end of step k per angular acceleration in step j <= k.
  std::array<std::array<Matrix3, kMpcHorizon>, kMpcHorizon> angle_response_;
  std::array<Row36, kMpcHorizon> turning_;  // angular acceleration per unit of C's columns
  HorizonQp qp_;
  MpcSolution solution_;
  std::array<std::array<bool, robot::kLegs>, kMpcHorizon> stood_{};  // of the last problem
  bool has_last_ = false;
};

}  // namespace surefoot::control
