// The way beyond the local map: what it costs to reach the goal from each coarse cell that is
// remembered, and whether the robot makes progress at all (paper 003, IV-A: the live-lock that
// the published system is not designed for).
//
// WayField: Dijkstra from the goal over the ground memory. A step costs 10 (14 across a corner)
// times 4 on seen ground, 4 unknown_factor on unknown ground, 4 more beside blocked ground. Seen
// ground is cheaper, so that the side of an obstacle on which the robot has looked is kept.
// Blocked ground is impassable; tight ground too, unless `lenient`: then it costs 32, for gaps that
// the coarse cells close but the cost map may not. A goal beyond the memory is moved to its border;
// the memory's outermost cells are impassable.
//
// ProgressWatch: the rest of the way must fall by progress_m within live_lock_s. It may rise while
// the robot learns: that starts the watch anew, but each cell can be learnt once only, so it ends.
//
// Bounds: 65,536 cells, each closed once. No errors.
#pragma once

#include <array>
#include <cstdint>

#include "core/navigation/ground_memory.h"

namespace surefoot::navigation {

class WayField {
 public:
  static constexpr std::uint32_t kUnreachable = 0xffffffffu;
  static constexpr std::uint32_t kSeenCost = 4;

  // false: the goal stands on blocked ground with no other near, nothing is reachable.
  bool spread(const GroundMemory& memory, const Vector2& goal_O_m, double unknown_factor,
              bool lenient);

  // In costs of the cost map (kStraight x kFreeCost per cell of it). kUnreachable: no way.
  std::uint32_t cost_at(const Vector2& p_O_m) const;

 private:
  static constexpr std::size_t kCells = static_cast<std::size_t>(kWaySide) * kWaySide;
  static constexpr std::size_t kBuckets = 1024;  // above the dearest step
  static constexpr std::uint32_t kNone = 0xffffffffu;

  bool seed(const Vector2& goal_O_m);
  void weigh(double unknown_factor, bool lenient);
  void expand(std::uint32_t cell);
  void put(std::uint32_t cell, std::uint32_t cost);
  void take_out(std::uint32_t cell);

  const GroundMemory* memory_ = nullptr;  // during spread() and until the memory changes
  std::size_t waiting_ = 0;
  Cell low_;
  double cell_m_ = 1;
  std::array<Ground, kCells> ground_{};
  std::array<std::uint16_t, kCells> weights_{};  // 0: impassable; in rows from the low corner
  std::array<std::uint32_t, kCells> costs_{};
  std::array<std::uint32_t, kCells> next_{};
  std::array<std::uint32_t, kCells> previous_{};
  std::array<std::uint32_t, kBuckets> first_{};
};

class ProgressWatch {
 public:
  void reset(const WayConfig& config);
  // With each plan. true: no progress for too long.
  bool stuck(double rest_m, std::uint64_t learnt, TimeNs stamp);

 private:
  static constexpr std::uint64_t kWorthwhile = 12;  // cells learnt

  WayConfig config_;
  bool started_ = false;
  double least_m_ = 0;
  std::uint64_t learnt_ = 0;
  TimeNs since_;
};

}  // namespace surefoot::navigation
