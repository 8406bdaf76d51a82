// Why a foothold is where it is.
#pragma once

#include <cstdint>

namespace surefoot::control {

enum class FootholdReason : std::uint8_t {
  kNominal = 0,  // the Raibert point can bear a foot
  kMoved,        // moved to the nearest cell that can
  kNone,         // none within reach: the leg stays in stance, the body slows down
  kUnseen,       // the Raibert point on ground that nobody saw, which is allowed
  kMapOff,       // mapping disabled: the Raibert point, unchecked
  kForced,       // bad ground, but a leg that stayed down would be dragged out of reach
  kPlanned,      // the first of the steps planned on the filled terrain
};

}  // namespace surefoot::control
