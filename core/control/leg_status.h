// What one leg is about.
#pragma once

#include <cstdint>

#include "core/control/foothold.h"
#include "core/control/swing.h"
#include "core/math/linear.h"

namespace surefoot::control {

enum class LegMode : std::uint8_t {
  kStance = 0,  // carries load
  kSwing,       // follows a path to its foothold
  kSearch,      // should stand but feels no ground: moves straight down until it does
};

struct LegStatus {
  LegMode mode = LegMode::kStance;
  double swing_progress = 0;
  double swing_s = 0;  // duration of the swing under way
  SwingPath path;
  Foothold foothold;
  double height_above_landing_m = 0;     // of the foot, while it swings
  double searched_m = 0;                 // depth below the expected landing
  Vector3 anchor_O_m = Vector3::Zero();  // where a search began
  Vector3 force_O_N = Vector3::Zero();   // commanded, ground on foot
  bool skipped_swing = false;            // no foothold: stays in stance during this planned swing
  bool landed_early = false;             // touched down before the planned end of this swing
};

}  // namespace surefoot::control
