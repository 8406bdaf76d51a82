#include "core/navigation/grid_search.h"

namespace surefoot::navigation {
namespace {

constexpr std::size_t kDirections = 8;
constexpr std::array<std::int32_t, kDirections> kDx{1, 0, -1, 0, 1, -1, -1, 1};
constexpr std::array<std::int32_t, kDirections> kDy{0, 1, 0, -1, 1, 1, -1, -1};
constexpr std::uint8_t kClosed = 0x80;
constexpr std::uint8_t kNowhere = 0x0f;  // the start has no step into it

std::uint64_t key(std::uint32_t estimate, std::uint32_t cell) {
  return (static_cast<std::uint64_t>(estimate) << 32u) | cell;
}

}  // namespace

std::uint32_t octile(Cell a, Cell b) {
  const std::int32_t dx = a.x > b.x ? a.x - b.x : b.x - a.x;
  const std::int32_t dy = a.y > b.y ? a.y - b.y : b.y - a.y;
  const std::int32_t less = dx < dy ? dx : dy;
  return static_cast<std::uint32_t>(dx + dy) * kStraight -
         static_cast<std::uint32_t>(less) * (2 * kStraight - kAcross);
}

// Four children per node: half the levels of a binary heap, and its children lie in one cache line.
bool GridSearch::push(std::uint64_t key) {
  if (open_ == kMaxOpen) return false;
  std::size_t at = open_++;
  while (at > 0) {
    const std::size_t parent = (at - 1) / 4;
    if (heap_[parent] <= key) break;
    heap_[at] = heap_[parent];
    at = parent;
  }
  heap_[at] = key;
  return true;
}

std::uint64_t GridSearch::pop() {
  const std::uint64_t top = heap_[0];
  const std::uint64_t last = heap_[--open_];
  std::size_t at = 0;
  for (std::size_t first = 1; first < open_; first = 4 * at + 1) {
    std::size_t least = first;
    const std::size_t end = first + 4 < open_ ? first + 4 : open_;
    for (std::size_t child = first + 1; child < end; ++child) {
      if (heap_[child] < heap_[least]) least = child;
    }
    if (heap_[least] >= last) break;
    heap_[at] = heap_[least];
    at = least;
  }
  heap_[at] = last;
  return top;
}

void GridSearch::prepare(const CostMap& map, const Ends& ends) {
  const auto cells = static_cast<std::uint32_t>(map.side() * map.side());
  open_ = 0;
  towards_ = ends.towards;
  least_cost_ = kLethalCost;
  offset_ = 0;
  for (std::uint32_t i = 0; i < cells; ++i) {
    way_cost_[i] = kNoWay;
    end_cost_[i] = kNoWay;
    from_[i] = kNowhere;
    if (map.cost(i) < least_cost_) least_cost_ = map.cost(i);
  }
  std::uint32_t excess = kNoWay;
  for (const End& end : ends.list) {
    // Never below the heuristic: that is what keeps it admissible.
    const std::uint32_t bound = heuristic(map.cell(end.cell));
    const std::uint32_t cost = end.cost > bound ? end.cost : bound;
    end_cost_[end.cell] = cost;
    if (cost - bound < excess) excess = cost - bound;
  }
  offset_ = excess;
}

bool GridSearch::expand(const CostMap& map, std::uint32_t from, std::uint32_t way_cost) {
  const Cell at = map.cell(from);
  std::array<bool, 4> free{};
  for (std::size_t i = 0; i < kDirections; ++i) {
    const Cell to{at.x + kDx[i], at.y + kDy[i]};
    if (!map.inside(to)) continue;
    const std::uint32_t cell = map.index(to);
    const std::uint32_t cost = map.cost(cell);
    if (i < 4) free[i] = cost != kLethalCost;
    if (cost == kLethalCost || (from_[cell] & kClosed) != 0) continue;
    if (i >= 4 && !(free[i - 4] && free[(i - 3) % 4])) continue;
    const std::uint32_t there = way_cost + cost * (i < 4 ? kStraight : kAcross);
    if (there >= way_cost_[cell] || there > kMaxReachable - offset_) continue;
    way_cost_[cell] = there;
    from_[cell] = static_cast<std::uint8_t>(i);
    if (!push(key(there + heuristic(to), cell))) return false;
  }
  return true;
}

void GridSearch::trace(const CostMap& map, std::uint32_t start, std::uint32_t end,
                       RawPath& path_O_m, SearchResult& result) {
  back_.clear();
  result.end_cell = end;
  for (std::uint32_t cell = end;;) {
    static_cast<void>(back_.push_back(cell));  // each cell once at most
    if (cell == start) break;
    const std::size_t step = from_[cell] & 0x0fu;
    const Cell at = map.cell(cell);
    cell = map.index({at.x - kDx[step], at.y - kDy[step]});
  }
  path_O_m.clear();
  for (std::size_t i = back_.size(); i > 0; --i) {
    if (!ok(path_O_m.push_back(map.centre_of_O_m(map.cell(back_[i - 1]))))) {
      result.truncated = true;
      return;
    }
  }
}

SearchResult GridSearch::search(const CostMap& map, Cell start, const Ends& ends, RawPath& path_O_m,
                                std::uint32_t max_closed) {
  SearchResult result;
  path_O_m.clear();
  if (!map.inside(start) || ends.list.empty()) return result;
  prepare(map, ends);
  const std::uint32_t first = map.index(start);
  Best best;
  Best nearest{heuristic(start), first};
  way_cost_[first] = 0;
  static_cast<void>(push(key(nearest.total, first)));
  while (open_ > 0) {
    const std::uint64_t top = pop();
    const auto estimate = static_cast<std::uint32_t>(top >> 32u);
    const auto cell = static_cast<std::uint32_t>(top & 0xffffffffu);
    if (estimate >= best.total) break;
    if ((from_[cell] & kClosed) != 0) continue;
    from_[cell] = static_cast<std::uint8_t>(from_[cell] | kClosed);
    ++result.closed;
    const std::uint32_t way_cost = way_cost_[cell];
    const std::uint32_t left = estimate - way_cost;
    if (left < nearest.total) nearest = {left, cell};
    const std::uint32_t rest = end_cost_[cell];
    if (rest != kNoWay && rest < kMaxReachable && way_cost + rest < best.total) {
      best = {way_cost + rest, cell};
    }
    if (result.closed >= max_closed || !expand(map, cell, way_cost)) {
      result.partial = best.total == kNoWay;
      break;
    }
  }
  if (best.total == kNoWay && !result.partial) return result;
  result.found = best.total != kNoWay;
  result.cost = result.found ? best.total : way_cost_[nearest.cell];
  trace(map, first, result.found ? best.cell : nearest.cell, path_O_m, result);
  return result;
}

}  // namespace surefoot::navigation
