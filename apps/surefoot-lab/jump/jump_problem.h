// The jump as a nonlinear programme: direct transcription with the trapezoidal rule (Betts,
// Practical Methods for Optimal Control, section 4.5) on fixed steps and a fixed contact schedule
// (paper 002, section V).
//
//   minimise    sum over nodes of |joints - final joints|^2 + small terms on torque and speed
//   subject to  equations of motion and rolling contact at every node, trapezoidal steps between
//               nodes, actuator, friction, joint and clearance limits, first and last node fixed
//
// A node holds q, v, a (7 each), 4 pair torques, 4 pair forces, scaled by kScale. Where the contact
// changes there are two nodes at one instant: same q and v, different a, torques and forces.
// All first and second derivatives are exact: automatic differentiation of the node's functions
// (jet.h), the rest is linear or quadratic.
#pragma once

#include <array>
#include <vector>

#include "apps/surefoot-lab/jump/jump_settings.h"
#include "apps/surefoot-lab/jump/planar_model.h"
#include "core/robot/robot_model.h"

namespace surefoot::apps::jump {

inline constexpr int kNodeSize = 3 * kCoordinates + kPairJoints + kPairForces;
inline constexpr int kVelocity = kCoordinates;
inline constexpr int kAcceleration = 2 * kCoordinates;
inline constexpr int kTorque = 3 * kCoordinates;
inline constexpr int kForce = kTorque + kPairJoints;

// Rows of a node's functions.
inline constexpr int kMotionRow = 0;      // equations of motion
inline constexpr int kContactRow = 7;     // acceleration of the contacts: front x z, hind x z
inline constexpr int kFrictionRow = 11;   // front +-, hind +-
inline constexpr int kJointRow = 15;      // hip and knee angles, front, hind
inline constexpr int kSpeedRow = 19;      // torque-speed line, + and - per joint
inline constexpr int kClearanceRow = 27;  // front foot, hind foot, knees, trunk's lower corners
inline constexpr int kCostRow = 33;
inline constexpr int kNodeRows = 34;

enum class JumpPhase { kFourFeet = 0, kTwoFeet, kFlight };

struct JumpNode {
  JumpPhase phase = JumpPhase::kFourFeet;
  double time_s = 0;
  double from_phase_start = 0;  // 0 .. 1
  std::vector<int> rows;        // active ones, without the cost
};

struct Bounds {
  std::vector<double> low;
  std::vector<double> high;
};

struct Entry {
  int row = 0;
  int column = 0;
};

// Units of a node's scaled variables.
constexpr double scale_of(int index) {
  if (index < kVelocity) return 1.0;
  if (index < kAcceleration) return 5.0;
  if (index < kTorque) return 50.0;
  if (index < kForce) return 10.0;
  return 100.0;
}

// Absolute thigh and shank angles that put a foot at (ahead, below) of its hip.
std::array<double, 2> leg_angles(const PlanarModel& model, double ahead_m, double below_m);

class JumpProblem {
 public:
  JumpProblem(const robot::RobotModel& robot, const JumpSettings& settings);

  // The nodes, then the length of each phase's steps over step_s.
  int variables() const { return stretch_of(JumpPhase::kFourFeet) + 3; }
  int constraints() const { return constraints_; }
  const std::vector<JumpNode>& nodes() const { return nodes_; }
  const PlanarModel& model() const { return model_; }
  const JumpSettings& settings() const { return settings_; }
  Bounds variable_bounds() const;
  Bounds constraint_bounds() const;
  std::vector<double> initial_guess() const;

  double cost(const double* x) const;
  void gradient(const double* x, double* out) const;
  void constraints(const double* x, double* out) const;
  const std::vector<Entry>& jacobian_entries() const { return jacobian_entries_; }
  void jacobian(const double* x, double* out) const;
  // Lower triangle of the Lagrangian cost_factor f + multipliers^T g.
  const std::vector<Entry>& hessian_entries() const { return hessian_entries_; }
  void hessian(const double* x, double cost_factor, const double* multipliers, double* out) const;

  // The value of a node's variable in its unit.
  static double unscaled(const double* x, std::size_t node, int index);

 private:
  int stretch_of(JumpPhase phase) const {
    return static_cast<int>(nodes_.size()) * kNodeSize + static_cast<int>(phase);
  }
  // Half a step's share in a trapezoidal row, per scaled unit.
  double half_step(int index) const;
  template <class T>
  void evaluate(const T* z, std::array<T, kNodeRows>& out) const;
  template <class T>
  void evaluate_at(const double* x, std::size_t node, std::array<T, kNodeRows>& out) const;
  void make_nodes();
  void find_structure();
  void fix_pose(std::size_t node, bool start, Bounds& bounds) const;
  Bounds row_bounds(const JumpNode& node) const;
  std::array<double, kCoordinates> drawn_pose(const JumpNode& node) const;

  robot::RobotModel robot_;
  JumpSettings settings_;
  PlanarModel model_;
  std::array<double, kCoordinates> first_q_{};
  std::array<double, kCoordinates> last_q_{};
  std::vector<JumpNode> nodes_;
  std::vector<int> first_row_;  // of each node's rows, then of each link's
  int constraints_ = 0;
  std::array<std::vector<int>, kNodeRows> row_columns_;  // variables a row depends on
  std::vector<Entry> node_hessian_;                      // of a node, lower triangle
  std::vector<Entry> jacobian_entries_;
  std::vector<Entry> hessian_entries_;
};

}  // namespace surefoot::apps::jump
