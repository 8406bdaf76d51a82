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
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    double phase = phase_ + config_.offset[leg];
    if (phase >= 1.0) phase -= 1.0;
    LegPhase& state = legs_[leg];
    state.stance = phase < config_.stance_share;
    const double start = state.stance ? 0.0 : config_.stance_share;
    const double share = state.stance ? config_.stance_share : 1.0 - config_.stance_share;
    state.progress = (phase - start) / share;
    state.remaining_s = (start + share - phase) * config_.period_s;
  }
}

}  // namespace surefoot::control
