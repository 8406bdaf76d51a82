#include "core/navigation/ground_memory.h"

#include "core/math/elementary.h"

namespace surefoot::navigation {

void GroundMemory::reset(const NavigationConfig& config) {
  cell_m_ = config.map.cell_m * kFinePerWay;
  way_ = config.way;
  started_ = false;
  learnt_ = 0;
  cells_.fill(0);
}

Cell GroundMemory::cell_of(const Vector2& p_O_m) const {
  return {math::floor_of(p_O_m[0] / cell_m_), math::floor_of(p_O_m[1] / cell_m_)};
}

// Cells that come into the square are unknown.
void GroundMemory::centre_on(const Vector2& robot_O_m) {
  const Cell middle = cell_of(robot_O_m);
  const Cell low{middle.x - kWaySide / 2, middle.y - kWaySide / 2};
  if (low == low_ && started_) return;
  const Cell before = low_;
  low_ = low;
  if (started_) {
    const auto was_inside = [&before](Cell cell) {
      return cell.x >= before.x && cell.y >= before.y && cell.x < before.x + kWaySide &&
             cell.y < before.y + kWaySide;
    };
    for (std::int32_t y = low.y; y < low.y + kWaySide; ++y) {
      for (std::int32_t x = low.x; x < low.x + kWaySide; ++x) {
        if (!was_inside({x, y})) cells_[index({x, y})] = 0;
      }
    }
  }
  started_ = true;
}

void GroundMemory::forget_far(const Vector2& robot_O_m) {
  const Cell robot = cell_of(robot_O_m);
  const double trust_cells = way_.trust_range_m / cell_m_;
  for (std::int32_t y = low_.y; y < low_.y + kWaySide; ++y) {
    for (std::int32_t x = low_.x; x < low_.x + kWaySide; ++x) {
      const double far2 = math::square(x - robot.x) + math::square(y - robot.y);
      if (far2 > trust_cells * trust_cells) cells_[index({x, y})] = 0;
    }
  }
}

Ground GroundMemory::ground(Cell cell) const {
  const std::uint8_t known = cells_[index(cell)];
  const std::uint8_t lethal = known & kLethalBits;
  if (lethal == kLethalBits) return Ground::kBlocked;
  // Without the lowest bit, is there another? std::popcount would call into the run-time library.
  if ((lethal & (lethal - 1)) != 0) return Ground::kTight;
  return known == 0 ? Ground::kUnknown : Ground::kFree;
}

void GroundMemory::see(std::uint8_t& known) {
  if (known == 0) ++learnt_;
  known |= kSeen;
}

void GroundMemory::block(std::uint8_t& known, std::uint8_t lethal) {
  if (lethal != 0 && (known & kOnceBlocked) == 0) ++learnt_;
  known |= lethal;
  if (lethal != 0) known |= kOnceBlocked | kSeen;
}

// Both ways: from the map what blocks, into the map what is remembered.
void GroundMemory::take(CostMap& map) {
  const Cell origin = map.origin();
  const auto up = [](std::int32_t fine) {
    return math::floor_of((fine + kFinePerWay - 1.0) / kFinePerWay);
  };
  const Cell first{up(origin.x), up(origin.y)};
  const std::int32_t last_x =
      math::floor_of(static_cast<double>(origin.x + map.side()) / kFinePerWay);
  const std::int32_t last_y =
      math::floor_of(static_cast<double>(origin.y + map.side()) / kFinePerWay);
  for (std::int32_t y = first.y; y < last_y; ++y) {
    for (std::int32_t x = first.x; x < last_x; ++x) {
      const Cell corner{x * kFinePerWay - origin.x, y * kFinePerWay - origin.y};
      std::uint8_t& known = cells_[index({x, y})];
      std::uint8_t lethal = 0;
      for (std::int32_t i = 0; i < kFinePerWay * kFinePerWay; ++i) {
        const Cell fine{corner.x + i % kFinePerWay, corner.y + i / kFinePerWay};
        const auto bit = static_cast<std::uint8_t>(1u << static_cast<std::uint32_t>(i));
        if (map.lethal(fine)) lethal |= bit;
        if ((known & bit) != 0) map.set_cost(fine, kLethalCost);
      }
      block(known, lethal);
    }
  }
}

// Where the robot sees through, nearer than trust range, nothing blocks any more but what the map
// holds; that is taken again afterwards.
void GroundMemory::look(const CostMap& map, const RobotPose& robot) {
  const double step_m = 0.5 * cell_m_;
  const std::int32_t steps = math::floor_of(way_.sight_range_m / step_m);
  const std::int32_t trusted = math::floor_of(way_.trust_range_m / step_m);
  const std::int32_t own = math::floor_of(map.lethal_radius_m() / step_m) + 1;
  for (std::int32_t ray = 0; ray < kRays; ++ray) {
    const double off_rad = way_.sight_half_angle_rad * (2.0 * ray / (kRays - 1) - 1.0);
    const math::SinCos to = math::sin_cos(robot.yaw_rad + off_rad);
    for (std::int32_t i = 0; i < steps; ++i) {
      const Vector2 p_O_m = robot.p_O_m + Vector2(to.cos, to.sin) * (step_m * i);
      const Cell cell = cell_of(p_O_m);
      const Cell fine = map.cell_of(p_O_m);
      // The robot itself may stand on lethal ground.
      if (!inside(cell) || (i > own && map.inside(fine) && map.lethal(fine))) break;
      std::uint8_t& known = cells_[index(cell)];
      if (i <= trusted) known = static_cast<std::uint8_t>(known & ~kLethalBits);
      if ((known & kLethalBits) == kLethalBits) break;
      see(known);
    }
  }
}

void GroundMemory::update(CostMap& map, const RobotPose& robot) {
  centre_on(robot.p_O_m);
  look(map, robot);
  take(map);
}

}  // namespace surefoot::navigation
