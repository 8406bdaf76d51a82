// All pictures of a run, with their captions.
#pragma once

#include <vector>

#include "apps/common/config_root.h"
#include "apps/common/perceived_map.h"
#include "apps/common/plan_log.h"
#include "apps/common/report.h"
#include "apps/common/run_log.h"
#include "core/mapping/mapper.h"
#include "core/runtime/statistics.h"

namespace surefoot::apps {

// Half the width of the lane that must not be left (contract: clutter); 0 where there is none.
double lane_half_width_m(const Config& config);
// The goal in W on y = 0; negative: the mission has none.
double goal_x_m(const Config& config);
// Length of the lines between the waypoints; 0: the mission has none.
double course_m(const Config& config);

// `ground` may be empty: then there is no true map. solids, plans: of a mission that navigates.
std::vector<NamedDrawing> run_pictures(const RunLog& log, const Config& config,
                                       const mapping::Mapper& mapper, const TrueGround& ground,
                                       const std::vector<sim::SolidTruth>& solids,
                                       const std::vector<PlanSample>& plans,
                                       const std::vector<runtime::TaskReport>& tasks);

}  // namespace surefoot::apps
