// From any resting pose on its feet to standing: joint angles are blended to the folded pose, then
// the feet are pushed down along a straight line until the trunk is at walking height.
#pragma once

#include <array>

#include "core/actuation/joint_bus.h"
#include "core/control/config.h"
#include "core/math/linear.h"
#include "core/robot/robot_model.h"

namespace surefoot::control {

class StandUp {
 public:
  void reset(const StandUpConfig& config, const robot::RobotModel& model, double height_m);
  // Begins from the joints' present angles.
  void start(const actuation::JointStates& joints);
  // Begins from the folded pose, which is commanded already: rises at once.
  void start_folded();
  // One tick; after done() the standing pose is held.
  actuation::JointCommands update(double step_s);
  bool done() const { return elapsed_s_ >= config_.fold_s + config_.rise_s; }

 private:
  Vector3 folded_rad(std::size_t leg) const;

  Vector3 standing_foot_B_m(std::size_t leg, double height_m) const;

  StandUpConfig config_;
  robot::RobotModel model_;
  double height_m_ = 0;
  double elapsed_s_ = 0;
  std::array<Vector3, robot::kLegs> start_rad_;
};

}  // namespace surefoot::control
