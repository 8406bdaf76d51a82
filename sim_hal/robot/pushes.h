// The blows of a scenario: when, which way, how hard.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/time.h"
#include "core/math/linear.h"
#include "sim_hal/scenario.h"

namespace surefoot::sim {

class Pushes {
 public:
  static constexpr std::size_t kCapacity = 32;

  Pushes(const PushConfig& config, std::uint64_t seed);

  // Force on the trunk's origin at `now`, axes of W; `left_W`: the trunk's left, level.
  Vector3 force_W_N(TimeNs now, const Vector3& left_W) const;

 private:
  struct Push {
    TimeNs begin;
    double side = 1;  // +1: towards the trunk's left
  };

  PushConfig config_;
  TimeNs duration_;
  std::array<Push, kCapacity> pushes_;
};

}  // namespace surefoot::sim
