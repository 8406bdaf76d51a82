#include "core/control/gait.h"

namespace surefoot::control {

void Gait::reset(const GaitConfig& config) {
  config_ = config;
  next_ = config;
  phase_ = 0;
  evaluate();
}

void Gait::advance(double step_s) {
  phase_ += step_s / config_.period_s;
  if (phase_ >= 1.0) {
    phase_ -= 1.0;
    config_ = next_;
  }
  evaluate();
}

void Gait::evaluate() {
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) legs_[leg] = leg_at(leg, 0.0);
}

LegPhase Gait::leg_at(std::size_t leg, double ahead_s) const {
  const double turns = phase_ + config_.offset[leg] + ahead_s / config_.period_s;
  const double phase = turns - static_cast<double>(static_cast<std::int64_t>(turns));
  LegPhase state;
  state.stance = phase < config_.stance_share;
  const double start = state.stance ? 0.0 : config_.stance_share;
  const double share = state.stance ? config_.stance_share : 1.0 - config_.stance_share;
  state.progress = (phase - start) / share;
  state.remaining_s = (start + share - phase) * config_.period_s;
  return state;
}

}  // namespace surefoot::control
