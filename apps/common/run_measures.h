// The figures of a run, from its log. Definitions stand beside the fields; docs/running.md repeats
// them for users.
#pragma once

#include <array>
#include <cstdint>

#include "apps/common/run_log.h"

namespace surefoot::apps {

struct EstimateErrors {
  double end_error_m = 0;  // |estimated - true| position at the end of walking, O aligned with W by
                           // yaw and shift at its beginning
  double drift_percent = 0;  // end_error_m over the path length
  double rms_error_m = 0;    // over the walk
};

// What the body keeps up: within the best 5 s of the walk, the lowest mean over half a second. True
// motion, in the axes of the body's heading; without truth the estimate's.
struct SustainedSpeeds {
  double forward_m_s = 0;
  double lateral_m_s = 0;  // to either side
  double yaw_rate_rad_s = 0;
};

// Getting up, by the truth: from the first sample of phase kRecover until the trunk has been up, as
// high and as level as standing, for half a second (that half second not counted).
struct RecoveryFigures {
  int count = 0;
  int stood = 0;                // of these
  double time_to_stand_s = 0;   // the longest of those that stood
  double max_torque_share = 0;  // of a motor's torque limit, meanwhile
};

struct RunMeasures {
  double start_to_goal_m = 0;  // true place at the first step to the goal; 0 without a goal
  double walk_s = 0;           // from the first sample of walking to the last
  double path_length_m = 0;    // of the body in the plane, in legs of at least 5 cm (sway left out)
  double mean_speed_m_s = 0;   // way made towards the goal over walk_s
  std::uint64_t foot_slips = 0;  // contacts in which a sole slipped more than 20 mm
  std::uint64_t collisions = 0;  // times that trunk, thigh or shank came to touch the ground
  SustainedSpeeds sustained;     // zero for walks shorter than 5 s
  EstimateErrors estimate;       // zero without truth
  RecoveryFigures recovery;      // zero without truth
};

// goal_x_m: in W, on y = 0; negative: none. Without truth the estimate stands in for it. course_m:
// length of the lines of a mission with waypoints, whose goal may lie where it started; 0: none.
RunMeasures measure(const RunLog& log, double goal_x_m, double course_m = 0);

// Least distance in plan while it walked between the robot's footprint and what stands there.
double least_clearance_m(const RunLog& log);

// standing_height_m: of the trunk over the feet's centres where the robot stands.
RecoveryFigures measure_recovery(const RunLog& log, double standing_height_m,
                                 const std::array<double, robot::kJoints>& torque_limit_Nm);

}  // namespace surefoot::apps
