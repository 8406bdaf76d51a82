// What the autonomy says of itself: its state as telemetry, which is recorded, hashed and drawn.
#include "core/autonomy/autonomy.h"

namespace surefoot::autonomy {
namespace {

std::array<double, 3> to_array(const Vector3& v) { return {v[0], v[1], v[2]}; }

}  // namespace

void Autonomy::report(const estimation::RobotState& state) {
  Telemetry& telemetry = outputs_.telemetry;
  telemetry.phase = mission_.phase();
  telemetry.stop_reason = mission_.stop_reason();
  telemetry.p_OB_m = to_array(state.p_OB_m);
  telemetry.q_OB_wxyz = {state.q_OB.w, state.q_OB.x, state.q_OB.y, state.q_OB.z};
  telemetry.v_OB_m_s = to_array(state.v_OB_m_s);
  telemetry.angular_velocity_B_rad_s = to_array(state.angular_velocity_B_rad_s);
  const control::VelocityCommand& command = locomotion_acts() ? velocity_ : mission_.command();
  telemetry.velocity_command_B = {command.forward_m_s, command.left_m_s, command.yaw_rate_rad_s};
  for (std::size_t i = 0; i < robot::kJoints; ++i) {
    JointTelemetry& joint = telemetry.joints[i];
    joint.position_rad = state.joints[i].position_rad;
    joint.velocity_rad_s = state.joints[i].velocity_rad_s;
    joint.torque_Nm = state.joints[i].torque_Nm;
    joint.position_command_rad = commands_[i].position_rad;
    joint.torque_command_Nm = commands_[i].torque_Nm;
  }
  report_legs(state);
  report_jump();
  report_stereo();
  report_localisation();
  report_terrain();
  report_navigation();
  telemetry.depth_frames_mapped = map_.counters().frames_integrated;
  telemetry.map_digest = map_.window_digest();
  const estimation::DriftEstimator& drift = estimator_.drift();
  telemetry.tracking.position_error_O_m = to_array(drift.position_error_O_m());
  telemetry.tracking.yaw_error_rad = drift.yaw_error_rad();
  telemetry.tracking.samples = drift.counters();
  report_obstacles(state);
  telemetry.replies_missed = bus_.counters().missed;
  telemetry.replies_invalid = bus_.counters().invalid;
}

void Autonomy::report_obstacles(const estimation::RobotState& state) {
  if (!config_.mission.avoid) return;
  ObstacleTelemetry& telemetry = outputs_.telemetry.obstacles;
  const obstacles::Fields& fields = map_.fields();
  static_cast<void>(telemetry.fields_O_m.resize(fields.size()));  // the same capacity
  for (std::size_t i = 0; i < fields.size(); ++i) {
    telemetry.fields_O_m[i] = {fields[i].centre_O_m[0], fields[i].centre_O_m[1]};
  }
  telemetry.side = avoidance_.side();
  telemetry.counters = map_.field_counters();
  telemetry.free_space_m = 0;
  if (fields.empty()) return;
  telemetry.free_space_m = avoidance_.free_space_m(fields, {state.p_OB_m.head<2>(), state.yaw_rad});
}

void Autonomy::report_legs(const estimation::RobotState& state) {
  const std::array<estimation::GaitPhase, robot::kLegs> phases = gait_phases();
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const control::LegStatus& status = legs()[leg];
    LegTelemetry& telemetry = outputs_.telemetry.legs[leg];
    telemetry.stance_planned = phases[leg].stance_planned;
    telemetry.contact = state.feet[leg].in_contact;
    telemetry.foot_O_m = to_array(state.feet[leg].p_O_m);
    telemetry.force_O_N = to_array(status.force_O_N);
    telemetry.foothold_nominal_O_m = to_array(status.foothold.nominal_O_m);
    telemetry.foothold_O_m = to_array(status.foothold.position_O_m);
    telemetry.foothold_reason = status.foothold.reason;
  }
}

void Autonomy::report_jump() {
  JumpTelemetry& telemetry = outputs_.telemetry.jump;
  telemetry.pilot = jump_pilot_.stage();
  telemetry.stage = jump_pilot_.jump().stage();
  telemetry.counters = jump_pilot_.counters();
  telemetry.edge_m = jump_pilot_.distance_m();
  telemetry.heading_rad = jump_pilot_.heading_error_rad();
  telemetry.rise_m = jump_pilot_.rise_m();
  telemetry.gap_m = jump_pilot_.ledge().gap_m;
}

void Autonomy::report_stereo() {
  StereoTelemetry& telemetry = outputs_.telemetry.stereo;
  telemetry.pairs_matched = stereo_.counters().pairs_matched;
  telemetry.pairs_refused = stereo_.counters().pairs_refused;
  telemetry.pairs_unusable = stereo_.counters().pairs_unusable;
  telemetry.valid_share = stereo_.valid_share();
  CameraMotionTelemetry& motion = outputs_.telemetry.visual_odometry;
  motion.pairs = stereo_.motion().counters();
  motion.motions = estimator_.fusion().counters();
  motion.inliers = stereo_.motion().inliers();
}

void Autonomy::report_localisation() {
  LocalisationTelemetry& telemetry = outputs_.telemetry.localisation;
  telemetry.counters = localisation_.counters();
  telemetry.shift_O_m = to_array(localisation_.shift().shift_O_m);
  telemetry.yaw_rad = localisation_.shift().yaw_rad;
  telemetry.observed_directions = localisation_.observed_directions();
  telemetry.residual_m = localisation_.residual_m();
}

void Autonomy::report_terrain() {
  outputs_.telemetry.terrain.counters = terrain_.counters();
  outputs_.telemetry.terrain.map_digest = terrain_.map_digest();
}

}  // namespace surefoot::autonomy
