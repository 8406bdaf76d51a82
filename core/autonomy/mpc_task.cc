#include "core/autonomy/mpc_task.h"

namespace surefoot::autonomy {

void MpcTask::reset(const control::MpcConfig& config) {
  horizon_step_ = TimeNs{static_cast<std::int64_t>(config.step_s * 1e9)};
  started_ = false;
  problem_ = control::MpcProblem{};
  mpc_.reset(config);
  plan_ = control::ForcePlan{};
}

void MpcTask::release(TimeNs stamp) {
  if (!started_) {
    started_ = true;
    shifted_to_ = stamp;
    problem_.steps_since_last = control::kMpcHorizon;  // nothing to go on from
  } else {
    const std::int64_t steps = (stamp - shifted_to_).ns / horizon_step_.ns;
    shifted_to_ = shifted_to_ + horizon_step_ * steps;
    problem_.steps_since_last = static_cast<std::uint32_t>(steps);
  }
  stamp_ = stamp;
}

void MpcTask::publish() {
  plan_.solution = mpc_.solution();
  plan_.stamp = stamp_;
  plan_.valid = true;
}

}  // namespace surefoot::autonomy
