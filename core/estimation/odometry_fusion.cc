#include "core/estimation/odometry_fusion.h"

#include <Eigen/Cholesky>

#include "core/geometry/rotations.h"
#include "core/math/elementary.h"

namespace surefoot::estimation {
namespace {

constexpr double kRotationTolerance = 1e-6;
constexpr double kStartVariance = 1e-12;

// How a place moves as O turns about up.
Vector3 about_up(const Vector3& p_O_m) { return {-p_O_m.y(), p_O_m.x(), 0}; }

}  // namespace

Status OdometryFusion::configure(const FusionConfig& config, const Matrix3& R_BN,
                                 const Vector3& p_BN_m) {
  RangeCheck check;
  FusionConfig::describe(config, check);
  if (!check.good || !geometry::is_rotation(R_BN, kRotationTolerance)) return Status::kInvalid;
  if (!math::is_finite(p_BN_m.squaredNorm())) return Status::kInvalid;
  config_ = config;
  R_BN_ = R_BN;
  p_BN_m_ = p_BN_m;
  R_given_ = Matrix3::Identity();
  counters_ = {};
  place(Vector3::Zero(), 0);
  return Status::kOk;
}

void OdometryFusion::place(const Vector3& p_OB_m, double yaw_rad) {
  const double given_yaw_rad = geometry::to_roll_pitch_yaw(R_given_)[2];
  p_m_ = p_OB_m;
  yaw_rad_ = math::wrap_angle(yaw_rad - given_yaw_rad);
  tilt_rad_.setZero();
  R_ = attitude();
  rate_rad_s_ = 0;
  leg_error_m_s_.setZero();
  last_v_B_m_s_.setZero();
  common_.setZero();
  key_ = {};
  now_ = {};
  covariance_.setZero();
  for (int i = 0; i < kYaw + 1; ++i) covariance_(i, i) = kStartVariance;
  covariance_(kRate, kRate) = math::square(config_.gyro_bias_rad_s);
  for (int i = 0; i < 3; ++i) covariance_(kLeg + i, kLeg + i) = math::square(config_.leg_error_m_s);
  for (int i = 0; i < 6; ++i) covariance_(kCommon + i, kCommon + i) = 1;
  for (int i = 0; i < 2; ++i) covariance_(kTilt + i, kTilt + i) = math::square(config_.tilt_rad);
}

Matrix3 OdometryFusion::attitude() const {
  const Vector3 tilt(tilt_rad_.x(), tilt_rad_.y(), 0);
  return geometry::to_matrix(geometry::from_rotation_vector(tilt)) *
         geometry::rotation_z(yaw_rad_) * R_given_;
}

Status OdometryFusion::update(const Matrix3& R_OB, const LegOdometry& legs, double step_s) {
  const bool finite = math::is_finite(legs.v_B_m_s.squaredNorm()) && math::is_finite(legs.slip) &&
                      math::is_finite(step_s);
  if (!finite || !(step_s > 0)) return Status::kInvalid;
  if (!geometry::is_rotation(R_OB, kRotationTolerance)) return Status::kInvalid;
  if (legs.valid) last_v_B_m_s_ = legs.v_B_m_s;
  R_given_ = R_OB;
  yaw_rad_ = math::wrap_angle(yaw_rad_ + rate_rad_s_ * step_s);
  R_ = attitude();
  const Vector3 v_O_m_s = R_ * (last_v_B_m_s_ - leg_error_m_s_);
  p_m_ += v_O_m_s * step_s;
  propagate_covariance(v_O_m_s, step_s);
  add_noise(last_v_B_m_s_.norm(), legs, step_s);
  return Status::kOk;
}

void OdometryFusion::give_attitude(const Matrix3& R_OB) {
  yaw_rad_ = math::wrap_angle(yaw_rad_ - geometry::turn_about_z_rad(R_given_, R_OB));
  R_given_ = R_OB;
}

// What position takes of the other states' errors in a step, to be done on rows and on columns.
struct OdometryFusion::Step {
  double step_s = 0;
  double keep_leg = 1;
  double keep_tilt = 1;
  Eigen::Matrix<double, 3, 6> into_position;  // of yaw's rate, the legs' error, tilt

  template <class Line>
  void apply(Line&& line) const {
    Vector6 from;
    from << line[kRate], line[kLeg], line[kLeg + 1], line[kLeg + 2], line[kTilt], line[kTilt + 1];
    const Vector3 sum = into_position * from;
    for (int i = 0; i < 3; ++i) line[kPosition + i] += sum[i];
    line[kYaw] += step_s * line[kRate];
    for (int i = 0; i < 3; ++i) line[kLeg + i] *= keep_leg;
    for (int i = 0; i < 2; ++i) line[kTilt + i] *= keep_tilt;
  }
};

void OdometryFusion::propagate_covariance(const Vector3& v_O_m_s, double step_s) {
  Step step;
  step.step_s = step_s;
  step.keep_leg = 1.0 / (1.0 + step_s / config_.leg_memory_s);
  step.keep_tilt = 1.0 / (1.0 + step_s / config_.tilt_memory_s);
  step.into_position.col(0) = -step_s * about_up(p_m_);
  step.into_position.block<3, 3>(0, 1) = -step_s * R_;
  step.into_position.col(4) = step_s * Vector3::UnitX().cross(v_O_m_s);
  step.into_position.col(5) = step_s * Vector3::UnitY().cross(v_O_m_s);
  for (int column = 0; column < kStates; ++column) step.apply(covariance_.col(column));
  for (int row = 0; row < kStates; ++row) step.apply(covariance_.row(row));
  leg_error_m_s_ *= step.keep_leg;
  tilt_rad_ *= step.keep_tilt;
}

void OdometryFusion::add_noise(double speed_m_s, const LegOdometry& legs, double step_s) {
  const double slip = math::clamp(legs.slip, 0.0, 1.0);
  const double keep = 1.0 / (1.0 + step_s / config_.leg_memory_s);
  const double steady = config_.leg_error_m_s + config_.leg_error_share * speed_m_s;
  for (int i = 0; i < 3; ++i) {
    const double share = i == 2 ? config_.leg_vertical_factor : 1.0;
    double variance = math::square(share * steady) + math::square(slip * config_.leg_slip_m_s);
    if (!legs.valid) variance = math::square(config_.no_leg_m_s);
    covariance_(kLeg + i, kLeg + i) += variance * (1.0 - keep * keep);
    covariance_(kPosition + i, kPosition + i) += math::square(config_.leg_noise_m_sqrt_s) * step_s;
  }
  const double keep_tilt = 1.0 / (1.0 + step_s / config_.tilt_memory_s);
  for (int i = 0; i < 2; ++i) {
    covariance_(kTilt + i, kTilt + i) +=
        math::square(config_.tilt_rad) * (1.0 - keep_tilt * keep_tilt);
  }
  // Yaw's own noise leaves the place where it is: the turn about O's origin is taken back.
  Eigen::Matrix<double, 4, 1> turn;
  turn << -about_up(p_m_), 1.0;
  covariance_.topLeftCorner<4, 4>() +=
      math::square(config_.gyro_noise_rad_sqrt_s) * step_s * turn * turn.transpose();
  covariance_(kRate, kRate) += math::square(config_.gyro_drift_rad_s_sqrt_s) * step_s;
}

// (p, yaw) of a clone becomes that of another, with all its correlations.
void OdometryFusion::copy_clone(int to, int from) {
  for (int i = 0; i < 4; ++i) {
    for (int column = 0; column < kStates; ++column) {
      covariance_(to + i, column) = covariance_(from + i, column);
    }
  }
  for (int i = 0; i < 4; ++i) {
    for (int row = 0; row < kStates; ++row) covariance_(row, to + i) = covariance_(row, from + i);
  }
}

void OdometryFusion::note_exposure(TimeNs stamp) {
  copy_clone(kNow, kPosition);
  now_ = {true, stamp, p_m_, R_};
}

// What the motions from the last keyframe had in common is over.
void OdometryFusion::take_keyframe(TimeNs stamp) {
  if (!now_.known || now_.stamp != stamp) {
    key_.known = false;
    return;
  }
  copy_clone(kKey, kNow);
  key_ = now_;
  common_.setZero();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < kStates; ++j) {
      covariance_(kCommon + i, j) = 0;
      covariance_(j, kCommon + i) = 0;
    }
    covariance_(kCommon + i, kCommon + i) = 1;
  }
}

Status OdometryFusion::observe(const VisualMotion& motion) {
  Status status = Status::kOk;
  if (motion.valid) {
    Innovation innovation;
    const bool known =
        key_.known && now_.known && key_.stamp == motion.from && now_.stamp == motion.to;
    if (!known) {
      status = Status::kUnavailable;
      ++counters_.unmatched;
    } else if (!make_innovation(motion, innovation)) {
      status = Status::kInvalid;
      ++counters_.refused;
    } else {
      status = correct(innovation);
      if (ok(status)) ++counters_.used;
      if (!ok(status)) ++counters_.outliers;
    }
  }
  if (motion.new_keyframe) take_keyframe(motion.to);
  return status;
}

// False: not a motion with a covariance.
bool OdometryFusion::make_innovation(const VisualMotion& motion, Innovation& out) const {
  if (!geometry::is_rotation(motion.R_KN, kRotationTolerance)) return false;
  if (!math::is_finite(motion.p_KN_m.squaredNorm())) return false;
  if (!math::is_finite(motion.covariance.squaredNorm())) return false;
  const Eigen::LLT<Matrix6> root(motion.covariance);
  if (root.info() != Eigen::Success) return false;
  const Matrix6 L = root.matrixL();
  const double share = config_.common_share;
  const Matrix6 common = math::sqrt(share) * L;

  const Vector3 lever_key = key_.R * p_BN_m_;
  const Vector3 lever_now = now_.R * p_BN_m_;
  const Vector3 between = now_.p_m + lever_now - key_.p_m - lever_key;
  const Matrix3 R_KO = (key_.R * R_BN_).transpose();
  const Matrix3 R_KN = R_KO * now_.R * R_BN_;
  out.error.head<3>() = motion.p_KN_m - R_KO * between;
  out.error.tail<3>() = geometry::to_rotation_vector(motion.R_KN * R_KN.transpose());
  out.error -= common * common_;

  const Vector3 turn = R_KO * about_up(now_.p_m + lever_now);
  out.jacobian.setZero();
  out.jacobian.block<3, 3>(0, kKey) = -R_KO;
  out.jacobian.block<3, 3>(0, kNow) = R_KO;
  out.jacobian.block<3, 1>(0, kKey + 3) = -turn;
  out.jacobian.block<3, 1>(0, kNow + 3) = turn;
  out.jacobian.block<3, 1>(3, kKey + 3) = -R_KO.col(2);
  out.jacobian.block<3, 1>(3, kNow + 3) = R_KO.col(2);
  out.jacobian.block<6, 6>(0, kCommon) = common;

  // A wrong "up" turns the way as it turned both odometers'; what has changed since is a turn of
  // its own, at either picture.
  const Vector3 way = now_.p_m - key_.p_m;
  Eigen::Matrix<double, 6, 4> change = Eigen::Matrix<double, 6, 4>::Zero();
  for (int axis = 0; axis < 2; ++axis) {
    const Vector3 about = Vector3::Unit(axis);
    out.jacobian.block<3, 1>(0, kTilt + axis) = R_KO * way.cross(about);
    change.block<3, 1>(0, axis) = R_KO * about.cross(lever_now);
    change.block<3, 1>(3, axis) = R_KO.col(axis);
    change.block<3, 1>(0, 2 + axis) = R_KO * Vector3(between + lever_key).cross(about);
    change.block<3, 1>(3, 2 + axis) = -R_KO.col(axis);
  }
  change *= config_.tilt_change_rad;
  out.noise = (1.0 - share) * motion.covariance + change * change.transpose();
  return true;
}

Status OdometryFusion::correct(const Innovation& innovation) {
  Rows weighted = Rows::Zero();  // H P
  for (int column = 0; column < kStates; ++column) {
    for (int k = kKey; k < kStates; ++k) {
      weighted.col(column) += innovation.jacobian.col(k) * covariance_(k, column);
    }
  }
  Matrix6 spread = innovation.noise;
  for (int k = kKey; k < kStates; ++k) {
    spread += weighted.col(k) * innovation.jacobian.col(k).transpose();
  }
  const Matrix6 symmetric = 0.5 * (spread + spread.transpose());
  const Eigen::LLT<Matrix6> factors(symmetric);
  if (factors.info() != Eigen::Success) return Status::kOutOfRange;
  const Vector6 solved = factors.solve(innovation.error);
  const double chi2 = innovation.error.dot(solved);
  if (!(chi2 <= 6.0 * math::square(config_.gate_sigma))) return Status::kOutOfRange;
  Eigen::Matrix<double, kStates, 1> change;
  for (int i = 0; i < kStates; ++i) change[i] = weighted.col(i).dot(solved);
  // L^-1 H P: its square is what the covariance loses, symmetric by construction.
  Rows lost = weighted;
  for (int column = 0; column < kStates; ++column) {
    const Vector6 root = factors.matrixL().solve(Vector6(weighted.col(column)));
    lost.col(column) = root;
  }
  for (int i = 0; i < kStates; ++i) {
    for (int j = 0; j <= i; ++j) {
      const double value =
          0.5 * (covariance_(i, j) + covariance_(j, i)) - lost.col(i).dot(lost.col(j));
      covariance_(i, j) = value;
      covariance_(j, i) = value;
    }
  }
  apply(change);
  return Status::kOk;
}

// Turns a pose about O's up axis through its origin, then moves it.
void OdometryFusion::move(const Vector3& shift_m, double yaw_rad, Vector3& p_m, Matrix3& R) {
  const Matrix3 turn = geometry::rotation_z(yaw_rad);
  p_m = turn * p_m + shift_m;
  R = turn * R;
}

void OdometryFusion::apply(const Eigen::Matrix<double, kStates, 1>& change) {
  move(change.segment<3>(kPosition), change[kYaw], p_m_, R_);
  move(change.segment<3>(kKey), change[kKey + 3], key_.p_m, key_.R);
  move(change.segment<3>(kNow), change[kNow + 3], now_.p_m, now_.R);
  yaw_rad_ = math::wrap_angle(yaw_rad_ + change[kYaw]);
  rate_rad_s_ += change[kRate];
  leg_error_m_s_ += change.segment<3>(kLeg);
  common_ += change.segment<6>(kCommon);
  const Vector3 tilt(change[kTilt], change[kTilt + 1], 0);
  const Matrix3 tilting = geometry::to_matrix(geometry::from_rotation_vector(tilt));
  key_.R = tilting * key_.R;
  now_.R = tilting * now_.R;
  tilt_rad_ += change.segment<2>(kTilt);
  R_ = attitude();
}

OdometryFusion::PoseCovariance OdometryFusion::pose_covariance() const {
  PoseCovariance turn = PoseCovariance::Identity();
  turn.topRightCorner<3, 1>() = about_up(p_m_);
  return turn * covariance_.topLeftCorner<4, 4>() * turn.transpose();
}

}  // namespace surefoot::estimation
