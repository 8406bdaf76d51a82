#include "core/estimation/body_state.h"

#include "core/geometry/rotations.h"
#include "core/math/elementary.h"

namespace surefoot::estimation {
namespace {

constexpr double kUnknownFootVariance_m2 = 1.0;  // of a foot without contact
constexpr int kFirstFoot = 2;                    // index of foot 0 in the state

int foot_state(std::size_t leg) { return kFirstFoot + static_cast<int>(leg); }

}  // namespace

void BodyStateEstimator::reset(const BodyStateConfig& config) {
  config_ = config;
  initialise(Vector3::Zero());
}

void BodyStateEstimator::initialise(const Vector3& p_OB_m) {
  p_O_m_ = p_OB_m;
  v_O_m_s_.setZero();
  feet_O_m_.fill(Vector3::Zero());
  landmark_.fill(false);
  slips_ = 0;
  carried_ = false;
  fresh_ = true;
  correction_O_m_s_.setZero();
  covariance_.setZero();
  covariance_(0, 0) = 1e-8;
  covariance_(1, 1) = 1e-4;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    covariance_(foot_state(leg), foot_state(leg)) = kUnknownFootVariance_m2;
  }
}

void BodyStateEstimator::update(const Vector3& acceleration_O_m_s2,
                                const std::array<FootObservation, robot::kLegs>& feet,
                                double step_s) {
  predict(acceleration_O_m_s2, feet, step_s);
  const Vector3 predicted_O_m_s = v_O_m_s_;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    if (feet[leg].in_contact) {
      correct_with_foot(leg, feet[leg]);
    } else {
      landmark_[leg] = false;
    }
  }
  correction_O_m_s_ = fresh_ ? Vector3(Vector3::Zero()) : Vector3(v_O_m_s_ - predicted_O_m_s);
  fresh_ = false;
  carried_ = landmark_[0] || landmark_[1] || landmark_[2] || landmark_[3];
}

void BodyStateEstimator::carry(const Vector3& v_OB_m_s, double step_s) {
  v_O_m_s_ = v_OB_m_s;
  p_O_m_ += step_s * v_OB_m_s;
}

void BodyStateEstimator::move(const Vector3& shift_O_m, double yaw_rad) {
  const Matrix3 turn = geometry::rotation_z(yaw_rad);
  for (Vector3& foot : feet_O_m_) foot = p_O_m_ + shift_O_m + turn * (foot - p_O_m_);
  p_O_m_ += shift_O_m;
  v_O_m_s_ = turn * v_O_m_s_;
}

void BodyStateEstimator::correct_with_foot(std::size_t leg, const FootObservation& foot) {
  const double position_variance = math::square(config_.foot_position_noise_m);
  const double velocity_variance = math::square(config_.foot_velocity_noise_m_s);
  const Vector3 innovation = foot.rolling_velocity_O_m_s - foot.velocity_from_body_O_m_s - v_O_m_s_;
  const double gate = math::square(config_.slip_gate_sigma);
  if (innovation.squaredNorm() > gate * (covariance_(1, 1) + velocity_variance)) {
    landmark_[leg] = false;
    ++slips_;
    return;
  }
  if (!landmark_[leg]) start_landmark(leg, foot);
  StateVector h = StateVector::Zero();
  h[1] = 1.0;
  correct(h, innovation, velocity_variance);
  h[1] = 0.0;
  h[foot_state(leg)] = 1.0;
  h[0] = -1.0;
  correct(h, foot.from_body_O_m - (feet_O_m_[leg] - p_O_m_), position_variance);
}

void BodyStateEstimator::predict(const Vector3& acceleration,
                                 const std::array<FootObservation, robot::kLegs>& feet,
                                 double step_s) {
  p_O_m_ += v_O_m_s_ * step_s + acceleration * (0.5 * step_s * step_s);
  v_O_m_s_ += acceleration * step_s;

  // F = identity with F(p, v) = step: rows and columns of p take a share of v.
  covariance_.row(0) += covariance_.row(1) * step_s;
  covariance_.col(0) += covariance_.col(1) * step_s;
  covariance_(1, 1) += math::square(config_.accelerometer_noise_m_s2_sqrtHz) * step_s;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    if (!feet[leg].in_contact) continue;
    feet_O_m_[leg] += feet[leg].rolling_velocity_O_m_s * step_s;
    covariance_(foot_state(leg), foot_state(leg)) +=
        math::square(config_.foot_slip_noise_m_sqrt_s) * step_s;
  }
}

// A foot that has just touched down: nothing is known of its place but what the leg says.
void BodyStateEstimator::start_landmark(std::size_t leg, const FootObservation& foot) {
  const int i = foot_state(leg);
  covariance_.row(i).setZero();
  covariance_.col(i).setZero();
  covariance_(i, i) = kUnknownFootVariance_m2;
  feet_O_m_[leg] = p_O_m_ + foot.from_body_O_m;
  landmark_[leg] = true;
}

void BodyStateEstimator::correct(const StateVector& h, const Vector3& innovation, double variance) {
  const StateVector ph = covariance_ * h;
  const double innovation_variance = h.dot(ph) + variance;
  const StateVector gain = ph / innovation_variance;
  p_O_m_ += innovation * gain[0];
  v_O_m_s_ += innovation * gain[1];
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    feet_O_m_[leg] += innovation * gain[foot_state(leg)];
  }
  // Symmetric by construction: the same products on both sides of the diagonal.
  covariance_ -= gain * ph.transpose();
  covariance_ = (covariance_ + covariance_.transpose().eval()) * 0.5;
}

}  // namespace surefoot::estimation
