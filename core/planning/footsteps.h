// Where the next four feet go: a receding-horizon search over the filled terrain (paper 001,
// section IV: footsteps are planned for the nearby terrain only, anew as more is seen).
//
// In: where the feet stand, whose turn it is, the way that is asked for; terrain::TerrainMap.
// Out: at most four steps in the order of legs and what they cost; the first one is to be made.
//
// Beam search: every sequence in the beam is continued by the cells of a square round the next
// leg's nominal place, the best `beam` are kept; equal costs go by the order in which they were
// found. Costs and limits: README.md. A sequence that cannot be continued stays in the race with a
// penalty for each missing step.
//
// Frames: O, metres. Feet: centres of the foot spheres, legs FR FL HR HL (robot_model.h).
// Memory: sizeof(FootstepPlanner) 77 kB. Cost: at most (1 + 3 beam) (2 radius_cells + 1)^2
// candidates, most of which are dropped before the costly tests; figures in README.md. No heap.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/fixed_vector.h"
#include "core/base/status.h"
#include "core/math/linear.h"
#include "core/planning/footstep_cells.h"
#include "core/planning/footstep_config.h"
#include "core/planning/stance.h"
#include "core/planning/step_pose.h"
#include "core/robot/robot_model.h"
#include "core/terrain/terrain_map.h"

namespace surefoot::planning {

inline constexpr std::size_t kMaxAvoided = 4;

struct FootstepProblem {
  Feet feet_O_m{};
  std::size_t turn = 0;                         // index into kStepOrder
  Vector2 stride_O_m = Vector2::Zero();         // way of the trunk per four steps
  double yaw_rad = 0;                           // heading of the trunk
  double map_offset_m = 0;                      // added to every height of the map
  Vector2 centre_offset_O_m = Vector2::Zero();  // of the centre of mass from B's origin, from above
  // Where the first step found no ground before: it is not tried again.
  FixedVector<Vector2, kMaxAvoided> avoided_O_m;
};

struct Footstep {
  std::size_t leg = 0;
  Vector3 position_O_m = Vector3::Zero();
  Vector3 nominal_O_m = Vector3::Zero();  // z: where the foot stood
  mapping::CellIndex cell;
  double cost = 0;     // [m]
  double terrain = 0;  // cost of the terrain there, 0 to 1
};

struct FootstepPlan {
  FixedVector<Footstep, kMaxFootsteps> steps;
  double cost = 0;  // [m] of all steps, missing ones included
};

StepLimits step_limits(const FootstepConfig& config);

class FootstepPlanner {
 public:
  void reset(const FootstepConfig& config, const robot::RobotModel& model,
             const StanceShape& shape);

  // kUnavailable: the map was never published. kInvalid: a foot, stride, heading or offset is not
  // finite or absurdly large, or `turn` is no turn. kNotFound: no place for the first step.
  // Unless ok, `out` is empty.
  Status plan(const FootstepProblem& problem, const terrain::TerrainMap& map, FootstepPlan& out);

 private:
  struct Node {
    Feet feet_O_m{};
    double cost = 0;  // of the steps up to here
    std::size_t parent = 0;
    Footstep step;
  };

  // Nodes lie where they are; `ranking` has their places by cost.
  struct Beam {
    std::array<Node, kMaxFootstepBeam> nodes{};
    FixedVector<std::uint8_t, kMaxFootstepBeam> ranking;
  };

  struct Place {
    std::size_t depth = 0;
    std::size_t node = 0;
    double cost = 0;
    bool found = false;
  };

  struct Offset {
    std::int32_t dx = 0;
    std::int32_t dy = 0;
    double least_m = 0;  // distance from the nominal place, in cells, is no less
  };
  static constexpr std::size_t kSide = 2 * kMaxFootstepRadius_cells + 1;

  struct Expansion;

  void list_offsets();
  void search(const FootstepProblem& problem);
  bool expand(const FootstepProblem& problem, std::size_t depth, std::size_t parent);
  bool offer(const Expansion& expansion, const Offset& offset);
  bool rate(const Expansion& expansion, const Offset& offset, Footstep& step);
  bool add_balance(const Expansion& expansion, Footstep& step) const;
  bool reaches(const Expansion& expansion, Footstep& step);
  bool is_avoided(const FootstepProblem& problem, const Footstep& step) const;
  double deviation_cost_m(double distance_m) const;
  bool wanted(std::size_t depth, double cost) const;
  void keep(const Expansion& expansion, const Footstep& step);
  void finish(std::size_t depth, std::size_t node);
  void write(FootstepPlan& out) const;

  FootstepConfig config_;
  robot::RobotModel model_;
  StanceShape shape_;
  FootstepCells cells_;
  FixedVector<Offset, kSide * kSide> offsets_;   // by distance from the middle
  std::array<Beam, kMaxFootsteps + 1> beams_{};  // by steps made; the first holds the present
  Hips hips_O_m_{};
  double cell_size_m_ = 0;
  Place best_;
  int further_poses_ = 0;  // of this plan
};

}  // namespace surefoot::planning
