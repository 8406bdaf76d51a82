#include "sim_hal/robot/pushes.h"

#include <cmath>

#include "core/base/random.h"

namespace surefoot::sim {
namespace {

constexpr std::uint64_t kPushStream = 5;

TimeNs from_seconds(double seconds) { return {std::llround(seconds * 1e9)}; }

}  // namespace

Pushes::Pushes(const PushConfig& config, std::uint64_t seed)
    : config_(config), duration_(from_seconds(config.duration_s)) {
  Random random(seed, kPushStream);
  for (std::size_t i = 0; i < config_.count && i < kCapacity; ++i) {
    const double delay_s = config.jitter_s * random.uniform();
    pushes_[i].side = random.below(2) == 0 ? -1.0 : 1.0;
    pushes_[i].begin =
        from_seconds(config.first_s + config.interval_s * static_cast<double>(i) + delay_s);
  }
}

Vector3 Pushes::force_W_N(TimeNs now, const Vector3& left_W) const {
  Vector3 force = Vector3::Zero();
  for (std::size_t i = 0; i < config_.count && i < kCapacity; ++i) {
    if (now < pushes_[i].begin || now >= pushes_[i].begin + duration_) continue;
    force += left_W * (pushes_[i].side * config_.impulse_N_s / config_.duration_s);
  }
  return force;
}

}  // namespace surefoot::sim
