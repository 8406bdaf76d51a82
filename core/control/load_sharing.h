// How standing feet share a force: what the static walk asks of each of them.
//
// In: where the feet are, how much each may carry, the centre of mass, the force wanted.
// Out: for each foot a force along the wanted one, whose resultant passes through the centre of
// mass where the feet have room for it: the least squares of force^2 / share. Less than nothing is
// never asked of a foot; then the resultant misses the centre, on the side of the feet.
//
// Frames: O, metres, N. Cost: one 3 x 3 Cholesky factorisation. No state.
#pragma once

#include <array>

#include "core/planning/stance.h"

namespace surefoot::control {

// Of the load, 0 (in the air) to 1.
using LoadShares = std::array<double, robot::kLegs>;

// force_O_N: by the ground on the robot, upwards.
std::array<Vector3, robot::kLegs> share_load(const planning::Feet& feet_O_m,
                                             const LoadShares& shares, const Vector3& centre_O_m,
                                             const Vector3& force_O_N);

}  // namespace surefoot::control
