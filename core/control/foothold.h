// Where a foot should land: the Raibert rule, then the nearest place that can bear a foot.
//
// Nominal (paper 002, equations 7 to 9), at the time of touchdown:
//   p = p_body(t_touchdown) + Rz(yaw) l_hip + v t_stance / 2 + k (v - v_command)
// with the body carried forward at its present velocity. The map then decides (mapping/foothold.h).
#pragma once

#include "core/control/config.h"
#include "core/control/foothold_reason.h"
#include "core/estimation/estimator.h"
#include "core/mapping/map_window.h"
#include "core/robot/robot_model.h"

namespace surefoot::control {

// What ground a foot may be set on. kAny: any, unseen or bad, if there is no good one.
enum class GroundRule : std::uint8_t { kGood = 0, kGoodOrUnseen, kAny };

// Velocity command in the yaw-aligned frame of the body.
struct VelocityCommand {
  double forward_m_s = 0;
  double left_m_s = 0;
  double yaw_rate_rad_s = 0;
};

struct Foothold {
  Vector3 nominal_O_m = Vector3::Zero();  // centre of the foot sphere
  Vector3 position_O_m = Vector3::Zero();
  FootholdReason reason = FootholdReason::kNominal;
};

// Hip joint and, outwards of it, where a leg stands: lateral_offset_m.
Vector3 stance_hip_B_m(const robot::RobotModel& model, const FootholdConfig& config,
                       std::size_t leg);

class FootholdPlanner {
 public:
  void reset(const FootholdConfig& config, const robot::RobotModel& model);

  // The point the Raibert rule gives; z is ground_z_m plus the foot radius.
  Vector3 nominal_O_m(std::size_t leg, const estimation::RobotState& state,
                      const VelocityCommand& command, double until_touchdown_s, double stance_s,
                      double ground_z_m) const;

  // Moves the nominal point to ground that can bear a foot. window: null when mapping is off.
  // reason kNone: nothing within the search radius; position is the nominal point, not to be used.
  // kUnseen: the nominal point, for unseen ground is allowed and the map knows too little around it
  // to class it. kForced: as kNone, but a step is due at any rate.
  // map_offset_m is added to heights that the map gives (map_offset.h).
  // Cost: a look-up, or a spiral over the search radius.
  Foothold choose(const Vector3& nominal_O_m, const mapping::MapWindow* window, GroundRule ground,
                  double map_offset_m = 0) const;

 private:
  FootholdConfig config_;
  robot::RobotModel model_;
};

}  // namespace surefoot::control
