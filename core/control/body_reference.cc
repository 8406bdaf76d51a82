#include "core/control/body_reference.h"

#include <Eigen/Cholesky>

#include "core/math/elementary.h"

namespace surefoot::control {
namespace {

constexpr double kMaxYawError_rad = 0.3;
constexpr double kMaxTilt_rad = 0.35;

double approach(double value, double target, double step_s, double time_constant_s) {
  return value + (target - value) * math::clamp(step_s / time_constant_s, 0.0, 1.0);
}

}  // namespace

void BodyReferenceTracker::reset(const BodyConfig& config, const robot::RobotModel& model) {
  *this = BodyReferenceTracker{};
  config_ = config;
  foot_radius_m_ = model.foot_radius_m;
}

void BodyReferenceTracker::start(const estimation::RobotState& state) {
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    contact_O_m_[leg] = state.feet[leg].p_O_m - Vector3(0.0, 0.0, foot_radius_m_);
  }
  const Plane plane = fit_plane(state);
  reference_ = BodyReference{};
  reference_.p_OB_m = state.p_OB_m;
  reference_.yaw_rad = state.yaw_rad;
  reference_.ground_z_m = plane.height_m;
}

BodyReferenceTracker::Plane BodyReferenceTracker::fit_plane(
    const estimation::RobotState& state) const {
  const math::SinCos yaw = math::sin_cos(state.yaw_rad);
  Matrix3 normal = Matrix3::Zero();
  Vector3 right = Vector3::Zero();
  for (const Vector3& contact : contact_O_m_) {
    const Vector3 offset = contact - state.p_OB_m;
    const Vector3 row(1.0, yaw.cos * offset[0] + yaw.sin * offset[1],
                      yaw.cos * offset[1] - yaw.sin * offset[0]);
    normal += row * row.transpose();
    right += row * contact[2];
  }
  // Feet on one line leave the slope open: a small prior of level ground decides.
  constexpr double kLevelPrior_m2 = 1e-3;
  normal(1, 1) += kLevelPrior_m2;
  normal(2, 2) += kLevelPrior_m2;
  const Vector3 plane = normal.llt().solve(right);
  return {plane[0], plane[1], plane[2]};
}

void BodyReferenceTracker::follow_ground(const estimation::RobotState& state, double step_s) {
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    if (!state.feet[leg].in_contact) continue;
    contact_O_m_[leg] = state.feet[leg].p_O_m - Vector3(0.0, 0.0, foot_radius_m_);
  }
  const Plane plane = fit_plane(state);
  const double tau = config_.ground_filter_s;
  const double pitch = -math::atan(plane.slope_x * config_.slope_share);
  const double roll = math::atan(plane.slope_y * config_.slope_share);
  reference_.ground_z_m = approach(reference_.ground_z_m, plane.height_m, step_s, tau);
  reference_.pitch_rad =
      approach(reference_.pitch_rad, math::clamp(pitch, -kMaxTilt_rad, kMaxTilt_rad), step_s, tau);
  reference_.roll_rad =
      approach(reference_.roll_rad, math::clamp(roll, -kMaxTilt_rad, kMaxTilt_rad), step_s, tau);
}

void BodyReferenceTracker::update(const estimation::RobotState& state,
                                  const VelocityCommand& command, double step_s) {
  follow_ground(state, step_s);
  reference_.yaw_rate_rad_s = command.yaw_rate_rad_s;
  const double yaw_error =
      math::wrap_angle(reference_.yaw_rad + command.yaw_rate_rad_s * step_s - state.yaw_rad);
  reference_.yaw_rad = state.yaw_rad + math::clamp(yaw_error, -kMaxYawError_rad, kMaxYawError_rad);

  const math::SinCos yaw = math::sin_cos(state.yaw_rad);
  reference_.v_OB_m_s = Vector3(yaw.cos * command.forward_m_s - yaw.sin * command.left_m_s,
                                yaw.sin * command.forward_m_s + yaw.cos * command.left_m_s, 0.0);
  for (int axis = 0; axis < 2; ++axis) {
    const double ahead =
        reference_.p_OB_m[axis] + reference_.v_OB_m_s[axis] * step_s - state.p_OB_m[axis];
    reference_.p_OB_m[axis] =
        state.p_OB_m[axis] +
        math::clamp(ahead, -config_.max_reference_error_m, config_.max_reference_error_m);
  }
  reference_.p_OB_m[2] = reference_.ground_z_m + config_.height_m;
}

}  // namespace surefoot::control
