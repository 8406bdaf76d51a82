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
  // Starts the cycle at the beginning of everyone's stance overlap. Cost: O(legs).
  void reset(const GaitConfig& config);
  // Goes over to another gait where the cycle ends.
  void change_to(const GaitConfig& config) { next_ = config; }
  void advance(double step_s);
  // The leg's phase a while from now, if the gait stays.
  LegPhase leg_at(std::size_t leg, double ahead_s) const;
  const GaitConfig& config() const { return config_; }
  const std::array<LegPhase, robot::kLegs>& legs() const { return legs_; }

 private:
  void evaluate();

  GaitConfig config_;
  GaitConfig next_;
  double phase_ = 0;  // [0, 1)
  std::array<LegPhase, robot::kLegs> legs_;
};

}  // namespace surefoot::control
