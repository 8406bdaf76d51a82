// Where a search over the local map may end (paper 003, III-B: the goal is projected onto the
// boundary of the cost map).
//
// A goal inside is the one end, moved to the nearest free cell where its own is lethal. For a goal
// outside, the projection is left to the search: each free cell of the border is an end, whose cost
// is that of the rest of the way. So the boundary cell is chosen by what the whole way costs, and
// none is chosen that cannot be reached. No errors: without an end the list is empty.
#pragma once

#include "core/navigation/cost_map.h"
#include "core/navigation/grid_search.h"
#include "core/navigation/reach.h"
#include "core/navigation/wayfinding.h"

namespace surefoot::navigation {

// The goal's cell, or the nearest free one within moved_m of it.
void goal_ends(const CostMap& map, const Vector2& goal_O_m, double moved_m, Ends& ends);

// The border's cells, of these that can be reached (null: all); the rest of the way as the crow
// flies (a null field) or along the field.
void border_ends(const CostMap& map, const Vector2& goal_O_m, const WayField* field,
                 const Reach* reach, Ends& ends);

}  // namespace surefoot::navigation
