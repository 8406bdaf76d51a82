// What the trunk should do: the ground under the feet and the pose above it.
#pragma once

#include <array>

#include "core/control/config.h"
#include "core/control/foothold.h"
#include "core/estimation/estimator.h"
#include "core/math/linear.h"
#include "core/robot/robot_model.h"

namespace surefoot::control {

struct BodyReference {
  Vector3 p_OB_m = Vector3::Zero();
  Vector3 v_OB_m_s = Vector3::Zero();
  double yaw_rad = 0;
  double yaw_rate_rad_s = 0;
  double roll_rad = 0;
  double pitch_rad = 0;
  double ground_z_m = 0;  // filtered, below the trunk
};

class BodyReferenceTracker {
 public:
  void reset(const BodyConfig& config, const robot::RobotModel& model);
  // Takes the present pose and feet as reference.
  void start(const estimation::RobotState& state);

  // Follows the feet in contact with the ground plane and the command with the reference pose.
  void update(const estimation::RobotState& state, const VelocityCommand& command, double step_s);

  const BodyReference& reference() const { return reference_; }

 private:
  struct Plane {
    double height_m;  // at the trunk's x, y
    double slope_x;   // along the trunk's heading
    double slope_y;   // to its left
  };
  // Least squares through the last contact points of the four feet.
  Plane fit_plane(const estimation::RobotState& state) const;
  void follow_ground(const estimation::RobotState& state, double step_s);

  BodyConfig config_;
  double foot_radius_m_ = 0;
  std::array<Vector3, robot::kLegs> contact_O_m_;  // last ground contact of each foot
  BodyReference reference_;
};

}  // namespace surefoot::control
