// What one leg is about.
#pragma once

#include <array>
#include <cstdint>

#include "core/control/foothold.h"
#include "core/control/swing.h"
#include "core/control/whole_body.h"
#include "core/estimation/contact.h"
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

using LegStatuses = std::array<LegStatus, robot::kLegs>;

// Where a leg in the air should have its foot: on its path, or straight down from its anchor.
SwingPoint foot_target(const LegStatus& leg, const SwingConfig& config);
// The same for whole-body control; legs in stance with the forces they are to give.
LegTasks leg_tasks(const LegStatuses& legs, const SwingConfig& config);
// What the contact estimator needs to know of the plan.
std::array<estimation::GaitPhase, robot::kLegs> gait_phases(const LegStatuses& legs);

}  // namespace surefoot::control
