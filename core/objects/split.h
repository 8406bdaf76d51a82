// A person who passes close to a post, a wall or another person melts into one piece with it. Each
// point of such a piece therefore goes to what is known to be here, whichever is nearest: a moving
// object (a disc of 0.25 m around its predicted position), a small standing one (its known points),
// or the long ones together. What is farther than 0.3 m from all of them is something new, unless
// a long one is about: walls come into sight by more than that. Only standing objects that were
// tracked for 1 s count, so that a ghost born inside a person does not keep itself alive.
#pragma once

#include <cstddef>

#include "core/objects/memory.h"
#include "core/objects/segmentation.h"

namespace surefoot::objects {

// How long an object that is not seen is thought to go on.
inline constexpr TimeNs kCoast = milliseconds(1000);

// From where the track's filter left it to where it is expected now; zero for what stands.
Vector2 drift(const Object& object, const Track& track, TimeNs now);

bool boxes_within(const Vector2& low_a, const Vector2& high_a, const Vector2& low_b,
                  const Vector2& high_b, double gap_m);

// Squared distance to the nearest of the points; 1e18 without points.
double nearest2(const Vector2& p_O_m, const FixedVector<Vector2, kMaxObjectPoints>& points);

// Splits in place; returns how many pieces were added. When there is no room for more, points are
// left in the piece. Pieces x objects boxes, and for each piece at most 64 x 64 distances to each
// of twelve objects.
std::size_t split_pieces(Pieces& pieces, TimeNs now, const ObjectMemory& memory);

}  // namespace surefoot::objects
