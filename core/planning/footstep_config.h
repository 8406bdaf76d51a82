// Limits and weights of the search for footsteps. All costs are metres of detour: one that has no
// unit is paid per metre of what it weighs. Equations: README.md.
#pragma once

#include <cstdint>

#include "core/base/parameters.h"

namespace surefoot::planning {

inline constexpr std::int32_t kMaxFootstepRadius_cells = 6;
inline constexpr std::size_t kMaxFootsteps = 4;
inline constexpr std::size_t kMaxFootstepBeam = 32;

struct FootstepConfig {
  std::int32_t steps = 0;         // looked ahead
  std::int32_t radius_cells = 0;  // half the side of the square of candidates
  std::int32_t beam = 0;          // sequences kept at every step
  // What a step must not break.
  double max_cost = 0;         // of the terrain, 0 to 1
  double max_step_m = 0;       // rise or drop of a foot from where it stands
  double reach_margin_m = 0;   // left to either end of every leg's reach
  double stop_margin_rad = 0;  // left to every joint's stops
  double avoid_m = 0;          // around a place where a foot found no ground
  double max_lowering_m = 0;   // of the trunk, for legs that do not reach
  double max_raising_m = 0;    // of the trunk, so that nothing touches the ground
  double min_inradius_m = 0;   // of the triangle of feet that stand during the next step
  // What it costs.
  double terrain_weight_m = 0;   // terrain cost 1
  double spread_weight = 0;      // of the filled height
  double edge_reach_m = 0;       // so far around the foot's middle edges count
  double wall_weight = 0;        // what stands up there over the height under the foot
  double drop_weight = 0;        // what falls off there below it
  double collision_weight = 0;   // of trunk or legs in the ground
  double deviation_scale_m = 0;  // this far off the nominal place costs as much; quadratic
  double rise_weight = 0;        // rise or drop
  double wanted_inradius_m = 0;  // of that triangle
  double inradius_weight = 0;    // what is lacking
  double shift_weight = 0;       // way of the centre of mass between two steps
  double missing_step_m = 0;     // a step that no place was found for

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.integer("steps", self.steps, {1, kMaxFootsteps}, "looked ahead");
    visit.integer("radius_cells", self.radius_cells, {0, kMaxFootstepRadius_cells},
                  "half the side of the square of candidates");
    visit.integer("beam", self.beam, {1, kMaxFootstepBeam}, "sequences kept at every step");
    visit.real("max_cost", self.max_cost, {0.0, 1.0}, "terrain cost that may be stepped on");
    visit.real("max_step_m", self.max_step_m, {0.0, 0.5}, "rise or drop of a foot");
    visit.real("reach_margin_m", self.reach_margin_m, {0.0, 0.1}, "to either end of a leg's reach");
    visit.real("stop_margin_rad", self.stop_margin_rad, {0.0, 0.5}, "to every joint's stops");
    visit.real("avoid_m", self.avoid_m, {0.0, 0.2}, "around a place that bore no foot");
    visit.real("max_lowering_m", self.max_lowering_m, {0.0, 0.2}, "of the trunk, to reach");
    visit.real("max_raising_m", self.max_raising_m, {0.0, 0.2}, "of the trunk, to touch nothing");
    visit.real("min_inradius_m", self.min_inradius_m, {0.001, 0.5}, "of the next step's triangle");
    visit.real("terrain_weight_m", self.terrain_weight_m, {0.0, 10.0}, "detour for terrain cost 1");
    visit.real("spread_weight", self.spread_weight, {0.0, 100.0}, "per metre of spread");
    visit.real("edge_reach_m", self.edge_reach_m, {0.0, 0.1}, "so far around a foot edges count");
    visit.real("wall_weight", self.wall_weight, {0.0, 100.0}, "per metre that stands up there");
    visit.real("drop_weight", self.drop_weight, {0.0, 100.0}, "per metre that falls off there");
    visit.real("collision_weight", self.collision_weight, {0.0, 100.0},
               "per metre that trunk or legs would be in the ground");
    visit.real("deviation_scale_m", self.deviation_scale_m, {0.001, 1.0},
               "so far off the nominal place costs as much; quadratic");
    visit.real("rise_weight", self.rise_weight, {0.0, 100.0}, "per metre of rise or drop");
    visit.real("wanted_inradius_m", self.wanted_inradius_m, {0.0, 0.5}, "of that triangle");
    visit.real("inradius_weight", self.inradius_weight, {0.0, 100.0}, "per metre that is lacking");
    visit.real("shift_weight", self.shift_weight, {0.0, 100.0}, "per metre of the centre's way");
    visit.real("missing_step_m", self.missing_step_m, {0.0, 10.0}, "of a step without a place");
  }
};

}  // namespace surefoot::planning
