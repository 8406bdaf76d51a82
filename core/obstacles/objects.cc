#include "core/obstacles/objects.h"

#include "core/math/elementary.h"

namespace surefoot::obstacles {
namespace {

constexpr std::uint16_t kFree = 0;
constexpr std::uint16_t kBlocked = 0xFFFF;   // blocked, and in no set yet
constexpr std::uint16_t kTooSmall = 0xFFFE;  // in a set that is no object
constexpr std::int32_t kSide = mapping::kWindowSide;

// Sets are at least two cells apart, so labels never reach the marks above.
static_assert(kWindowCells / 4 + kSide < kTooSmall);

bool is_blocked(mapping::Traversability traversability, const BlockingRule& rule) {
  if (traversability == mapping::Traversability::kImpassable) return true;
  return rule.jump_only && traversability == mapping::Traversability::kJumpOnly;
}

const mapping::WindowCell& cell_at(const mapping::MapWindow& window, std::int32_t x,
                                   std::int32_t y) {
  return window.cells[static_cast<std::size_t>(y * kSide + x)];
}

// Lowest height of the window; highest of all where no cell has one.
float lowest_m(const mapping::MapWindow& window) {
  float lowest = 1e9F;
  for (const mapping::WindowCell& cell : window.cells) {
    if (cell.has_height() && cell.height_m < lowest) lowest = cell.height_m;
  }
  return lowest;
}

// Something within reach of the cell is lower by more than the rise.
bool rises(const mapping::MapWindow& window, std::int32_t x, std::int32_t y, float rise_m) {
  const float limit_m = cell_at(window, x, y).height_m - rise_m;
  const std::int32_t x0 = math::clamp(x - kRiseReach_cells, 0, kSide - 1);
  const std::int32_t x1 = math::clamp(x + kRiseReach_cells, 0, kSide - 1);
  const std::int32_t y0 = math::clamp(y - kRiseReach_cells, 0, kSide - 1);
  const std::int32_t y1 = math::clamp(y + kRiseReach_cells, 0, kSide - 1);
  for (std::int32_t ny = y0; ny <= y1; ++ny) {
    for (std::int32_t nx = x0; nx <= x1; ++nx) {
      const mapping::WindowCell& cell = cell_at(window, nx, ny);
      if (cell.has_height() && cell.height_m < limit_m) return true;
    }
  }
  return false;
}

}  // namespace

void ObjectFinder::reset() {
  labels_.fill(kFree);
  queue_.fill(0);
  objects_ = 0;
  too_small_ = 0;
}

void ObjectFinder::mark(const mapping::MapWindow& window, const BlockingRule& rule) {
  labels_.fill(kFree);
  if (!(window.cell_size_m > 0)) return;
  const auto rise_m = static_cast<float>(rule.min_rise_m);
  const float low_m = lowest_m(window) + rise_m;  // no cell below rises by so much
  for (std::int32_t y = 0; y < kSide; ++y) {
    for (std::int32_t x = 0; x < kSide; ++x) {
      const mapping::WindowCell& cell = cell_at(window, x, y);
      const bool high = cell.has_height() && cell.height_m > low_m;
      if (!is_blocked(cell.traversability, rule) && !(high && rises(window, x, y, rise_m)))
        continue;
      labels_[static_cast<std::size_t>(y * kSide + x)] = kBlocked;
    }
  }
}

void ObjectFinder::find(const mapping::MapWindow& window, const BlockingRule& rule,
                        std::size_t min_cells) {
  objects_ = 0;
  too_small_ = 0;
  mark(window, rule);
  for (std::size_t i = 0; i < kWindowCells; ++i) {
    if (labels_[i] != kBlocked) continue;
    const auto next = static_cast<std::uint16_t>(objects_ + 1);
    const std::size_t cells = flood(static_cast<std::uint16_t>(i), next);
    if (cells >= min_cells) {
      ++objects_;
      continue;
    }
    for (std::size_t k = 0; k < cells; ++k) labels_[queue_[k]] = kTooSmall;
    ++too_small_;
  }
  for (std::uint16_t& label : labels_) {
    if (label == kTooSmall) label = kFree;
  }
}

std::size_t ObjectFinder::flood(std::uint16_t seed, std::uint16_t label) {
  std::size_t end = 0;
  queue_[end++] = seed;
  labels_[seed] = label;
  for (std::size_t next = 0; next < end; ++next) {
    const std::int32_t x = queue_[next] % kSide;
    const std::int32_t y = queue_[next] / kSide;
    for (std::int32_t k = 0; k < 9; ++k) {
      const std::int32_t nx = x + k % 3 - 1;
      const std::int32_t ny = y + k / 3 - 1;
      if (nx < 0 || ny < 0 || nx >= kSide || ny >= kSide) continue;
      const auto cell = static_cast<std::uint16_t>(ny * kSide + nx);
      if (labels_[cell] != kBlocked) continue;
      labels_[cell] = label;
      queue_[end++] = cell;
    }
  }
  return end;
}

}  // namespace surefoot::obstacles
