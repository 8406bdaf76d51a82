#include "apps/common/run_pictures.h"

#include <algorithm>
#include <cmath>

#include "apps/common/figures.h"
#include "sim_hal/world/world_spec.h"

namespace surefoot::apps {
namespace {

constexpr double kRaster_m = 0.015;
constexpr double kHalfWidth_m = 0.75;  // shown beside the line from start to goal
constexpr double kMargin_m = 0.6;      // shown before the start and beyond the goal
constexpr double kLongest_m = 12;      // of a picture

}  // namespace

double lane_half_width_m(const Config& config) {
  return config.world.generator == sim::Generator::kClutter ? 0.5 * sim::kLaneWidth_m : 0.0;
}

double goal_x_m(const Config& config) {
  const autonomy::MissionConfig& mission = config.autonomy.mission;
  using Kind = autonomy::MissionConfig::Kind;
  if (mission.kind != Kind::kCross && mission.kind != Kind::kNavigate) return -1.0;
  return mission.waypoints.empty() ? mission.goal_x_m : mission.waypoints.back().x_m;
}

double course_m(const Config& config) {
  double length = 0;
  autonomy::Waypoint from;
  for (const autonomy::Waypoint& to : config.autonomy.mission.waypoints) {
    length += std::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
    from = to;
  }
  return length;
}

std::vector<NamedDrawing> run_pictures(const RunLog& log, const Config& config,
                                       const mapping::Mapper& mapper, const TrueGround& ground,
                                       const std::vector<sim::SolidTruth>& solids,
                                       const std::vector<PlanSample>& plans,
                                       const std::vector<runtime::TaskReport>& tasks) {
  double length = goal_x_m(config);
  for (const autonomy::Waypoint& place : config.autonomy.mission.waypoints) {
    length = std::max(length, place.x_m);
  }
  length = std::clamp(length, 1.0, kLongest_m);
  const HeightGrid raster(-kMargin_m, -kHalfWidth_m, length + 2 * kMargin_m, 2 * kHalfWidth_m,
                          kRaster_m);
  TerrainFigure terrain;
  terrain.O_in_W = align_at_start(log);
  terrain.goal_x_m = goal_x_m(config);
  terrain.obstacle = config.sim.scenario.obstacle;
  terrain.lane_half_width_m = lane_half_width_m(config);
  terrain.perceived = perceived_grid(mapper, terrain.O_in_W, raster);
  terrain.classes = ClassGrid(raster);
  if (mapper.configured()) {
    terrain.classes = classify_map(mapper.map(), config.autonomy.mapping, class_limits(config),
                                   terrain.O_in_W, raster);
  }
  if (ground) terrain.truth = true_grid(ground, raster);
  std::vector<NamedDrawing> pictures{
      {"terrain",
       "Classes are those of the map at the end. Red: where a foot was sent because the nominal "
       "place (black ring) could not bear it. Grey: never seen.",
       terrain_figure(log, terrain)},
      {"motion", "Dashed uprights: begin and end of walking.", motion_figure(log)}};
  if (!config.autonomy.own_gaits) {
    pictures.push_back({"torques", "Measured by the drives. Dashed: limit of the actuator.",
                        torque_figure(log, config.robot)});
    pictures.push_back({"gait", "Four seconds from the middle of the walk.", gait_figure(log)});
  }
  pictures.push_back({"timing",
                      "Execution times on this computer; they are not part of the run's hash.",
                      timing_figure(tasks)});
  if (!plans.empty()) {
    pictures.insert(
        pictures.begin(),
        {"navigation",
         "Below: moments, with the points of the objects (red: of moving ones), the cost "
         "map (dark: lethal), the plan (blue) and the robot (ring).",
         navigation_figure(log, {solids, plans, terrain.O_in_W, terrain.goal_x_m})});
  }
  if (has_jump(log)) {
    pictures.insert(pictures.begin() + 1,
                    {"jump",
                     "The last jump. Right legs in colour, left ones grey. Uprights: the moments "
                     "above. Torques measured by the drives; dashed: limit of the actuator.",
                     jump_figure(log, config.robot, ground)});
  }
  return pictures;
}

}  // namespace surefoot::apps
