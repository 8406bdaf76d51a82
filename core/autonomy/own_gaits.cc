#include "core/autonomy/own_gaits.h"

#include "core/math/linear.h"

namespace surefoot::autonomy {

void OwnGaits::reset(bool enabled, double silence_s) {
  enabled_ = enabled;
  silence_s_ = silence_s;
  silent_s_ = 0;
  sample_ = hal::GaitSample{};
}

void OwnGaits::update(const hal::GaitSample* newest, bool fresh, double step_s) {
  if (!enabled_) return;
  silent_s_ = fresh ? 0.0 : silent_s_ + step_s;
  if (newest != nullptr) sample_ = *newest;
}

bool OwnGaits::at_rest() const {
  constexpr double kAtRest_m_s = 0.05;
  const Vector2 v(sample_.velocity_B_m_s[0], sample_.velocity_B_m_s[1]);
  return v.squaredNorm() < kAtRest_m_s * kAtRest_m_s;
}

hal::GaitCommand OwnGaits::command(control::GaitKind gait,
                                   const control::VelocityCommand& velocity) const {
  if (gait == control::GaitKind::kStand) return {};
  return {true, velocity.forward_m_s, velocity.left_m_s, velocity.yaw_rate_rad_s};
}

}  // namespace surefoot::autonomy
