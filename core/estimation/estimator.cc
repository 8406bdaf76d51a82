#include "core/estimation/estimator.h"

#include "core/math/elementary.h"
#include "core/robot/kinematics.h"

namespace surefoot::estimation {
namespace {

// The accelerometer carries the legs' velocity over a flight phase, for so long.
constexpr double kFlight_s = 0.1;

}  // namespace

void Estimator::reset(const EstimationConfig& config, const robot::RobotModel& model,
                      double tick_s) {
  model_ = model;
  tick_s_ = tick_s;
  attitude_.reset(config.attitude, model.imu);
  contact_.reset(config.contact, model, tick_s);
  body_.reset(config.body);
  camera_ = CameraMount(model.tracking_camera);
  drift_.reset(config.tracking);
  relocation_.reset();
  fuses_ = false;
  has_gait_ = false;
  gait_ = hal::GaitSample{};
  state_ = RobotState{};
}

void Estimator::place(const Vector3& p_OB_m) {
  body_.initialise(p_OB_m);
  drift_.restart();
  if (fuses_) fusion_.place(p_OB_m, state_.yaw_rad);
  fused_O_m_ = p_OB_m;
  state_.p_OB_m = p_OB_m;
  state_.v_OB_m_s.setZero();
  place_feet();
}

void Estimator::set_yaw(double yaw_rad) {
  attitude_.set_yaw(yaw_rad);
  state_.q_OB = attitude_.q_OB();
  state_.R_OB = attitude_.R_OB();
  state_.yaw_rad = yaw_rad;
  if (fuses_) {
    fusion_.give_attitude(state_.R_OB);
    fusion_.place(state_.p_OB_m, yaw_rad);
  }
  place_feet();
}

void Estimator::level_on_pad(double share) {
  for (const FootState& foot : state_.feet) {
    if (!foot.in_contact) return;
  }
  // Across the diagonals: with four feet the normal of the least-squares plane is near enough.
  const auto& feet = state_.feet;
  const Vector3 rising = feet[robot::kFrontLeft].p_B_m - feet[robot::kHindRight].p_B_m;
  const Vector3 falling = feet[robot::kHindLeft].p_B_m - feet[robot::kFrontRight].p_B_m;
  const Vector3 up_B = rising.cross(falling);
  attitude_.level(up_B / math::sqrt(up_B.squaredNorm()), share);
}

void Estimator::shift(const Vector3& shift_O_m, double yaw_rad) {
  attitude_.correct_yaw(yaw_rad, 0.0);
  body_.move(shift_O_m, yaw_rad);
}

Status Estimator::fuse_camera(const FusionConfig& config, const Matrix3& R_BN,
                              const Vector3& p_BN_m) {
  const Status configured = fusion_.configure(config, R_BN, p_BN_m);
  fuses_ = ok(configured);
  return configured;
}

// How the trunk has moved in this tick by the legs. What feet in contact agree on is better than
// the velocity that the filter makes of it.
LegOdometry Estimator::leg_odometry() {
  LegOdometry legs;
  uncarried_s_ = body_.carried() ? 0.0 : uncarried_s_ + tick_s_;
  legs.valid = uncarried_s_ < kFlight_s;
  legs.v_B_m_s = state_.R_OB.transpose() * (body_.p_OB_m() - fused_O_m_) / tick_s_;
  int contacts = 0;
  for (const FootState& foot : state_.feet) contacts += foot.in_contact;
  const auto slipping = static_cast<double>(body_.slips() - slips_);
  slips_ = body_.slips();
  if (contacts > 0) legs.slip = math::clamp(slipping / contacts, 0.0, 1.0);
  return legs;
}

void Estimator::fuse(const LegOdometry& legs) {
  // Both are finite, the attitude is one: refusals are a defect here.
  SUREFOOT_ASSERT(ok(fusion_.update(state_.R_OB, legs, tick_s_)));
  static_cast<void>(follow_fusion());
}

// Attitude and body state go where the fusion is.
DriftCorrection Estimator::follow_fusion() {
  DriftCorrection correction;
  correction.shift_O_m = fusion_.p_OB_m() - body_.p_OB_m();
  correction.yaw_rad = fusion_.yaw_offset_rad();
  shift(correction.shift_O_m, correction.yaw_rad);
  fusion_.give_attitude(attitude_.R_OB());
  fused_O_m_ = body_.p_OB_m();
  return correction;
}

void Estimator::note_exposure(TimeNs tick) {
  if (fuses_) fusion_.note_exposure(tick);
}

DriftCorrection Estimator::observe_motion(const VisualMotion& motion) {
  if (!fuses_) return {};
  if (!ok(fusion_.observe(motion))) return {};
  return follow_fusion();
}

void Estimator::place_feet() {
  for (FootState& foot : state_.feet) foot.p_O_m = state_.p_OB_m + state_.R_OB * foot.p_B_m;
}

std::size_t Estimator::observe_attitude(std::span<const hal::ImuSample> imu, bool lying_still,
                                        bool carried) {
  std::size_t refused = 0;
  for (const hal::ImuSample& sample : imu) {
    if (!ok(attitude_.update(sample, lying_still, carried))) ++refused;
  }
  if (!attitude_.initialised()) return refused;
  state_.q_OB = attitude_.q_OB();
  state_.R_OB = attitude_.R_OB();
  state_.angular_velocity_B_rad_s = attitude_.angular_velocity_B_rad_s();
  state_.yaw_rad = math::atan2(state_.R_OB(1, 0), state_.R_OB(0, 0));
  return refused;
}

std::size_t Estimator::update(TimeNs stamp, std::span<const hal::ImuSample> imu,
                              const std::array<actuation::JointState, robot::kJoints>& joints,
                              const std::array<GaitPhase, robot::kLegs>& gait, bool lying_still) {
  const std::size_t refused = observe_attitude(imu, lying_still, body_.carried());
  state_.stamp = stamp;
  state_.joints = joints;
  if (!attitude_.initialised()) return refused;
  observe_feet();
  decide_contacts(gait);
  const Vector3 acceleration_O =
      state_.R_OB * attitude_.specific_force_B_m_s2() - Vector3(0.0, 0.0, kGravity_m_s2);
  body_.update(acceleration_O, observations_, tick_s_);
  attitude_.level_by_feet(body_.correction_O_m_s());
  if (fuses_) fuse(leg_odometry());

  state_.p_OB_m = body_.p_OB_m();
  state_.v_OB_m_s = body_.v_OB_m_s();
  place_feet();
  return refused;
}

std::size_t Estimator::update(TimeNs stamp, std::span<const hal::ImuSample> imu,
                              std::span<const hal::GaitSample> gait, bool lying_still) {
  std::size_t refused = observe_attitude(imu, lying_still, has_gait_);
  state_.stamp = stamp;
  for (const hal::GaitSample& sample : gait) {
    const Vector3 v_B_m_s(sample.velocity_B_m_s[0], sample.velocity_B_m_s[1],
                          sample.velocity_B_m_s[2]);
    const bool finite = math::is_finite(v_B_m_s.squaredNorm()) && math::is_finite(sample.height_m);
    if (!finite || (has_gait_ && sample.stamp <= gait_.stamp)) {
      ++refused;
      continue;
    }
    const double since_s = has_gait_ ? (sample.stamp - gait_.stamp).seconds() : 0.0;
    gait_ = sample;
    has_gait_ = true;
    if (attitude_.initialised()) body_.carry(state_.R_OB * v_B_m_s, since_s);
  }
  if (fuses_ && attitude_.initialised() && has_gait_) {
    LegOdometry legs;
    legs.valid = (stamp - gait_.stamp).seconds() < kFlight_s;
    legs.v_B_m_s =
        Vector3(gait_.velocity_B_m_s[0], gait_.velocity_B_m_s[1], gait_.velocity_B_m_s[2]);
    fuse(legs);
  }
  state_.p_OB_m = body_.p_OB_m();
  state_.v_OB_m_s = body_.v_OB_m_s();
  return refused;
}

Status Estimator::observe_pose(const hal::PoseSample& sample, const Result<PoseAtStamp>& own) {
  const Status checked = drift_.check(sample);
  if (!ok(checked)) return checked;
  const CameraPose camera = camera_.trunk(sample);
  if (!own.ok()) {
    drift_.count_without_pose();
    relocation_.observe(camera);
    return Status::kOk;
  }
  relocation_.observe(camera, own.value());
  const DriftCorrection correction = drift_.observe(camera, own.value());
  attitude_.correct_yaw(correction.yaw_rad, correction.yaw_bias_rad_s);
  body_.move(correction.shift_O_m, correction.yaw_rad);
  return Status::kOk;
}

Status Estimator::relocate(TimeNs now) {
  const Result<PoseAtStamp> pose = relocation_.pose(now);
  if (!pose.ok()) return pose.status();
  const Matrix3 R_OB = geometry::to_matrix(pose.value().q_OB);
  set_yaw(math::atan2(R_OB(1, 0), R_OB(0, 0)));
  place(pose.value().p_OB_m);
  drift_.count_relocation();
  return Status::kOk;
}

void Estimator::decide_contacts(const std::array<GaitPhase, robot::kLegs>& gait) {
  std::array<FootMotion, robot::kLegs> motion;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    motion[leg].jacobian_B = state_.feet[leg].jacobian_B;
    motion[leg].vertical_velocity_O_m_s =
        state_.v_OB_m_s[2] + observations_[leg].velocity_from_body_O_m_s[2];
  }
  contact_.update(
      state_.joints, gait, motion,
      {state_.R_OB, state_.angular_velocity_B_rad_s, attitude_.specific_force_B_m_s2()});
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    const FootContact& contact = contact_.feet()[leg];
    state_.feet[leg].in_contact = contact.in_contact;
    state_.feet[leg].ticks_since_change = contact.ticks_since_change;
    state_.feet[leg].force_O_N = contact.force_O_N;
    observations_[leg].in_contact = contact.in_contact;
  }
}

void Estimator::observe_feet() {
  const Vector3& omega_B = state_.angular_velocity_B_rad_s;
  const Vector3 contact_to_centre_O(0.0, 0.0, model_.foot_radius_m);
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    Vector3 q;
    Vector3 qd;
    for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
      const actuation::JointState& joint = state_.joints[robot::joint_index(leg, i)];
      q[static_cast<Eigen::Index>(i)] = joint.position_rad;
      qd[static_cast<Eigen::Index>(i)] = joint.velocity_rad_s;
    }
    FootState& foot = state_.feet[leg];
    foot.p_B_m = robot::foot_position_B_m(model_, leg, q);
    foot.jacobian_B = robot::foot_jacobian_B(model_, leg, q);
    foot.v_B_m_s = foot.jacobian_B * qd;

    FootObservation& observation = observations_[leg];
    observation.from_body_O_m = state_.R_OB * foot.p_B_m;
    observation.velocity_from_body_O_m_s = state_.R_OB * (foot.v_B_m_s + omega_B.cross(foot.p_B_m));
    const Vector3 shank_omega_O = state_.R_OB * (omega_B + robot::shank_angular_velocity_B(q, qd));
    observation.rolling_velocity_O_m_s = shank_omega_O.cross(contact_to_centre_O);
  }
}

}  // namespace surefoot::estimation
