// Costs of the ground around the robot, made anew from the objects for every plan (paper 003,
// III-B.2, algorithm 1).
//
//   lethal              within the lethal radius of an object's point: half the robot's width and
//                       the clearance. The robot walks along its path, so its width counts.
//   kFreeCost (1 + e (r / d)^3)   beyond, d: distance to the nearest point, r: lethal radius,
//                       e: edge_cost; cut off at fall_off_reach_m
// Points are placed within their cell to a quarter of its side. All costs are whole numbers.
//
// Frame: O. Cells lie on multiples of cell_m from O's origin, whatever the robot does, so that a
// cell means the same ground in every plan. Cells outside the map are lethal.
// Cost: one kernel per distinct place of a point, at most 16 places per cell. No errors.
#pragma once

#include <array>
#include <cstdint>

#include "core/math/linear.h"
#include "core/navigation/config.h"
#include "core/navigation/types.h"
#include "core/objects/object.h"

namespace surefoot::navigation {

inline constexpr std::int32_t kMaxSide = 400;
inline constexpr std::size_t kMaxCells = static_cast<std::size_t>(kMaxSide) * kMaxSide;
inline constexpr std::uint16_t kLethalCost = 0xffff;
inline constexpr std::uint16_t kFreeCost = 100;
inline constexpr std::uint16_t kMaxCost = 2500;  // of a cell that may be walked
inline constexpr std::uint16_t kMinCost = 40;    // after all discounts

struct Cell {
  std::int32_t x = 0;
  std::int32_t y = 0;
  bool operator==(const Cell&) const = default;
};

class CostMap {
 public:
  // Sizes only, for searches on maps that are filled cell by cell.
  void resize(std::int32_t side_cells, double cell_m);
  void reset(const NavigationConfig& config);

  // Everything free, around the cell of this point.
  void clear(const Vector2& centre_O_m);
  // Objects that stand.
  void add_standing(const objects::Objects& objects);
  // Objects that move: dear where they will be when a robot that walks at cruise_m_s gets there;
  // lethal where they are if it gets there within a second.
  void add_walkers(const objects::Objects& objects, const Vector2& robot_O_m, double cruise_m_s);

  std::int32_t side() const { return side_; }
  double cell_m() const { return cell_m_; }
  double lethal_radius_m() const { return lethal_radius_m_; }
  // In cells from O's origin: of the map's cell (0, 0).
  Cell origin() const { return origin_; }
  Cell cell_of(const Vector2& p_O_m) const;  // may lie outside
  Vector2 centre_of_O_m(Cell cell) const;
  bool inside(Cell cell) const {
    return cell.x >= 0 && cell.y >= 0 && cell.x < side_ && cell.y < side_;
  }
  std::uint32_t index(Cell cell) const {
    return static_cast<std::uint32_t>(cell.y * side_ + cell.x);
  }
  Cell cell(std::uint32_t index) const {
    const auto i = static_cast<std::int32_t>(index);
    return {i % side_, i / side_};
  }
  std::uint16_t cost(std::uint32_t index) const { return costs_[index]; }
  std::uint16_t cost(Cell cell) const { return inside(cell) ? costs_[index(cell)] : kLethalCost; }
  bool lethal(Cell cell) const { return cost(cell) == kLethalCost; }
  bool lethal_at(const Vector2& p_O_m) const { return lethal(cell_of(p_O_m)); }
  // No lethal cell under the segment, sampled every half cell.
  bool passable(const Vector2& from_O_m, const Vector2& to_O_m) const;
  // The free cell nearest to a cell, by distance, then by index; false: there is none within
  // `rings` cells along an axis.
  bool nearest_free(Cell from, std::int32_t rings, Cell& found) const {
    return nearest(
        from, rings, [](Cell) { return true; }, found);
  }
  // The same of those that suit; asked only for cells that would be the nearest.
  template <class Suits>
  bool nearest(Cell from, std::int32_t rings, Suits&& suits, Cell& found) const;

  void set_cost(Cell cell, std::uint16_t cost) { costs_[index(cell)] = cost; }
  // Takes the share of 256ths off a cell that may be walked.
  void discount(std::uint32_t index, std::uint32_t share);

 private:
  static constexpr std::int32_t kMaxReach = 30;  // cells
  static constexpr std::int32_t kPlaces = 4;     // per side of a cell
  static constexpr std::int32_t kKernelSide = 2 * kMaxReach + 1;

  struct Place {
    Cell at;                // may lie outside
    std::int32_t part = 0;  // of the cell: which of its kPlaces x kPlaces
  };

  Place place_of(const Vector2& p_O_m) const;
  void stamp(const Vector2& p_O_m);
  void spread(const Vector2& p_O_m, std::uint16_t most_cost);
  std::uint16_t kernel_cost(double distance_m) const;

  std::int32_t side_ = 0;
  double cell_m_ = 0;
  double lethal_radius_m_ = 0;
  double edge_cost_ = 0;
  double fall_off_reach_m_ = 0;
  double walker_horizon_s_ = 0;
  std::int32_t reach_ = 0;  // cells
  Cell origin_;
  std::array<std::array<std::uint16_t, kKernelSide * kKernelSide>, kPlaces * kPlaces> kernels_{};
  std::array<std::uint16_t, kMaxCells> costs_{};
  std::array<std::uint16_t, kMaxCells> stamped_{};  // one bit per place
};

// Rings of growing size; a ring's nearest cell is as far as its number, so rings up to the best
// distance found have to be seen.
template <class Suits>
bool CostMap::nearest(Cell from, std::int32_t rings, Suits&& suits, Cell& found) const {
  std::int64_t best = -1;
  const auto look = [&](Cell at) {
    if (lethal(at)) return;
    const std::int64_t dx = at.x - from.x;
    const std::int64_t dy = at.y - from.y;
    const std::int64_t far = dx * dx + dy * dy;
    if (best >= 0 && (far > best || (far == best && index(at) >= index(found)))) return;
    if (!suits(at)) return;
    best = far;
    found = at;
  };
  for (std::int32_t ring = 0; ring <= rings; ++ring) {
    if (best >= 0 && static_cast<std::int64_t>(ring) * ring > best) break;
    for (std::int32_t i = -ring; i <= ring; ++i) {
      look({from.x + i, from.y - ring});
      look({from.x + i, from.y + ring});
      look({from.x - ring, from.y + i});
      look({from.x + ring, from.y + i});
    }
  }
  return best >= 0;
}

}  // namespace surefoot::navigation
