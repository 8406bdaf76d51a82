#include "core/objects/ground_or_wall.h"

#include <algorithm>

#include "core/math/elementary.h"

namespace surefoot::objects {
namespace {

constexpr double kRowGap_m = 0.5;
constexpr double kRowGapShare = 0.15;
constexpr int kRowBeams = 3;
constexpr double kSpreadPerMetre = 0.01;  // half a degree of attitude error
constexpr double kMapRadius_m = 0.25;
constexpr double kMapReach_m = 2.0;
constexpr std::size_t kWallShare = 3;    // one in so many makes the row a wall
constexpr std::uint32_t kMapCells = 10;  // known, for its lowest to be called ground

}  // namespace

void GroundOrWall::reset(const ObjectsConfig& config) {
  config_ = config;
  cells_.fill(Cell{});
  counters_ = GroundCounters{};
}

GroundOrWall::Cell& GroundOrWall::cell_at(const SurfacePoint& point, std::int32_t period) {
  const mapping::CellIndex at = mapping::cell_index(point.p_O_m[0], point.p_O_m[1], kCell_m);
  const auto column = static_cast<std::size_t>(at.ix & (kSide - 1));
  const auto row = static_cast<std::size_t>(at.iy & (kSide - 1));
  Cell& cell = cells_[row * kSide + column];
  const bool same = cell.ix == at.ix && cell.iy == at.iy;
  if (same && cell.period == period) return cell;
  const Heights here{point.z_O_m, point.z_O_m};
  cell.before = same && cell.period + 1 == period ? cell.now : here;
  cell.now = here;
  cell.ix = at.ix;
  cell.iy = at.iy;
  cell.period = period;
  return cell;
}

void GroundOrWall::record(const SurfacePoint& point, std::int32_t period) {
  Heights& now = cell_at(point, period).now;
  now.low_m = std::min(now.low_m, point.z_O_m);
  now.high_m = std::max(now.high_m, point.z_O_m);
}

std::size_t GroundOrWall::row_end(const SurfacePoints& points, std::size_t begin,
                                  bool& long_row) const {
  Vector2 low = points[begin].p_O_m;
  Vector2 high = low;
  std::size_t i = begin + 1;
  for (; i < points.size(); ++i) {
    const SurfacePoint& last = points[i - 1];
    const SurfacePoint& next = points[i];
    const double range_m = static_cast<double>(std::min(last.range_m, next.range_m));
    const double gap_m = std::max(kRowGap_m, kRowGapShare * range_m);
    if ((next.p_O_m - last.p_O_m).squaredNorm() >= math::square(gap_m)) break;
    if (next.beam - last.beam > kRowBeams) break;
    low = low.cwiseMin(next.p_O_m);
    high = high.cwiseMax(next.p_O_m);
  }
  long_row = (high - low).squaredNorm() > math::square(config_.row_length_m);
  return i;
}

GroundOrWall::Verdict GroundOrWall::decide(const SurfacePoint& point, const GroundPlane& ground,
                                           std::int32_t period, const mapping::MapWindow* map) {
  const Vector2 off = point.p_O_m - ground.feet_O_m.head<2>();
  const double away_m = math::sqrt(off.squaredNorm());
  const double z_m = static_cast<double>(point.z_O_m);
  const double rise_m = z_m - ground.feet_O_m[2];
  if (rise_m > config_.roughness_m + config_.max_slope * away_m) return Verdict::kHigh;
  const Cell& cell = cell_at(point, period);
  const double spread_m = static_cast<double>(std::max(cell.now.high_m, cell.before.high_m) -
                                              std::min(cell.now.low_m, cell.before.low_m));
  if (spread_m > config_.wall_spread_m + kSpreadPerMetre * away_m) return Verdict::kSpread;
  if (map != nullptr && away_m < kMapReach_m) {
    const auto patch = map->patch(point.p_O_m[0], point.p_O_m[1], kMapRadius_m);
    if (patch.ok() && patch.value().known >= kMapCells &&
        z_m - patch.value().min_m > config_.roughness_m + config_.max_slope * kMapRadius_m) {
      return Verdict::kMapped;
    }
  }
  const double over_plane_m = rise_m - ground.slope.dot(off);
  return over_plane_m <= config_.roughness_m + config_.feet_slope_error * away_m
             ? Verdict::kGround
             : Verdict::kUndecided;
}

// waits: for evidence.
ObjectClass GroundOrWall::conclude(Verdict verdict, bool waits, bool wall) {
  switch (verdict) {
    case Verdict::kHigh: ++counters_.high; return ObjectClass::kObstacle;
    case Verdict::kSpread: ++counters_.spread; return ObjectClass::kObstacle;
    case Verdict::kMapped: ++counters_.mapped; return ObjectClass::kObstacle;
    case Verdict::kGround: ++counters_.ground; return ObjectClass::kGround;
    case Verdict::kUndecided: break;
  }
  if (waits && !wall) {
    ++counters_.undecided;
    return ObjectClass::kGround;
  }
  ++(waits ? counters_.row : counters_.compact);
  return ObjectClass::kObstacle;
}

void GroundOrWall::part(const SurfacePoints& points, TimeNs stamp, const GroundPlane& ground,
                        const mapping::MapWindow* map, SurfacePoints& obstacles,
                        SurfacePoints& grounds) {
  obstacles.clear();
  grounds.clear();
  const auto period = static_cast<std::int32_t>(stamp.seconds() / config_.evidence_s);
  for (const SurfacePoint& point : points) record(point, period);
  std::size_t begin = 0;
  while (begin < points.size()) {
    bool long_row = false;
    const std::size_t end = row_end(points, begin, long_row);
    std::size_t sure = 0;
    for (std::size_t i = begin; i < end; ++i) {
      verdicts_[i] = decide(points[i], ground, period, map);
      sure += verdicts_[i] == Verdict::kHigh || verdicts_[i] == Verdict::kSpread ? 1 : 0;
    }
    const bool wall = kWallShare * sure >= end - begin;
    for (std::size_t i = begin; i < end; ++i) {
      const bool far = static_cast<double>(points[i].range_m) > config_.compact_range_m;
      const ObjectClass kind = conclude(verdicts_[i], long_row || far, wall);
      SurfacePoints& to = kind == ObjectClass::kGround ? grounds : obstacles;
      static_cast<void>(to.push_back(points[i]));  // as many as came in
    }
    begin = end;
  }
}

}  // namespace surefoot::objects
