#include "core/navigation/wayfinding.h"

#include "core/math/elementary.h"
#include "core/navigation/grid_search.h"

namespace surefoot::navigation {
namespace {

constexpr std::uint16_t kBesideBlocked = 4;
constexpr std::uint16_t kTightCost = 32;
constexpr std::int32_t kSeedReach = 3;  // cells from the goal
constexpr std::uint32_t kUnit = kFinePerWay * kFreeCost * kStraight / (kStraight * 4);
// Neighbours: right, up, left, down, then the corners between them.
constexpr std::array<std::int32_t, 8> kTo{
    1, kWaySide, -1, -kWaySide, kWaySide + 1, kWaySide - 1, -kWaySide - 1, -kWaySide + 1};

bool in_square(std::int32_t x, std::int32_t y) {
  return x >= 0 && y >= 0 && x < kWaySide && y < kWaySide;
}

std::uint32_t at(std::int32_t x, std::int32_t y) {
  return static_cast<std::uint32_t>(y * kWaySide + x);
}

}  // namespace

void WayField::weigh(double unknown_factor, bool lenient) {
  const auto unknown = static_cast<std::uint16_t>(math::floor_of(kSeenCost * unknown_factor + 0.5));
  for (std::int32_t y = 0; y < kWaySide; ++y) {
    for (std::int32_t x = 0; x < kWaySide; ++x) {
      ground_[at(x, y)] = memory_->ground({low_.x + x, low_.y + y});
    }
  }
  const auto blocks = [this](std::int32_t x, std::int32_t y) {
    return in_square(x, y) && ground_[at(x, y)] >= Ground::kTight;
  };
  for (std::int32_t y = 0; y < kWaySide; ++y) {
    for (std::int32_t x = 0; x < kWaySide; ++x) {
      const Ground ground = ground_[at(x, y)];
      std::uint16_t weight = ground == Ground::kUnknown ? unknown : kSeenCost;
      if (ground == Ground::kBlocked) weight = 0;
      if (ground == Ground::kTight) weight = lenient ? kTightCost : 0;
      const bool beside =
          blocks(x - 1, y) || blocks(x + 1, y) || blocks(x, y - 1) || blocks(x, y + 1);
      if (weight != 0 && beside) weight = static_cast<std::uint16_t>(weight + kBesideBlocked);
      if (!in_square(x - 1, y - 1) || !in_square(x + 1, y + 1)) weight = 0;
      weights_[at(x, y)] = weight;
    }
  }
}

void WayField::take_out(std::uint32_t cell) {
  const std::uint32_t before = previous_[cell];
  const std::uint32_t after = next_[cell];
  if (before == kNone) {
    first_[costs_[cell] % kBuckets] = after;
  } else {
    next_[before] = after;
  }
  if (after != kNone) previous_[after] = before;
  --waiting_;
}

void WayField::put(std::uint32_t cell, std::uint32_t cost) {
  if (costs_[cell] != kUnreachable) take_out(cell);
  costs_[cell] = cost;
  std::uint32_t& first = first_[cost % kBuckets];
  next_[cell] = first;
  previous_[cell] = kNone;
  if (first != kNone) previous_[first] = cell;
  first = cell;
  ++waiting_;
}

bool WayField::seed(const Vector2& goal_O_m) {
  const Cell goal = memory_->cell_of(goal_O_m);
  const std::int32_t gx = math::clamp(goal.x - low_.x, 1, kWaySide - 2);
  const std::int32_t gy = math::clamp(goal.y - low_.y, 1, kWaySide - 2);
  std::int32_t best = -1;
  std::uint32_t seed = kNone;
  for (std::int32_t y = gy - kSeedReach; y <= gy + kSeedReach; ++y) {
    for (std::int32_t x = gx - kSeedReach; x <= gx + kSeedReach; ++x) {
      if (!in_square(x, y) || weights_[at(x, y)] == 0) continue;
      const std::int32_t far = (x - gx) * (x - gx) + (y - gy) * (y - gy);
      if (best >= 0 && far >= best) continue;
      best = far;
      seed = at(x, y);
    }
  }
  if (best < 0) return false;
  const auto beyond = static_cast<std::uint32_t>(
      octile(goal, {low_.x + static_cast<std::int32_t>(seed % kWaySide),
                    low_.y + static_cast<std::int32_t>(seed / kWaySide)}));
  put(seed, beyond * kSeenCost);
  return true;
}

// The square's outermost cells are impassable: what is expanded has all its neighbours.
void WayField::expand(std::uint32_t cell) {
  const std::uint32_t so_far = costs_[cell];
  std::array<bool, 4> free{};
  // The way is walked from `to` into `cell`.
  const std::uint32_t straight = so_far + weights_[cell] * kStraight;
  const std::uint32_t across = so_far + weights_[cell] * kAcross;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::uint32_t to = cell + static_cast<std::uint32_t>(kTo[i]);
    free[i] = weights_[to] != 0;
    if (free[i] && straight < costs_[to]) put(to, straight);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const std::uint32_t to = cell + static_cast<std::uint32_t>(kTo[i + 4]);
    if (across >= costs_[to] || weights_[to] == 0) continue;
    if (free[i] && free[(i + 1) % 4]) put(to, across);
  }
}

bool WayField::spread(const GroundMemory& memory, const Vector2& goal_O_m, double unknown_factor,
                      bool lenient) {
  memory_ = &memory;
  low_ = memory.low();
  cell_m_ = memory.cell_m();
  waiting_ = 0;
  costs_.fill(kUnreachable);
  first_.fill(kNone);
  weigh(unknown_factor, lenient);
  if (!seed(goal_O_m)) return false;
  // Buckets in turn, each emptied before the next: a step always leads to a later one.
  std::uint32_t bucket = 0;
  while (waiting_ > 0) {
    const std::uint32_t cell = first_[bucket % kBuckets];
    if (cell == kNone) {
      ++bucket;
      continue;
    }
    take_out(cell);
    expand(cell);
  }
  return true;
}

std::uint32_t WayField::cost_at(const Vector2& p_O_m) const {
  const std::int32_t x = math::floor_of(p_O_m[0] / cell_m_) - low_.x;
  const std::int32_t y = math::floor_of(p_O_m[1] / cell_m_) - low_.y;
  if (!in_square(x, y)) return kUnreachable;
  const std::uint32_t cost = costs_[at(x, y)];
  return cost >= kMaxReachable / kUnit ? kUnreachable : cost * kUnit;
}

void ProgressWatch::reset(const WayConfig& config) {
  config_ = config;
  started_ = false;
}

bool ProgressWatch::stuck(double rest_m, std::uint64_t learnt, TimeNs stamp) {
  const bool nearer = rest_m <= least_m_ - config_.progress_m;
  const bool learns = rest_m > least_m_ && learnt >= learnt_ + kWorthwhile;
  if (!started_ || nearer || learns) {
    started_ = true;
    least_m_ = rest_m;
    learnt_ = learnt;
    since_ = stamp;
    return false;
  }
  return (stamp - since_).seconds() > config_.live_lock_s;
}

}  // namespace surefoot::navigation
