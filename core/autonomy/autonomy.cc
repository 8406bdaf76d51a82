#include "core/autonomy/autonomy.h"

#include "core/mapping/foothold.h"
#include "core/math/elementary.h"

namespace surefoot::autonomy {
namespace {

constexpr double kFolded_rad = 0.3;  // off the folded pose: too far to stand up from as it is
constexpr double kForget_m = 1.5;    // around a robot that fell
constexpr TimeNs kTrustedBeforeFall = milliseconds(1000);  // the pose by the legs, that much before
constexpr double kBrakingShare = 0.75;  // of the command's acceleration: the trunk lags behind it

// Of the trunk's origin over the mean of the feet's centres, along gravity.
double height_over_feet_m(const estimation::RobotState& state) {
  double height_m = 0;
  for (const estimation::FootState& foot : state.feet) {
    height_m -= (state.R_OB * foot.p_B_m)[2] / static_cast<double>(robot::kLegs);
  }
  return height_m;
}

// From hip to hip, and as wide as the feet stand.
obstacles::Footprint footprint(const robot::RobotModel& model) {
  return {model.abad_x_m, model.abad_y_m + model.hip_offset_m + model.foot_radius_m};
}

}  // namespace

Status Autonomy::reset(const robot::RobotModel& model, const AutonomyConfig& config) {
  model_ = model;
  config_ = config;
  tick_s_ = kTickPeriod.seconds();
  actuation::ActuationParameters actuation = config.actuation;
  actuation.silent_after_ticks =
      static_cast<std::uint32_t>(config.safety.drive_silence_s / tick_s_) + 1;
  const double search_limit_m = mapping::kMaxSearchRadius_cells * config.mapping.cell_size_m;
  if (config.control.foothold.search_radius_m > search_limit_m) return Status::kOutOfRange;
  if (config.control.static_walk.enabled && config.mission.jump) return Status::kInvalid;
  own_gaits_.reset(config.own_gaits, config.safety.drive_silence_s);
  const Status wired = bus_.configure(model, actuation);
  if (!ok(wired)) return wired;
  const mapping::TraversabilityLimits limits = mapping::traversability_limits(
      config.mapping, model, config.control.body.height_m, config.control.swing.clearance_m);
  // A depth camera sees the ground better; beside it a stereo camera is an odometer only.
  const Status matched = stereo_.reset(model.stereo_camera, config.stereo, config.visual_odometry,
                                       model.depth_camera.rate_Hz <= 0);
  if (!ok(matched)) return matched;
  trigger_.reset(config.stereo);
  const MapCamera camera = stereo_.maps() ? stereo_.camera() : depth_map_camera(model);
  const Status mapped = map_.reset(config.mapping, limits, model, camera);
  if (!ok(mapped)) return mapped;
  const Status located = localisation_.reset(config.localisation, config.mapping, model, camera);
  if (!ok(located)) return located;
  const Status completed = terrain_.reset(config.terrain, config.mapping.cell_size_m);
  if (!ok(completed)) return completed;
  const Status navigable = reset_navigation();
  if (!ok(navigable)) return navigable;
  avoidance_.reset(config.obstacles, footprint(model));
  velocity_ = control::VelocityCommand{};
  changed_side_ = false;
  if (config.mission.avoid) {
    const double rise_m = config.mission.blocked_rise_m;
    map_.watch_obstacles(config.obstacles, {.jump_only = !config.mission.jump,
                                            .min_rise_m = rise_m > 0 ? rise_m : limits.max_step_m});
  }
  estimator_.reset(config.estimation, model, tick_s_);
  if (config.visual_odometry.present) {
    // One odometer at a time puts the legs right.
    if (model.tracking_camera.rate_Hz > 0 || localisation_.enabled()) return Status::kInvalid;
    const CameraInBody& X_BN = stereo_.camera().X_BC;
    const Status fused =
        estimator_.fuse_camera(config.visual_odometry.fusion, X_BN.rotation.matrix, X_BN.origin.m);
    if (!ok(fused)) return fused;
  }
  history_.clear();
  mission_.reset(config.mission, kBrakingShare * config.control.body.max_acceleration_m_s2);
  recovery_.reset(config.control.recovery, model, config.control.stand_up.folded_rad);
  stand_up_.reset(config.control.stand_up, model, config.control.body.height_m);
  locomotion_.reset(config.control, model);
  static_walk_.reset(config.control, model);
  for (const motions::Motion& motion : config_.motions) {
    if (check_motion(motion, model).fault != motions::MotionFault::kNone) return Status::kInvalid;
  }
  jump_pilot_.reset(config.jump_pilot, config.jump, model, config.control.body.height_m,
                    config_.motions);
  mpc_.reset(config.control.mpc);
  outputs_ = TickOutputs{};
  commands_ = actuation::JointCommands{};
  walking_ready_ = false;
  has_stood_ = false;
  on_pad_ = false;
  footing_O_m_.setZero();
  collapsed_s_ = 0;
  imu_silent_s_ = 0;
  imu_refused_ = 0;
  encode_refused_ = 0;
  return Status::kOk;
}

void Autonomy::run_control() {
  receive();
  const estimation::RobotState& state = estimator_.state();
  navigate(state);
  MissionFacts facts;
  facts.at_goal = navigator_.status().state == navigation::NavigationState::kArrived;
  facts.navigation = navigation_command_;
  facts.drives_ready =
      estimator_.ready() && (own_gaits_.enabled() ? own_gaits_.standing() : bus_.all_valid());
  facts.must_recover = must_recover(state);
  facts.fallen = has_fallen(state);
  facts.recovered = recovery_.done();
  facts.recovery_failed = recovery_.failed();
  facts.stand_up_done = own_gaits_.standing() || stand_up_.done();
  facts.at_rest = at_rest();
  facts.jump_refused = jump_pilot_.given_up();
  facts.fault = find_fault();
  mission_.update(state, facts, tick_s_);
  act(state);
  send();
  watch(state);
  report(state);
  inputs_ = nullptr;
}

void Autonomy::receive() {
  bus_.receive({inputs_->can.data(), inputs_->can.size()});
  imu_silent_s_ = inputs_->imu.empty() ? imu_silent_s_ + tick_s_ : 0.0;
  // Only while nothing acts: a robot that balances on a biased gyro turns until the gyro reads
  // zero, and one that has just fallen still sinks.
  const bool recovering = mission_.phase() == MissionPhase::kRecover;
  const bool still = mission_.phase() == MissionPhase::kEnableDrives;
  const std::span<const hal::ImuSample> imu(inputs_->imu.data(), inputs_->imu.size());
  if (own_gaits_.enabled()) {
    const std::span<const hal::GaitSample> gait(inputs_->gait.data(), inputs_->gait.size());
    imu_refused_ += estimator_.update(inputs_->stamp, imu, gait, still);
    own_gaits_.update(estimator_.gait(), !gait.empty(), tick_s_);
  } else {
    imu_refused_ += estimator_.update(inputs_->stamp, imu, bus_.measured(), gait_phases(), still);
  }
  // Folded on the ground no foot bears load: the accelerometer alone would carry the trunk away.
  if (still || recovering) estimator_.place(footing_O_m_);
  if (walking_ready_) {
    history_.push(estimator_.state());
    note_footing(estimator_.state());
  }
  receive_poses();
}

void Autonomy::receive_poses() {
  for (const hal::PoseSample& sample : inputs_->pose) {
    const Result<PastPose> past = history_.at(sample.stamp);
    Result<estimation::PoseAtStamp> own = Status::kUnavailable;
    if (past.ok()) own = estimation::PoseAtStamp{past.value().p_OB_m, past.value().q_OB};
    // Refusals are counted by the estimator.
    static_cast<void>(estimator_.observe_pose(sample, own));
  }
}

StopReason Autonomy::find_fault() {
  if (inputs_->operator_fresh && inputs_->operator_command.emergency_stop) {
    return StopReason::kOperator;
  }
  if (imu_silent_s_ > config_.safety.imu_silence_s) return StopReason::kImuSilent;
  if (mission_.phase() == MissionPhase::kEnableDrives) return StopReason::kNone;
  if (own_gaits_.silent()) return StopReason::kDriveSilent;
  if (!own_gaits_.enabled() && bus_.faulty_joints() != 0) return StopReason::kDriveFault;
  if (!own_gaits_.enabled() && bus_.silent_joints() != 0) return StopReason::kDriveSilent;
  if (mission_.phase() == MissionPhase::kRecover) return StopReason::kNone;
  if (own_gaits_.fallen() || is_tilted(estimator_.state())) return StopReason::kTilt;
  if (!walking_ready_) return StopReason::kNone;
  const StopReason lost = navigation_fault();
  if (lost != StopReason::kNone) return lost;
  if (blocked_s() > config_.safety.foothold_patience_s) return StopReason::kNoFoothold;
  return StopReason::kNone;
}

const mapping::MapWindow* Autonomy::window() const {
  return config_.mapping.enabled ? &map_.window() : nullptr;
}

// What the contact estimator needs to know of the plan.
std::array<estimation::GaitPhase, robot::kLegs> Autonomy::gait_phases() const {
  if (walks_statically()) return static_walk_.gait_phases();
  return jump_pilot_.jumps() ? jump_pilot_.jump().gait_phases() : locomotion_.gait_phases();
}

// It does not lie on its belly with folded legs: StandUp alone would not do.
bool Autonomy::must_recover(const estimation::RobotState& state) const {
  if (own_gaits_.enabled()) return false;
  const control::RecoveryConfig& config = config_.control.recovery;
  if (control::lie_of(state.R_OB, config.upright_tilt_rad) != control::Lie::kUpright) return true;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const std::array<double, 3> folded = model_.pose_of(leg, config_.control.stand_up.folded_rad);
    for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
      const double off = state.joints[robot::joint_index(leg, i)].position_rad - folded[i];
      if (off > kFolded_rad || off < -kFolded_rad) return true;
    }
  }
  return false;
}

bool Autonomy::is_tilted(const estimation::RobotState& state) const {
  return state.R_OB(2, 2) < math::cos(config_.safety.max_tilt_rad);
}

// Tilted, or down on the belly with the feet beside it.
bool Autonomy::has_fallen(const estimation::RobotState& state) {
  if (own_gaits_.enabled()) return own_gaits_.fallen() || is_tilted(state);
  const control::RecoveryConfig& config = config_.control.recovery;
  const bool low = walking_ready_ && height_over_feet_m(state) < config.collapsed_height_m;
  collapsed_s_ = low ? collapsed_s_ + tick_s_ : 0.0;
  return is_tilted(state) || collapsed_s_ >= config.collapsed_s;
}

void Autonomy::note_footing(const estimation::RobotState& state) {
  constexpr double kUprightCosine = 0.95;  // 18 degrees
  if (state.R_OB(2, 2) < kUprightCosine) return;
  if (own_gaits_.enabled()) {
    footing_O_m_ = state.p_OB_m - Vector3(0.0, 0.0, own_gaits_.height_m());
    return;
  }
  double ground_m = 0;
  int feet = 0;
  for (const estimation::FootState& foot : state.feet) {
    if (!foot.in_contact) continue;
    ground_m += foot.p_O_m[2] - model_.foot_radius_m;
    ++feet;
  }
  if (feet < 2) return;
  footing_O_m_ = Vector3(state.p_OB_m[0], state.p_OB_m[1], ground_m / feet);
}

// How it fell is nothing that the legs have measured: until the robot stands the place is that of
// the last footing, and the map waits.
void Autonomy::recover(const estimation::RobotState& state) {
  if (mission_.phase_changed()) {
    jump_pilot_.abandon();
    if (walking_ready_) {
      recovery_.begin();
      estimator_.note_fall(state.stamp - kTrustedBeforeFall);
      history_.clear();
    }
    recovery_.start();
    walking_ready_ = false;
    collapsed_s_ = 0;
  }
  commands_ = recovery_.update(state, tick_s_);
}

void Autonomy::start_stand_up() {
  if (recovery_.done()) return stand_up_.start_folded();
  stand_up_.start(bus_.measured());
}

double Autonomy::height_over_ground_m(const estimation::RobotState& state) const {
  if (own_gaits_.enabled()) return own_gaits_.height_m();
  return height_over_feet_m(state) + model_.foot_radius_m;
}

// Stand-up is over: O gets its place on the ground below the trunk, where the feet say that it is,
// and the start pad enters the map. After a fall O stays as it was and the tracking camera says
// where the robot is in it; without one the last footing has to do, the heading is the gyro's. The
// map around the robot, off by what they do not know, is seen anew.
void Autonomy::begin_walking(const estimation::RobotState& state) {
  const Vector3 over_ground_m(0.0, 0.0, height_over_ground_m(state));
  if (has_stood_ && ok(estimator_.relocate(state.stamp))) {
    footing_O_m_ = state.p_OB_m - over_ground_m;
  } else {
    if (!has_stood_) estimator_.set_yaw(0.0);
    estimator_.place(footing_O_m_ + over_ground_m);
  }
  locomotion_.start(estimator_.state());
  static_walk_.start(estimator_.state());
  history_.clear();
  walking_ready_ = true;
  mapping::AssumedPad pad;
  pad.x_O_m = footing_O_m_[0];
  pad.y_O_m = footing_O_m_[1];
  pad.z_O_m = footing_O_m_[2];
  pad.yaw_rad = state.yaw_rad;
  pad.half_length_m = 0.5 * config_.start_pad.length_m;
  pad.half_width_m = 0.5 * config_.start_pad.width_m;
  localisation_.forget();
  stereo_.motion().forget();
  on_pad_ = !has_stood_;
  const bool seen_before = has_stood_;
  has_stood_ = true;
  if (!config_.mapping.enabled) return;
  if (seen_before) SUREFOOT_ASSERT(ok(map_.forget(pad.x_O_m, pad.y_O_m, kForget_m)));
  SUREFOOT_ASSERT(ok(map_.assume_pad(pad)));
}

// The operator vouches for a level pad: what the accelerometer takes for up is compared with it.
void Autonomy::level_on_pad() {
  on_pad_ = on_pad_ && mission_.phase() == MissionPhase::kSettle;
  if (!on_pad_ || own_gaits_.enabled() || config_.start_pad.level_gain_1_s <= 0) return;
  estimator_.level_on_pad(math::clamp(config_.start_pad.level_gain_1_s * tick_s_, 0.0, 1.0));
}

void Autonomy::act(const estimation::RobotState& state) {
  outputs_.gait = hal::GaitCommand{};
  switch (mission_.phase()) {
    case MissionPhase::kEnableDrives: break;
    case MissionPhase::kRecover: recover(state); break;
    case MissionPhase::kStandUp:
      if (mission_.phase_changed()) start_stand_up();
      commands_ = stand_up_.update(tick_s_);
      break;
    case MissionPhase::kSettle:
    case MissionPhase::kWalk:
    case MissionPhase::kArrived:
      if (!walking_ready_) begin_walking(state);
      level_on_pad();
      walk(state);
      break;
    case MissionPhase::kStopped: commands_ = bus_.damping_commands(); break;
  }
}

// What the mission wants, turned by the fields in reach. Half way to a live lock the other side is
// tried, once.
control::VelocityCommand Autonomy::avoiding(const estimation::RobotState& state) {
  control::VelocityCommand command = mission_.command();
  if (!config_.mission.avoid || mission_.phase() != MissionPhase::kWalk) return command;
  const bool stuck =
      config_.mission.live_lock_s > 0 && mission_.stuck_s() > 0.5 * config_.mission.live_lock_s;
  if (stuck && !changed_side_) avoidance_.change_side();
  changed_side_ = stuck;
  const math::SinCos yaw = math::sin_cos(state.yaw_rad);
  obstacles::Wish wish;
  wish.velocity_O_m_s = Vector2(yaw.cos * command.forward_m_s - yaw.sin * command.left_m_s,
                                yaw.sin * command.forward_m_s + yaw.cos * command.left_m_s);
  wish.path_O = mission_.path_O();
  wish.off_path_m = mission_.off_path_m(state);
  const Vector2 v =
      avoidance_.velocity_O_m_s(map_.fields(), {state.p_OB_m.head<2>(), state.yaw_rad}, wish);
  if (v == wish.velocity_O_m_s) return command;
  command.forward_m_s = yaw.cos * v[0] + yaw.sin * v[1];
  command.left_m_s = yaw.cos * v[1] - yaw.sin * v[0];
  return command;
}

// Locomotion, unless the pilot jumps.
bool Autonomy::at_rest() const {
  if (own_gaits_.enabled()) return own_gaits_.at_rest();
  return walks_statically() ? static_walk_.at_rest() : locomotion_.at_rest();
}

double Autonomy::blocked_s() const {
  if (own_gaits_.enabled()) return 0.0;
  return walks_statically() ? static_walk_.blocked_s() : locomotion_.blocked_s();
}

const std::array<control::LegStatus, robot::kLegs>& Autonomy::legs() const {
  return walks_statically() ? static_walk_.legs() : locomotion_.legs();
}

void Autonomy::walk(const estimation::RobotState& state) {
  const bool walks = mission_.phase() == MissionPhase::kWalk;
  if (own_gaits_.enabled()) {
    const control::WalkCommand command = walk_command(state);
    outputs_.gait = own_gaits_.command(command.gait, command.velocity);
    return;
  }
  if (walks_statically()) {
    const control::WalkCommand command = walk_command(state);
    commands_ = static_walk_.update(state, window(), terrain_.enabled() ? &terrain_.map() : nullptr,
                                    command.velocity, command.gait != control::GaitKind::kStand,
                                    command.ground, tick_s_);
    return;
  }
  const bool on_detour = walks && avoidance_.side() != 0;
  // What it goes round it does not jump on.
  if (on_detour && !jump_pilot_.jumps()) {
    jump_pilot_.abandon();
  } else if (config_.mission.jump && (walks || jump_pilot_.jumps())) {
    jump_pilot_.update(state, window(), footing_O_m_[2], locomotion_.at_rest(), tick_s_);
  }
  if (jump_pilot_.jumps()) {
    commands_ = jump_pilot_.joints();
    return;
  }
  if (jump_pilot_.ended()) locomotion_.start(state);
  commands_ = locomotion_.update(state, window(), walk_command(state), mpc_.plan(), tick_s_);
}

// The pilot's command, where it steers, comes before the mission's.
control::WalkCommand Autonomy::walk_command(const estimation::RobotState& state) {
  const bool pilot = jump_pilot_.steers() && mission_.phase() == MissionPhase::kWalk;
  velocity_ = avoiding(state);
  if (pilot) velocity_ = jump_pilot_.command();
  return {velocity_, pilot ? jump_pilot_.gait(mission_.gait()) : mission_.gait(),
          config_.mission.unseen_ground ? control::GroundRule::kGoodOrUnseen
                                        : control::GroundRule::kGood};
}

bool Autonomy::locomotion_acts() const {
  const MissionPhase phase = mission_.phase();
  return phase == MissionPhase::kSettle || phase == MissionPhase::kWalk ||
         phase == MissionPhase::kArrived;
}

void Autonomy::send() {
  outputs_.can.clear();
  if (own_gaits_.enabled()) return;
  if (mission_.phase() == MissionPhase::kEnableDrives) {
    if (!ok(bus_.enable(outputs_.can))) ++encode_refused_;
    return;
  }
  if (!ok(bus_.encode(commands_, outputs_.can))) ++encode_refused_;
}

// Pictures are taken while the trunk is steady: every one is placed by the pose of one instant.
void Autonomy::watch(const estimation::RobotState& state) {
  StereoMoment moment;
  moment.standing = stereo_.enabled() && walking_ready_ && locomotion_acts();
  moment.shifted = walks_statically() && static_walk_.shifted();
  moment.turn_rate_rad_s = math::sqrt(state.angular_velocity_B_rad_s.squaredNorm());
  moment.speed_m_s = math::sqrt(state.v_OB_m_s.squaredNorm());
  outputs_.stereo_trigger = trigger_.update(moment, tick_s_);
  if (!outputs_.stereo_trigger) return;
  ++outputs_.telemetry.stereo.triggers;
  stereo_.motion().note_trigger(state.stamp);
  estimator_.note_exposure(state.stamp);
}

bool Autonomy::begin_mpc(const TickInputs& inputs) {
  if (walks_statically() || own_gaits_.enabled()) return false;
  if (!walking_ready_ || !locomotion_acts() || jump_pilot_.jumps()) return false;
  locomotion_.plan(estimator_.state(), mpc_.problem());
  mpc_.release(inputs.stamp);
  return true;
}

bool Autonomy::begin_stereo(const TickInputs& inputs) {
  if (!inputs.stereo_fresh || !walking_ready_) return false;
  return stereo_.release(*inputs.stereo, history_);
}

void Autonomy::publish_stereo() {
  stereo_.publish();
  if (!stereo_.motion().enabled()) return;
  const Vector3 p_OB_m = estimator_.state().p_OB_m;
  const estimation::DriftCorrection off = estimator_.observe_motion(stereo_.motion().publish());
  history_.move({p_OB_m, off.shift_O_m, off.yaw_rad});
}

// What the robot's eyes have made of the ground in this tick, once; frame null: nothing.
Autonomy::Sight Autonomy::take_sight(const TickInputs& inputs) {
  if (!stereo_.maps()) return {inputs.depth_fresh ? inputs.depth : nullptr, nullptr};
  const StereoPicture* const picture = stereo_.take();
  if (picture == nullptr) return {};
  return {&picture->depth, &picture->noise};
}

bool Autonomy::begin_localisation(const TickInputs& inputs) {
  if (!localisation_.enabled() || !walking_ready_) return false;
  const Sight sight = take_sight(inputs);
  return sight.frame != nullptr &&
         localisation_.release(*sight.frame, sight.noise, history_.at(sight.frame->stamp));
}

// Dead reckoning was off: O stays where the map is, and the robot is elsewhere in it.
void Autonomy::publish_localisation() {
  localisation_.publish();
  const OdometryShift& shift = localisation_.shift();
  const Vector3& p_OB_m = estimator_.state().p_OB_m;
  estimator_.shift(shift(p_OB_m) - p_OB_m, shift.yaw_rad);
  history_.move(shift);
}

bool Autonomy::begin_mapping(const TickInputs& inputs) {
  if (!walking_ready_) return false;
  const Vector3& centre_O_m = estimator_.state().p_OB_m;
  if (localisation_.enabled()) {
    const PosedPicture* const picture = localisation_.take();
    return picture != nullptr &&
           map_.release(picture->frame, picture->noise(), picture->pose, centre_O_m);
  }
  const Sight sight = take_sight(inputs);
  return sight.frame != nullptr &&
         map_.release(*sight.frame, sight.noise, history_.at(sight.frame->stamp), centre_O_m);
}

bool Autonomy::begin_terrain(const TickInputs&) {
  if (!walking_ready_) return false;
  return terrain_.release(map_.window(), map_.window_digest(), estimator_.state().yaw_rad);
}

}  // namespace surefoot::autonomy
