#include "core/obstacles/field_pool.h"

#include "core/math/elementary.h"

namespace surefoot::obstacles {
namespace {

enum class Support : std::uint8_t { kFree = 0, kObject, kUnseen };

// What the window shows within radius_m of a field's centre.
Support support(const mapping::MapWindow& window, const ObjectFinder& finder, const Vector2& p_O_m,
                double radius_m) {
  const double cell_m = window.cell_size_m;
  const mapping::CellIndex low =
      mapping::cell_index(p_O_m[0] - radius_m, p_O_m[1] - radius_m, cell_m);
  const mapping::CellIndex high =
      mapping::cell_index(p_O_m[0] + radius_m, p_O_m[1] + radius_m, cell_m);
  if (!window.contains(low) || !window.contains(high)) return Support::kUnseen;
  int unseen = 0;
  for (std::int32_t iy = low.iy; iy <= high.iy; ++iy) {
    for (std::int32_t ix = low.ix; ix <= high.ix; ++ix) {
      const Vector2 centre(mapping::cell_centre(ix, cell_m), mapping::cell_centre(iy, cell_m));
      if ((centre - p_O_m).squaredNorm() > math::square(radius_m)) continue;
      const auto column = static_cast<std::size_t>(ix - window.first.ix);
      const auto row = static_cast<std::size_t>(iy - window.first.iy);
      const std::size_t cell = row * mapping::kWindowSide + column;
      if (finder.label(cell) != 0) return Support::kObject;
      unseen += window.cells[cell].state == mapping::CellState::kUnknown ? 1 : -1;
    }
  }
  return unseen > 0 ? Support::kUnseen : Support::kFree;
}

}  // namespace

void FieldPool::reset(const ObstacleConfig& config) {
  config_ = config;
  finder_.reset();
  fields_.clear();
  counters_ = FieldCounters{};
}

void FieldPool::update(const mapping::MapWindow& window, const BlockingRule& rule,
                       const Vector2& robot_O_m) {
  if (!(window.cell_size_m > 0)) return;
  finder_.find(window, rule, config_.min_cells);
  forget(window);
  cover(window, robot_O_m);
}

void FieldPool::forget_around(const Vector2& centre_O_m, double half_side_m) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const Vector2 off = (fields_[i].centre_O_m - centre_O_m).cwiseAbs();
    if (off[0] <= half_side_m && off[1] <= half_side_m) {
      ++counters_.forgotten;
      continue;
    }
    fields_[kept++] = fields_[i];
  }
  static_cast<void>(fields_.resize(kept));  // never more
}

// Line of sight did its work in the map before: cells that were seen through have a ceiling in
// place of their height, cells whose ground was seen have the ground's. Fields that reach out of
// the window are kept, and those on ground that was never seen.
void FieldPool::forget(const mapping::MapWindow& window) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    Field field = fields_[i];
    const Support found = support(window, finder_, field.centre_O_m, config_.field_radius_m);
    if (found == Support::kObject) field.free_windows = 0;
    if (found == Support::kFree) ++field.free_windows;
    if (field.free_windows >= config_.forget_windows) {
      ++counters_.forgotten;
      continue;
    }
    fields_[kept++] = field;
  }
  static_cast<void>(fields_.resize(kept));  // never more
}

void FieldPool::cover(const mapping::MapWindow& window, const Vector2& robot_O_m) {
  for (std::size_t i = 0; i < kWindowCells; ++i) {
    if (finder_.label(i) == 0) continue;
    const auto x = static_cast<std::int32_t>(i) % mapping::kWindowSide;
    const auto y = static_cast<std::int32_t>(i) / mapping::kWindowSide;
    const Vector2 centre(mapping::cell_centre(window.first.ix + x, window.cell_size_m),
                         mapping::cell_centre(window.first.iy + y, window.cell_size_m));
    if (!is_near_field(centre)) make(centre, robot_O_m);
  }
}

bool FieldPool::is_near_field(const Vector2& p_O_m) const {
  const double apart2 = math::square(2.0 * config_.field_radius_m);
  for (const Field& field : fields_) {
    if ((field.centre_O_m - p_O_m).squaredNorm() < apart2) return true;
  }
  return false;
}

void FieldPool::make(const Vector2& centre_O_m, const Vector2& robot_O_m) {
  const Field field{centre_O_m, 0};
  if (ok(fields_.push_back(field))) {
    ++counters_.made;
    return;
  }
  std::size_t farthest = 0;
  double farthest2 = (centre_O_m - robot_O_m).squaredNorm();
  bool found = false;
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const double away2 = (fields_[i].centre_O_m - robot_O_m).squaredNorm();
    if (away2 <= farthest2) continue;
    farthest = i;
    farthest2 = away2;
    found = true;
  }
  if (!found) {
    ++counters_.refused;
    return;
  }
  fields_[farthest] = field;
  ++counters_.made;
  ++counters_.replaced;
}

}  // namespace surefoot::obstacles
