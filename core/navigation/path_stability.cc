#include "core/navigation/path_stability.h"

#include <algorithm>

#include "core/math/elementary.h"

namespace surefoot::navigation {

Projection project(const RawPath& path_O_m, const Vector2& p_O_m, const Projection* end) {
  Projection best;
  const auto consider = [&](std::size_t segment, double share, const Vector2& at_O_m) {
    const double far2 = (at_O_m - p_O_m).squaredNorm();
    if (best.any && far2 >= best.distance_m) return;
    best = {true, segment, share, at_O_m, far2};
  };
  if (path_O_m.size() == 1) consider(0, 0, path_O_m[0]);
  for (std::size_t i = 0; i + 1 < path_O_m.size(); ++i) {
    if (end != nullptr && i > end->segment) break;
    const Vector2 way = path_O_m[i + 1] - path_O_m[i];
    const double length2 = way.squaredNorm();
    if (!(length2 > 0)) continue;
    const double last = end != nullptr && i == end->segment ? end->share : 1.0;
    const double share = math::clamp((p_O_m - path_O_m[i]).dot(way) / length2, 0.0, last);
    consider(i, share, path_O_m[i] + way * share);
  }
  best.distance_m = math::sqrt(best.distance_m);
  return best;
}

void PathStability::reset(const ShapeConfig& config) {
  config_ = config;
  forget();
}

void PathStability::forget() {
  for (RawPath& path : history_O_m_) path.clear();
  over_smoothed_O_m_.clear();
  p_ = {};
}

Vector2 PathStability::start_O_m(const Vector2& robot_O_m) {
  p_ = project(last_path_O_m(), robot_O_m);
  if (p_.any && p_.distance_m > config_.keep_m) p_.any = false;
  return p_.any ? p_.p_O_m : robot_O_m;
}

void PathStability::mark(const CostMap& map, const RawPath& path_O_m) {
  const auto mark_around = [&](const Vector2& p_O_m) {
    const Cell at = map.cell_of(p_O_m);
    for (std::int32_t i = 0; i < 9; ++i) {
      const Cell cell{at.x + i % 3 - 1, at.y + i / 3 - 1};
      if (map.inside(cell)) marked_[map.index(cell)] = 1;
    }
  };
  if (!path_O_m.empty()) mark_around(path_O_m[0]);
  for (std::size_t i = 0; i + 1 < path_O_m.size(); ++i) {
    const Vector2 way_m = path_O_m[i + 1] - path_O_m[i];
    const double length_m = math::sqrt(way_m.squaredNorm());
    const std::int32_t steps = math::floor_of(std::max(1.0, 2.0 * length_m / map.cell_m()));
    for (std::int32_t step = 1; step <= steps; ++step) {
      mark_around(path_O_m[i] + way_m * (static_cast<double>(step) / steps));
    }
  }
}

void PathStability::discount(CostMap& map, const Vector2& robot_O_m) {
  const auto cells = static_cast<std::uint32_t>(map.side() * map.side());
  for (std::uint32_t i = 0; i < cells; ++i) marked_[i] = 0;
  for (const RawPath& path : history_O_m_) mark(map, path);
  mark(map, over_smoothed_O_m_);
  const auto far_share = static_cast<std::uint32_t>(256.0 * config_.discount);
  const auto near_share = static_cast<std::uint32_t>(256.0 * config_.near_discount);
  const Cell robot = map.cell_of(robot_O_m);
  const std::int32_t near = math::floor_of(config_.near_m / map.cell_m());
  for (std::uint32_t i = 0; i < cells; ++i) {
    if (marked_[i] == 0) continue;
    const Cell cell = map.cell(i);
    const std::int32_t dx = cell.x - robot.x;
    const std::int32_t dy = cell.y - robot.y;
    const bool heavy = dx * dx + dy * dy <= near * near && near_share > far_share;
    map.discount(i, heavy ? near_share : far_share);
  }
}

void PathStability::take(const RawPath& planned_O_m, const Vector2& robot_O_m,
                         const Vector2& past_O_m, RawPath& path_O_m) {
  path_O_m.clear();
  const auto add = [&path_O_m](const Vector2& p_O_m) {
    if (!path_O_m.empty() && (p_O_m - path_O_m.back()).squaredNorm() < 1e-8) return;
    static_cast<void>(path_O_m.push_back(p_O_m));
  };
  const RawPath& last_O_m = last_path_O_m();
  if (p_.any) {
    const Projection q = project(last_O_m, past_O_m, &p_);
    if (q.any) {
      add(q.p_O_m);
      for (std::size_t i = q.segment + 1; i <= p_.segment; ++i) add(last_O_m[i]);
      add(p_.p_O_m);
    }
  }
  if (!p_.any) add(robot_O_m);
  // The first cell holds the start: its centre would be a step aside.
  const std::size_t first = planned_O_m.size() > 1 ? 1 : 0;
  for (std::size_t i = first; i < planned_O_m.size(); ++i) add(planned_O_m[i]);
  newest_ = (newest_ + 1) % kHistory;
  history_O_m_[newest_].assign(path_O_m);
}

}  // namespace surefoot::navigation
