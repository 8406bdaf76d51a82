// Figures of the jumps of a run, from its log.
#pragma once

#include <array>
#include <cstdint>

#include "apps/common/run_log.h"

namespace surefoot::apps {

struct JumpFigures {
  std::uint32_t attempts = 0;  // crouches before an edge
  std::uint32_t jumps = 0;     // motions played
  std::uint32_t refusals = 0;
  const char* last_refusal = "none";
  // Fewest feet, over all jumps, that stood at the end of landing: on the ground by the truth, and
  // all on one level. 4 where nothing was jumped.
  int landed_feet = 4;
  double max_torque_share = 0;   // of a motor's torque limit, from the push to standing again
  double flight_s = 0;           // of the last jump, from lift-off to the first touch; by the truth
  double landing_speed_m_s = 0;  // downwards, just before it
};

// Without truth: only what the robot itself counts.
JumpFigures measure_jumps(const RunLog& log,
                          const std::array<double, robot::kJoints>& torque_limit_Nm);

}  // namespace surefoot::apps
