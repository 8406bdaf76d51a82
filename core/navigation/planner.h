// One plan: map, memory, ends, search, shaping (paper 003, III-B).
//
//  1. The cost map is made from the objects that stand; the ground memory takes from it what it
//     shows and gives back what the objects' memory has forgotten; walkers are added.
//  2. A* goes from where PathStability says to the goal if that lies in the map. If the goal lies
//     beyond, or cannot be reached within the map, to the border cell from where the coarse
//     field promises the cheapest rest of the way.
//  3. The path behind the robot is put before it, the whole is smoothed.
//
// A start on lethal ground is moved to the nearest free cell; the path leads there first. Found
// enclosed `no_path_plans` times in a row is `enclosed`, final until a plan finds a way. If what is
// remembered reaches back more than five minutes, everything far is forgotten first, once per goal,
// and must be found out anew.
// Frame: O, m. Bounds: those of the parts; three floods, two fields, one search per plan at most.
#pragma once

#include "core/navigation/config.h"
#include "core/navigation/cost_map.h"
#include "core/navigation/goal_projection.h"
#include "core/navigation/grid_search.h"
#include "core/navigation/ground_memory.h"
#include "core/navigation/path_smoothing.h"
#include "core/navigation/path_stability.h"
#include "core/navigation/reach.h"
#include "core/navigation/types.h"
#include "core/navigation/wayfinding.h"
#include "core/objects/object.h"

namespace surefoot::navigation {

// What a plan is made from, copied at its release.
struct PlanInput {
  Vector2 goal_O_m = Vector2::Zero();
  std::uint32_t goal_number = 0;
  RobotPose robot;
  Vector2 past_O_m = Vector2::Zero();  // where the robot was behind_s ago
  TimeNs stamp;
  objects::Objects objects;
};

enum class PlanOutcome : std::uint8_t {
  kPath = 0,
  kPartial,        // a bound of the search was met: the path leads nearer
  kRobotEnclosed,  // nothing leads out of where the robot is
  kGoalEnclosed,   // nothing leads to where the goal is
};

struct Plan {
  PlanOutcome outcome = PlanOutcome::kPath;
  bool to_goal = false;      // the path ends at the goal, or as near as ground allows
  bool enclosed = false;     // confirmed
  bool live_lock = false;    // no progress for too long
  double rest_m = 0;         // of the way, in metres of free ground
  std::uint32_t closed = 0;  // cells
  SmoothingResult smoothing;
  std::uint32_t goal_number = 0;
  TimeNs stamp;
  Path path;  // empty: none
};

class Planner {
 public:
  void reset(const NavigationConfig& config);
  // A new goal.
  void forget();
  void run(const PlanInput& input, Plan& plan);

  const CostMap& map() const { return map_; }
  const GroundMemory& memory() const { return memory_; }
  const RawPath& raw_O_m() const { return raw_O_m_; }

 private:
  void make_map(const PlanInput& input);
  Cell choose_start(const PlanInput& input);
  Cell way_out(const PlanInput& input, Cell from);
  SearchResult search(const PlanInput& input, Cell start, Plan& plan);
  bool find_ends_beyond(const PlanInput& input, bool lenient);
  bool goal_leads_out(const PlanInput& input);
  void shape(const PlanInput& input, const SearchResult& result, Plan& plan);
  void judge(const PlanInput& input, const SearchResult& result, Plan& plan);
  double metres(std::uint32_t cost) const;

  NavigationConfig config_;
  CostMap map_;
  GroundMemory memory_;
  WayField field_;
  GridSearch search_;
  PathStability stability_;
  PathSmoothing smoothing_;
  ProgressWatch watch_;
  Reach reach_;
  Ends ends_;
  RawPath searched_O_m_;
  RawPath raw_O_m_;
  RawPath over_smoothed_O_m_;
  std::uint32_t enclosed_plans_ = 0;
  bool forgot_ = false;  // for this goal
  bool started_ = false;
  TimeNs known_since_;
};

}  // namespace surefoot::navigation
