// What keeps a plan where the plan before it was (paper 003, III-B.3 and the end of III-B.4).
//
//  1. A* starts at p, the projection of the robot onto the last path that A* gave; at the robot
//     itself if it is farther off than keep_m.
//  2. The section of the last path from q to p goes before the new path. q: projection of where the
//     robot was behind_s ago.
//  3. Cells near the last kHistory paths are discounted, more so near the robot.
//  4. Cells near the last path's grossly over-smoothed version are discounted too.
//
// A cell is discounted once per plan, by the largest share that applies. Frame: O, m. Bounds:
// kHistory + 1 polylines of at most kMaxRawPoints points, followed in steps of half a cell.
// Errors: none; what does not fit a path is left out at its far end.
#pragma once

#include <array>
#include <cstdint>

#include "core/navigation/config.h"
#include "core/navigation/cost_map.h"
#include "core/navigation/types.h"

namespace surefoot::navigation {

// A place on a polyline.
struct Projection {
  bool any = false;
  std::size_t segment = 0;  // from point `segment` to the next
  double share = 0;         // of the segment
  Vector2 p_O_m = Vector2::Zero();
  double distance_m = 0;
};

// The nearest place, the first of equals; up to `end` if given.
Projection project(const RawPath& path_O_m, const Vector2& p_O_m, const Projection* end = nullptr);

class PathStability {
 public:
  static constexpr std::size_t kHistory = 3;

  void reset(const ShapeConfig& config);
  // A new goal: what was planned before says nothing.
  void forget();

  // Rule 1.
  Vector2 start_O_m(const Vector2& robot_O_m);
  // After start_O_m(): whether p lies on the last path.
  bool on_path() const { return p_.any; }
  // The robot's own place after all: the path is blocked there.
  void leave_path() { p_.any = false; }
  // Rules 3 and 4.
  void discount(CostMap& map, const Vector2& robot_O_m);
  // Rule 2, and remembers the result as the last path.
  void take(const RawPath& planned_O_m, const Vector2& robot_O_m, const Vector2& past_O_m,
            RawPath& path_O_m);
  void take_over_smoothed(const RawPath& path_O_m) { over_smoothed_O_m_.assign(path_O_m); }

  const RawPath& last_path_O_m() const { return history_O_m_[newest_]; }

 private:
  void mark(const CostMap& map, const RawPath& path_O_m);

  ShapeConfig config_;
  std::size_t newest_ = 0;
  std::array<RawPath, kHistory> history_O_m_;
  RawPath over_smoothed_O_m_;
  Projection p_;
  std::array<std::uint8_t, kMaxCells> marked_{};
};

}  // namespace surefoot::navigation
