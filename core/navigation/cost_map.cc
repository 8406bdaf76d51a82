#include "core/navigation/cost_map.h"

#include <algorithm>

#include "core/math/elementary.h"

namespace surefoot::navigation {
namespace {

constexpr double kStep_s = 0.5;     // between predictions of a walker
constexpr double kMeeting_s = 1.5;  // robot and walker meet when they are apart by less
constexpr double kAtOnce_s = 1.0;

// Eight costs at a time; every compiler for every CPU knows these vectors.
using Lanes [[gnu::vector_size(16)]] = std::uint16_t;
constexpr std::int32_t kLanes = 8;

Lanes load(const std::uint16_t* from) {
  Lanes lanes;
  __builtin_memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

}  // namespace

void CostMap::resize(std::int32_t side_cells, double cell_m) {
  SUREFOOT_ASSERT(side_cells > 0 && side_cells <= kMaxSide && cell_m > 0);
  side_ = side_cells;
  cell_m_ = cell_m;
}

void CostMap::reset(const NavigationConfig& config) {
  resize(static_cast<std::int32_t>(config.map.side_cells), config.map.cell_m);
  lethal_radius_m_ = config.half_width_m + config.map.clearance_m;
  edge_cost_ = config.map.edge_cost;
  fall_off_reach_m_ = std::max(config.map.fall_off_reach_m, lethal_radius_m_ + cell_m_);
  walker_horizon_s_ = config.map.walker_horizon_s;
  reach_ = std::min(kMaxReach, math::floor_of(fall_off_reach_m_ / cell_m_) + 1);
  const std::int32_t side = 2 * reach_ + 1;
  for (std::int32_t place = 0; place < kPlaces * kPlaces; ++place) {
    const std::int32_t place_row = place / kPlaces;
    const Vector2 p_m((place % kPlaces + 0.5) / kPlaces * cell_m_,
                      (place_row + 0.5) / kPlaces * cell_m_);
    for (std::int32_t i = 0; i < side * side; ++i) {
      const std::int32_t row = i / side;
      const Vector2 centre_m((i % side - reach_ + 0.5) * cell_m_, (row - reach_ + 0.5) * cell_m_);
      kernels_[static_cast<std::size_t>(place)][static_cast<std::size_t>(i)] =
          kernel_cost(math::sqrt((centre_m - p_m).squaredNorm()));
    }
  }
}

std::uint16_t CostMap::kernel_cost(double distance_m) const {
  if (distance_m <= lethal_radius_m_) return kLethalCost;
  if (distance_m > fall_off_reach_m_) return kFreeCost;
  const double ratio = lethal_radius_m_ / distance_m;
  const double cost = kFreeCost * (1.0 + edge_cost_ * ratio * ratio * ratio);
  return static_cast<std::uint16_t>(std::min(cost, static_cast<double>(kMaxCost)));
}

void CostMap::clear(const Vector2& centre_O_m) {
  origin_ = {math::floor_of(centre_O_m[0] / cell_m_) - side_ / 2,
             math::floor_of(centre_O_m[1] / cell_m_) - side_ / 2};
  const auto cells = static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
  for (std::size_t i = 0; i < cells; ++i) costs_[i] = kFreeCost;
  for (std::size_t i = 0; i < cells; ++i) stamped_[i] = 0;
}

Cell CostMap::cell_of(const Vector2& p_O_m) const {
  return {math::floor_of(p_O_m[0] / cell_m_) - origin_.x,
          math::floor_of(p_O_m[1] / cell_m_) - origin_.y};
}

Vector2 CostMap::centre_of_O_m(Cell cell) const {
  return {(cell.x + origin_.x + 0.5) * cell_m_, (cell.y + origin_.y + 0.5) * cell_m_};
}

CostMap::Place CostMap::place_of(const Vector2& p_O_m) const {
  const Vector2 in_cells = p_O_m / cell_m_;
  const Cell world{math::floor_of(in_cells[0]), math::floor_of(in_cells[1])};
  return {{world.x - origin_.x, world.y - origin_.y},
          math::floor_of((in_cells[1] - world.y) * kPlaces) * kPlaces +
              math::floor_of((in_cells[0] - world.x) * kPlaces)};
}

// The dearer of map and kernel for the cells in reach of a point; the kernel up to `most_cost`.
void CostMap::spread(const Vector2& p_O_m, std::uint16_t most_cost) {
  const auto [at, place] = place_of(p_O_m);
  if (at.x < -reach_ || at.y < -reach_ || at.x >= side_ + reach_ || at.y >= side_ + reach_) return;
  const Lanes all_most = Lanes{} + most_cost;
  const std::int32_t kernel_side = 2 * reach_ + 1;
  const std::uint16_t* kernel = kernels_[static_cast<std::size_t>(place)].data();
  const std::int32_t x0 = std::max(at.x - reach_, 0);
  const std::int32_t x1 = std::min(at.x + reach_, side_ - 1);
  const std::int32_t y1 = std::min(at.y + reach_, side_ - 1);
  for (std::int32_t y = std::max(at.y - reach_, 0); y <= y1; ++y) {
    const std::uint16_t* from = kernel + (y - at.y + reach_) * kernel_side + (x0 - at.x + reach_);
    std::uint16_t* to = costs_.data() + y * side_ + x0;
    const std::int32_t count = x1 - x0 + 1;
    std::int32_t i = 0;
    for (; i + kLanes <= count; i += kLanes) {
      const Lanes old = load(to + i);
      Lanes cost = load(from + i);
      cost = cost > all_most ? all_most : cost;
      cost = cost > old ? cost : old;
      __builtin_memcpy(to + i, &cost, sizeof cost);
    }
    for (; i < count; ++i) {
      const std::uint16_t cost = from[i] > most_cost ? most_cost : from[i];
      if (cost > to[i]) to[i] = cost;
    }
  }
}

void CostMap::stamp(const Vector2& p_O_m) {
  const auto [at, place] = place_of(p_O_m);
  if (inside(at)) {
    const auto bit = static_cast<std::uint16_t>(1u << static_cast<std::uint32_t>(place));
    std::uint16_t& stamped = stamped_[index(at)];
    if ((stamped & bit) != 0) return;
    stamped = static_cast<std::uint16_t>(stamped | bit);
  }
  spread(p_O_m, kLethalCost);
}

void CostMap::add_standing(const objects::Objects& objects) {
  for (const objects::Object& object : objects) {
    if (object.kind == objects::ObjectClass::kGround || object.moving) continue;
    for (const Vector2& p_O_m : object.points_O_m) stamp(p_O_m);
  }
}

void CostMap::add_walkers(const objects::Objects& objects, const Vector2& robot_O_m,
                          double cruise_m_s) {
  for (const objects::Object& object : objects) {
    if (object.kind == objects::ObjectClass::kGround || !object.moving) continue;
    for (double t_s = 0; t_s <= walker_horizon_s_; t_s += kStep_s) {
      const Vector2 moved_O_m = object.velocity_O_m_s * t_s;
      const double way_m = math::sqrt((object.centre_O_m + moved_O_m - robot_O_m).squaredNorm());
      const double arrival_s = way_m / cruise_m_s;
      if (math::magnitude(arrival_s - t_s) > kMeeting_s) continue;
      const bool at_once = t_s == 0 && arrival_s < kAtOnce_s;
      for (const Vector2& p_O_m : object.points_O_m)
        spread(p_O_m + moved_O_m, at_once ? kLethalCost : kMaxCost);
    }
  }
}

bool CostMap::passable(const Vector2& from_O_m, const Vector2& to_O_m) const {
  const Vector2 way_m = to_O_m - from_O_m;
  const double length_m = math::sqrt(way_m.squaredNorm());
  const std::int32_t steps = math::floor_of(2.0 * length_m / cell_m_) + 1;
  for (std::int32_t i = 0; i <= steps; ++i) {
    if (lethal_at(from_O_m + way_m * (static_cast<double>(i) / steps))) return false;
  }
  return true;
}

void CostMap::discount(std::uint32_t index, std::uint32_t share) {
  const std::uint16_t cost = costs_[index];
  if (cost == kLethalCost) return;
  const std::uint32_t less = cost * (256u - share) / 256u;
  costs_[index] = static_cast<std::uint16_t>(less < kMinCost ? kMinCost : less);
}

}  // namespace surefoot::navigation
