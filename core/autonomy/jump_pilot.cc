#include "core/autonomy/jump_pilot.h"

#include "core/math/elementary.h"

namespace surefoot::autonomy {
namespace {

using motions::JumpRefusal;
using motions::JumpStage;

using math::magnitude;

}  // namespace

void JumpPilot::reset(const JumpPilotConfig& config, const motions::JumpConfig& jump,
                      const robot::RobotModel& model, double standing_height_m,
                      const motions::MotionLibrary& motions) {
  config_ = config;
  motions_ = &motions;
  jump_.reset(jump, model, standing_height_m);
  joints_ = actuation::JointCommands{};
  counters_ = JumpCounters{};
  start_ = motions::StartState{};
  looked_at_ = 0;
  attempts_here_ = 0;
  abandon();
}

void JumpPilot::abandon() {
  jump_.end();
  has_ledge_ = false;
  refused_ledge_ = false;
  ended_ = false;
  motion_ = nullptr;
  command_ = control::VelocityCommand{};
  enter(PilotStage::kWatch);
}

void JumpPilot::enter(PilotStage stage) {
  stage_ = stage;
  stage_s_ = 0;
}

control::GaitKind JumpPilot::gait(control::GaitKind walking) const {
  const bool stepping = stage_ == PilotStage::kWatch || stage_ == PilotStage::kApproach ||
                        stage_ == PilotStage::kSquare;
  return stepping ? walking : control::GaitKind::kStand;
}

void JumpPilot::look(const estimation::RobotState& state, const mapping::MapWindow& window,
                     double ground_z_m) {
  LedgeQuery query;
  query.x_O_m = state.p_OB_m[0];
  query.y_O_m = state.p_OB_m[1];
  query.yaw_rad = state.yaw_rad;
  query.ground_z_m = ground_z_m;
  query.from_m = config_.look_from_m;
  query.half_width_m = config_.half_width_m;
  query.min_rise_m = config_.min_rise_m;
  query.min_drop_m = config_.min_drop_m;
  const Result<Ledge> found = find_ledge(window, query);
  if (!found.ok()) return;
  ledge_ = found.value();
  top_z_m_ = ledge_.edge_O_m[2] + ledge_.rise_m;
  has_ledge_ = true;
  unseen_s_ = 0;
}

// Where the robot is to the edge.
void JumpPilot::measure(const estimation::RobotState& state, const mapping::MapWindow& window,
                        double ground_z_m) {
  start_ = motions::StartState{};
  start_.edge_m = ledge_.distance_m(state.p_OB_m[0], state.p_OB_m[1]);
  start_.heading_rad = math::wrap_angle(ledge_.yaw_rad - state.yaw_rad);
  start_.rise_m = top_z_m_ - ground_z_m;
  start_.tilt_rad = math::acos(math::clamp(state.R_OB(2, 2), -1.0, 1.0));
  start_.speed_m_s = math::sqrt(state.v_OB_m_s.squaredNorm());
  start_.rate_rad_s = math::sqrt(state.angular_velocity_B_rad_s.squaredNorm());
  start_.all_feet = true;
  for (const estimation::FootState& foot : state.feet) {
    start_.all_feet = start_.all_feet && foot.in_contact;
  }
  if (stage_ != PilotStage::kJump) return;
  start_.joint_error_rad = jump_.max_joint_error_rad(state);
  const math::SinCos normal = math::sin_cos(ledge_.yaw_rad);
  const double along_m = normal.cos * (state.p_OB_m[1] - ledge_.edge_O_m[1]) -
                         normal.sin * (state.p_OB_m[0] - ledge_.edge_O_m[0]);
  LandingArea area;
  area.from_m = ledge_.gap_m + config_.landing_from_m;
  area.length_m = config_.landing_length_m;
  area.half_width_m = config_.landing_half_width_m;
  area.max_error_m = config_.landing_error_m;
  area.min_known = config_.landing_known;
  start_.landing_free = landing_is_free(window, ledge_, along_m, area);
}

// The motion whose range covers the ledge and whose own rise and gap are nearest.
const motions::Motion* JumpPilot::choose() const {
  const motions::Motion* best = nullptr;
  double best_off_m = 0;
  for (const motions::Motion& motion : *motions_) {
    const bool gap = motion.kind == motions::Motion::Kind::kGap;
    if (gap != (ledge_.kind == Ledge::Kind::kGap)) continue;
    if (ledge_.gap_m > motion.gap_m) continue;
    if (ledge_.rise_m < motion.start.rise_min_m || ledge_.rise_m > motion.start.rise_max_m)
      continue;
    const double off_m = magnitude(motion.rise_m - ledge_.rise_m) + motion.gap_m - ledge_.gap_m;
    if (best != nullptr && off_m >= best_off_m) continue;
    best = &motion;
    best_off_m = off_m;
  }
  return best;
}

void JumpPilot::refuse(JumpRefusal reason) {
  ++counters_.refusals;
  counters_.last_refusal = reason;
}

void JumpPilot::update(const estimation::RobotState& state, const mapping::MapWindow* window,
                       double ground_z_m, bool all_in_stance, double step_s) {
  ended_ = false;
  stage_s_ += step_s;
  unseen_s_ += step_s;
  if (window == nullptr) return;
  const bool fresh = window->frames != looked_at_;
  looked_at_ = window->frames;
  // Crouched it sees nothing new of the edge, and in the air everything moves.
  if (fresh && stage_ <= PilotStage::kStop) look(state, *window, ground_z_m);
  if (has_ledge_ && stage_ != PilotStage::kJump && unseen_s_ > config_.lost_s) {
    if (stage_ != PilotStage::kWatch) refuse(JumpRefusal::kEdgeLost);
    abandon();
  }
  if (!has_ledge_) return;
  measure(state, *window, ground_z_m);
  switch (stage_) {
    case PilotStage::kWatch: watch(); break;
    case PilotStage::kApproach:
      steer();
      if (in_place()) enter(PilotStage::kSquare);
      if (stage_s_ > config_.patience_s) {
        refuse(magnitude(start_.heading_rad) > config_.heading_tolerance_rad
                   ? JumpRefusal::kHeading
                   : JumpRefusal::kDistance);
        enter(PilotStage::kGivenUp);
      }
      break;
    case PilotStage::kSquare:
      steer();
      if (stage_s_ >= config_.square_s && in_place()) enter(PilotStage::kStop);
      if (stage_s_ > config_.patience_s) enter(PilotStage::kApproach);
      break;
    case PilotStage::kStop:
      command_ = control::VelocityCommand{};
      if (all_in_stance && stage_s_ >= config_.square_s) {
        ++counters_.attempts;
        ++attempts_here_;
        jump_.begin(*motion_, state);
        enter(PilotStage::kJump);
        run_jump(state, step_s);
      }
      break;
    case PilotStage::kJump: run_jump(state, step_s); break;
    case PilotStage::kGivenUp: command_ = control::VelocityCommand{}; break;
  }
}

void JumpPilot::watch() {
  if (start_.edge_m > config_.engage_m) return;
  motion_ = choose();
  if (motion_ != nullptr) {
    refused_ledge_ = false;
    return enter(PilotStage::kApproach);
  }
  if (!refused_ledge_) refuse(JumpRefusal::kNoMotion);
  refused_ledge_ = true;
  if (start_.edge_m <= config_.refuse_m) enter(PilotStage::kGivenUp);
}

void JumpPilot::steer() {
  const double off_m = start_.edge_m - motion_->edge_m;
  command_ = control::VelocityCommand{};
  command_.forward_m_s =
      math::clamp(config_.distance_gain_1_s * off_m, -config_.speed_m_s, config_.speed_m_s);
  command_.yaw_rate_rad_s = math::clamp(config_.heading_gain_1_s * start_.heading_rad,
                                        -config_.max_yaw_rate_rad_s, config_.max_yaw_rate_rad_s);
}

bool JumpPilot::in_place() const {
  return magnitude(start_.edge_m - motion_->edge_m) <= config_.distance_tolerance_m &&
         magnitude(start_.heading_rad) <= config_.heading_tolerance_rad;
}

// In the first pose: go, or say what is wrong.
void JumpPilot::decide(const estimation::RobotState& state) {
  const JumpRefusal refusal = check_start(motion_->start, start_);
  if (refusal == JumpRefusal::kNone) {
    ++counters_.jumps;
    return jump_.play();
  }
  if (jump_.stage_s() < config_.patience_s) return;
  refuse(refusal);
  jump_.cancel(state);
}

void JumpPilot::run_jump(const estimation::RobotState& state, double step_s) {
  const bool was_broken_off = jump_.broken_off();
  joints_ = jump_.update(state, step_s);
  if (jump_.broken_off() && !was_broken_off) refuse(JumpRefusal::kBrokenOff);
  if (jump_.stage() == JumpStage::kHold && jump_.holds()) decide(state);
  if (jump_.stage() != JumpStage::kDone) return;
  const bool jumped = jump_.landed();
  abandon();
  ended_ = true;
  if (jumped) {
    attempts_here_ = 0;
  } else if (attempts_here_ >= config_.max_attempts) {
    enter(PilotStage::kGivenUp);
  }
}

}  // namespace surefoot::autonomy
