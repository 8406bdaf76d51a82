// The cheapest way over a cost map: A* to any of several ends, each with a cost of its own (paper
// 003, III-B). A goal inside the map is the one end, at no cost; a goal beyond it makes every free
// cell of the border an end that costs what the rest of the way does (goal_projection.h).
//
// A step to one of 8 neighbours costs 10 (14 across a corner) times the cost of the cell it enters.
// A step across a corner needs both cells beside it free: the robot is not a point. The heuristic,
// kMinCost-like times the octile distance to `towards`, is admissible and consistent as long as
// each end costs at least that. Whole numbers only; of equal cells the one of the lower index goes
// first. Cost found = Dijkstra's cost, always. What the ends cost more than that, the cheapest of
// them, is added to the heuristic everywhere, which leaves it consistent.
//
// Bounds: each cell is closed once; the open list holds kMaxOpen entries. When it is full, or
// max_closed cells are closed, the search ends `partial` with the path to the closed cell that the
// heuristic rates best. Memory: 4 MB. Worst figures: README.md.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/fixed_vector.h"
#include "core/navigation/cost_map.h"

namespace surefoot::navigation {

inline constexpr std::uint32_t kNoWay = 0xffffffffu;
inline constexpr std::uint32_t kMaxReachable = 0xf0000000u;  // costs above: no way
inline constexpr std::uint32_t kStraight = 10;
inline constexpr std::uint32_t kAcross = 14;
inline constexpr std::size_t kMaxEnds = 4 * kMaxSide;

struct End {
  std::uint32_t cell = 0;
  std::uint32_t cost = 0;  // from the cell on
};

struct Ends {
  FixedVector<End, kMaxEnds> list;  // no cell twice
  Cell towards;                     // for the heuristic; may lie outside the map
};

struct SearchResult {
  bool found = false;
  bool partial = false;    // a bound was met: the path ends somewhere else
  bool truncated = false;  // the path was longer than RawPath; its first part is kept
  std::uint32_t cost = 0;  // of path and end together
  std::uint32_t end_cell = 0;
  std::uint32_t closed = 0;  // cells
};

// 10 per cell, 14 across.
std::uint32_t octile(Cell a, Cell b);

class GridSearch {
 public:
  static constexpr std::size_t kMaxOpen = std::size_t{1} << 18u;

  // The path's points are the cells' centres from the start on. The start may be lethal: its own
  // cost is not part of the way.
  SearchResult search(const CostMap& map, Cell start, const Ends& ends, RawPath& path_O_m,
                      std::uint32_t max_closed = kMaxCells);

 private:
  struct Best {
    std::uint32_t total = kNoWay;
    std::uint32_t cell = 0;
  };

  void prepare(const CostMap& map, const Ends& ends);
  bool push(std::uint64_t key);
  std::uint64_t pop();
  bool expand(const CostMap& map, std::uint32_t from, std::uint32_t steps_cost);
  std::uint32_t heuristic(Cell cell) const {
    return least_cost_ * octile(cell, towards_) + offset_;
  }
  void trace(const CostMap& map, std::uint32_t start, std::uint32_t end, RawPath& path_O_m,
             SearchResult& result);

  std::uint32_t least_cost_ = 0;  // of any cell of the map
  std::uint32_t offset_ = 0;
  Cell towards_;
  std::array<std::uint32_t, kMaxCells> way_cost_{};
  std::array<std::uint32_t, kMaxCells> end_cost_{};
  std::array<std::uint8_t, kMaxCells> from_{};  // direction of the step into the cell; kClosed bit
  std::size_t open_ = 0;
  std::array<std::uint64_t, kMaxOpen> heap_{};  // estimate << 32 | cell
  FixedVector<std::uint32_t, kMaxCells> back_;
};

}  // namespace surefoot::navigation
