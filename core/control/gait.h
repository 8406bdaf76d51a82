// The gait's clock: which leg should stand and which should swing, by phase alone.
#pragma once

#include <array>

#include "core/control/config.h"
#include "core/robot/robot_model.h"

namespace surefoot::control {

struct LegPhase {
  bool stance = true;
  double progress = 0;     // 0..1 within the current stance or swing
  double remaining_s = 0;  // of the current stance or swing
};

class Gait {
 public:
  void reset(const GaitConfig& config);
  // Starts the cycle at the beginning of everyone's stance overlap. Cost: O(legs).
  void advance(double step_s);
  const std::array<LegPhase, robot::kLegs>& legs() const { return legs_; }

 private:
  void evaluate();

  GaitConfig config_;
  double phase_ = 0;  // [0, 1)
  std::array<LegPhase, robot::kLegs> legs_;
};

}  // namespace surefoot::control
