#include "apps/common/summary.h"

#include <fmt/format.h>

#include "apps/common/version.h"

namespace surefoot::apps {

using Json = nlohmann::ordered_json;

namespace {

Json task_json(const runtime::TaskReport& task) {
  return {{"name", task.name},           {"period_us", task.period_us},
          {"budget_us", task.budget_us}, {"count", task.count},
          {"p50_us", task.p50_us},       {"p99_us", task.p99_us},
          {"max_us", task.max_us},       {"overruns", task.overruns},
          {"skipped", task.skipped},     {"late_publishes", task.late_publishes}};
}

Json counters_json(const RunFacts& facts) {
  return {{"late_ticks", facts.counters.late_ticks},
          {"can_dropped", facts.counters.can_dropped},
          {"imu_dropped", facts.counters.imu_dropped},
          {"pose_dropped", facts.counters.pose_dropped},
          {"pose_used", facts.tracking.used},
          {"pose_refused", facts.tracking.refused},
          {"pose_low_confidence", facts.tracking.low_confidence},
          {"pose_without_stamp", facts.tracking.without_pose},
          {"pose_jumps", facts.tracking.jumps},
          {"pose_relocations", facts.tracking.relocations},
          {"depth_invalid", facts.counters.depth_invalid},
          {"stereo_invalid", facts.counters.stereo_invalid},
          {"triggers_refused", facts.counters.triggers_refused},
          {"sends_refused", facts.counters.sends_refused},
          {"records_refused", facts.counters.records_refused},
          {"samples_dropped", facts.samples_dropped},
          {"map_frames_bounded", facts.map_frames_bounded},
          {"static_steps", facts.static_walk.steps},
          {"static_steps_missed", facts.static_walk.missed},
          {"static_steps_narrow", facts.static_walk.narrow},
          {"static_steps_slipped", facts.static_walk.slipped},
          {"static_steps_lowered", facts.static_walk.lowered},
          {"static_steps_tipped", facts.static_walk.tipped},
          {"static_steps_passed_over", facts.static_walk.passed_over},
          {"static_steps_waited", facts.static_walk.waited},
          {"static_steps_retreated", facts.static_walk.retreated}};
}

Json jump_json(const JumpFigures& jump) {
  return {{"attempts", jump.attempts},       {"jumps", jump.jumps},
          {"refusals", jump.refusals},       {"last_refusal", jump.last_refusal},
          {"landed_feet", jump.landed_feet}, {"max_torque_share", jump.max_torque_share},
          {"flight_s", jump.flight_s},       {"landing_speed_m_s", jump.landing_speed_m_s}};
}

Json navigation_json(const RunFacts& facts) {
  const autonomy::NavigationTelemetry& navigation = facts.navigation;
  return {{"reason", navigation::to_string(navigation.reason)},
          {"scans", navigation.sight.scans},
          {"scans_without_pose", navigation.sight.scans_without_pose},
          {"scans_refused", navigation.sight.scans_refused},
          {"windows", navigation.sight.windows},
          {"plans", navigation.plans.plans},
          {"plans_partial", navigation.plans.plans_partial},
          {"plans_enclosed", navigation.plans.plans_enclosed},
          {"plans_raw", navigation.plans.plans_raw},
          {"plans_dropped", navigation.plans.plans_dropped},
          {"steps_aside", navigation.plans.steps_aside},
          {"least_clearance_m", facts.least_clearance_m}};
}

}  // namespace

std::string hex16(std::uint64_t value) { return fmt::format("{:016x}", value); }

Json summary_json(const RunFacts& facts) {
  const RunMeasures& m = facts.measures;
  const double factor = facts.wall_time_s > 0 ? facts.sim_time_s / facts.wall_time_s : 0;
  Json json;
  json["schema"] = 1;
  json["robot"] = facts.request.robot;
  json["world"] = facts.request.world;
  json["mission"] = facts.request.mission;
  json["hal"] = facts.request.hal;
  json["plant"] = facts.plant;
  json["seed"] = facts.request.seed;
  json["set"] = facts.request.sets;
  json["config_hash"] = hex16(facts.config_hash);
  json["version"] = version_text();
  json["outcome"] = to_string(facts.verdict.outcome);
  json["reason"] = facts.verdict.reason;
  json["sim_time_s"] = facts.sim_time_s;
  json["wall_time_s"] = facts.wall_time_s;
  json["real_time_factor"] = factor;
  json["start_to_goal_m"] = m.start_to_goal_m;
  json["path_length_m"] = m.path_length_m;
  json["walk_time_s"] = m.walk_s;
  json["mean_speed_m_s"] = m.mean_speed_m_s;
  json["sustained"] = {{"forward_m_s", m.sustained.forward_m_s},
                       {"lateral_m_s", m.sustained.lateral_m_s},
                       {"yaw_rate_rad_s", m.sustained.yaw_rate_rad_s}};
  json["collisions"] = m.collisions;
  json["falls"] = facts.falls;
  json["recovery"] = {{"count", m.recovery.count},
                      {"stood", m.recovery.stood},
                      {"time_to_stand_s", m.recovery.time_to_stand_s},
                      {"max_torque_share", m.recovery.max_torque_share}};
  json["jump"] = jump_json(facts.jump);
  json["foot_slips"] = m.foot_slips;
  json["terrain"] = {{"max_step_m", facts.terrain.max_step_m},
                     {"rms_m", facts.terrain.rms_m},
                     {"max_height_m", facts.terrain.max_height_m},
                     {"cover", facts.terrain.cover},
                     {"boxes", facts.terrain.boxes},
                     {"bridged_cells", facts.terrain.bridged_cells},
                     {"tiles", facts.terrain.tiles},
                     {"area_m2", facts.terrain.area_m2},
                     {"trunks", facts.terrain.trunks},
                     {"boulders", facts.terrain.boulders},
                     {"logs", facts.terrain.logs},
                     {"walls", facts.terrain.walls},
                     {"saplings", facts.terrain.saplings},
                     {"walkers", facts.terrain.walkers},
                     {"steepest_rad", facts.terrain.steepest_rad},
                     {"roughness_rms_m", facts.terrain.roughness_rms_m},
                     {"passage_width_m", facts.terrain.passage_width_m}};
  json["estimate"] = {{"end_error_m", m.estimate.end_error_m},
                      {"drift_percent", m.estimate.drift_percent},
                      {"rms_error_m", m.estimate.rms_error_m}};
  json["map"] = {{"rmse_m", facts.map.rmse_m},
                 {"median_m", facts.map.median_m},
                 {"vertical_rmse_m", facts.map.vertical_rmse_m},
                 {"known_fraction", facts.map.known_fraction}};
  json["stereo"] = {{"triggers", facts.stereo.triggers},
                    {"pairs_matched", facts.stereo.pairs_matched},
                    {"pairs_refused", facts.stereo.pairs_refused},
                    {"pairs_unusable", facts.stereo.pairs_unusable},
                    {"valid_share", facts.stereo.valid_share}};
  const autonomy::CameraMotionTelemetry& motion = facts.visual_odometry;
  json["visual_odometry"] = {{"motions", motion.pairs.motions},
                             {"first", motion.pairs.first},
                             {"too_few_features", motion.pairs.too_few_features},
                             {"inconsistent", motion.pairs.inconsistent},
                             {"without_pose", motion.pairs.without_pose},
                             {"late", motion.pairs.late},
                             {"used", motion.motions.used},
                             {"outliers", motion.motions.outliers},
                             {"unmatched", motion.motions.unmatched},
                             {"refused", motion.motions.refused}};
  const autonomy::LocalisationCounters& pictures = facts.localisation;
  json["localisation"] = {{"registered", pictures.registered},
                          {"first", pictures.first},
                          {"thin", pictures.thin},
                          {"unmatched", pictures.unmatched},
                          {"implausible", pictures.implausible},
                          {"without_pose", pictures.without_pose}};
  json["fill"] = {{"maps", facts.fill.maps},
                  {"refused", facts.fill.refused},
                  {"filled", facts.fill.filled},
                  {"unknown", facts.fill.unknown}};
  json["navigation"] = navigation_json(facts);
  json["memory"] = {{"static_bytes", facts.static_bytes},
                    {"heap_calls_after_start", facts.heap_calls},
                    {"page_faults_after_start", facts.page_faults}};
  json["tasks"] = Json::array();
  for (const runtime::TaskReport& task : facts.tasks) json["tasks"].push_back(task_json(task));
  json["counters"] = counters_json(facts);
  json["ticks"] = facts.ticks;
  json["hash"] = hex16(facts.hash);
  return json;
}

}  // namespace surefoot::apps
