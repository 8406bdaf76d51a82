// The pictures of a run. Each is a Drawing, stored as PNG and put into report.html as SVG.
#pragma once

#include <string>
#include <vector>

#include "apps/common/drawing.h"
#include "apps/common/height_grid.h"
#include "apps/common/perceived_map.h"
#include "apps/common/plan_log.h"
#include "apps/common/run_log.h"
#include "core/robot/robot_model.h"
#include "core/runtime/statistics.h"
#include "sim_hal/scenario.h"

namespace surefoot::apps {

struct TerrainFigure {
  HeightGrid truth;      // empty (columns == 0) when there is no ground truth
  HeightGrid perceived;  // same raster as truth
  ClassGrid classes;     // same raster
  Alignment O_in_W;
  double goal_x_m = 0;
  sim::ObstacleConfig obstacle;  // without places there is none
  double lane_half_width_m = 0;  // 0: no lane
};

struct NavigationFigure {
  std::vector<sim::SolidTruth> solids;  // none without ground truth
  std::vector<PlanSample> plans;
  Alignment O_in_W;
  double goal_x_m = 0;  // W, on y = 0
};

// The way from above, and three moments of it.
Drawing navigation_figure(const RunLog& log, const NavigationFigure& figure);
// True ground with the traces of body and feet, perceived map, its classes with the footholds
// (paper 002, figures 4 and 8), and the difference of the heights.
Drawing terrain_figure(const RunLog& log, const TerrainFigure& figure);
// A map and its classes.
Drawing ground_figure(const HeightGrid& heights, const ClassGrid& classes);
// Speed, tilt and height over time.
Drawing motion_figure(const RunLog& log);
// Joint torques against their limits, one row per joint of a leg.
Drawing torque_figure(const RunLog& log, const robot::RobotModel& robot);
// Whether the log holds a jump, and its last one: poses from the side, and torques under them.
// `ground` may be empty.
bool has_jump(const RunLog& log);
Drawing jump_figure(const RunLog& log, const robot::RobotModel& robot, const TrueGround& ground);
// Which leg stands and which swings: planned, and felt.
Drawing gait_figure(const RunLog& log);
// Median, 99th percentile and maximum of every task against its budget.
Drawing timing_figure(const std::vector<runtime::TaskReport>& tasks);

}  // namespace surefoot::apps
