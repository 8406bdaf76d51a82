// What is known of the ground beyond the local map and beyond what the objects' memory keeps: a
// rolling square of coarse cells around the robot, each unknown, seen free, or blocked. Against the
// paper's live-lock (003, IV-A): the far end of a long wall is not forgotten while the robot looks
// for the near one.
//
// A coarse cell covers kFinePerWay^2 cells of the cost map and knows which of them are lethal:
// tight where half of them are, blocked where all are. Ground is blocked by what the map shows, and
// freed only where the robot looks through it from nearer than trust_range_m; what is remembered as
// lethal is put into the cost map. So what the objects' memory has dropped while it was far stays
// blocked when the robot comes back, and what is gone is free once it is seen to be.
//
// Frame: O, cells on multiples of their side. Bounds: 256 x 256 cells; kRays rays. No errors.
#pragma once

#include <array>
#include <cstdint>

#include "core/navigation/cost_map.h"

namespace surefoot::navigation {

inline constexpr std::int32_t kWaySide = 256;
inline constexpr std::int32_t kFinePerWay = 2;

enum class Ground : std::uint8_t { kUnknown = 0, kFree, kTight, kBlocked };

class GroundMemory {
 public:
  void reset(const NavigationConfig& config);
  // Everything beyond trust range becomes unknown: it may have changed.
  void forget_far(const Vector2& robot_O_m);

  // `map` holds what stands, nothing else; takes blocked ground from here.
  void update(CostMap& map, const RobotPose& robot);

  double cell_m() const { return cell_m_; }
  // Coarse cells counted from O's origin.
  Cell cell_of(const Vector2& p_O_m) const;
  Cell low() const { return low_; }  // corner of the square
  bool inside(Cell cell) const {
    return cell.x >= low_.x && cell.y >= low_.y && cell.x < low_.x + kWaySide &&
           cell.y < low_.y + kWaySide;
  }
  Ground ground(Cell cell) const;
  // Cells learnt: unknown before, or not yet known to be blocked at any time. Never falls.
  std::uint64_t learnt() const { return learnt_; }

  // Position in arrays: the square is stored rolled.
  static std::size_t index(Cell cell) {
    const auto x = static_cast<std::uint32_t>(cell.x) & (kWaySide - 1u);
    const auto y = static_cast<std::uint32_t>(cell.y) & (kWaySide - 1u);
    return y * kWaySide + x;
  }

 private:
  static constexpr std::int32_t kRays = 256;
  // Bits of a cell; the low ones are its lethal fine cells.
  static constexpr std::uint8_t kLethalBits = (1u << (kFinePerWay * kFinePerWay)) - 1u;
  static constexpr std::uint8_t kSeen = 0x40;
  static constexpr std::uint8_t kOnceBlocked = 0x80;

  void centre_on(const Vector2& robot_O_m);
  void take(CostMap& map);
  void look(const CostMap& map, const RobotPose& robot);
  void see(std::uint8_t& known);
  void block(std::uint8_t& known, std::uint8_t lethal);

  double cell_m_ = 0;
  WayConfig way_;
  bool started_ = false;
  Cell low_;
  std::uint64_t learnt_ = 0;
  std::array<std::uint8_t, static_cast<std::size_t>(kWaySide) * kWaySide> cells_{};
};

}  // namespace surefoot::navigation
