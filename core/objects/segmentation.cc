#include "core/objects/segmentation.h"

#include <algorithm>

#include "core/mapping/height_map.h"
#include "core/math/elementary.h"

namespace surefoot::objects {
namespace {

constexpr double kSquareShare = 0.707;  // of merge_m: the diagonal is just below it
constexpr std::int32_t kReach = 2;      // squares that can hold a neighbour

std::uint32_t mix(std::int32_t ix, std::int32_t iy, std::uint32_t group) {
  std::uint32_t h = static_cast<std::uint32_t>(ix) * 0x9e3779b1u;
  h ^= static_cast<std::uint32_t>(iy) * 0x85ebca6bu + (h >> 15u);
  h ^= group * 0xc2b2ae35u + (h >> 13u);
  return h ^ (h >> 16u);
}

}  // namespace

bool add_thinned(const Vector2& p_O_m, double thin_m,
                 FixedVector<Vector2, kMaxObjectPoints>& list) {
  for (const Vector2& known : list) {
    if ((known - p_O_m).squaredNorm() < math::square(thin_m)) return true;
  }
  return ok(list.push_back(p_O_m));
}

void Segmenter::reset(const ObjectsConfig& config) {
  config_ = config;
  counters_ = SegmentCounters{};
}

// Open addressing. At most kMaxSurfacePoints of kSlots are ever taken, so there is a free one.
Segmenter::Slot& Segmenter::slot(std::int32_t ix, std::int32_t iy, std::uint32_t group) {
  std::size_t i = mix(ix, iy, group) % kSlots;
  while (slots_[i].head != kNone &&
         (slots_[i].ix != ix || slots_[i].iy != iy || slots_[i].group != group)) {
    i = (i + 1) % kSlots;
  }
  return slots_[i];
}

std::uint16_t Segmenter::root(std::uint16_t point) {
  while (parent_[point] != point) {
    parent_[point] = parent_[parent_[point]];
    point = parent_[point];
  }
  return point;
}

// The smaller index becomes the root: the result does not depend on the order of links.
void Segmenter::unite(std::uint16_t a, std::uint16_t b) {
  a = root(a);
  b = root(b);
  parent_[std::max(a, b)] = std::min(a, b);
}

void Segmenter::link_squares(const SurfacePoints& points, std::uint16_t a, std::uint16_t b) {
  if (root(a) == root(b)) return;
  const double merge2 = math::square(config_.merge_m);
  for (std::uint16_t i = a; i != kNone; i = next_[i]) {
    for (std::uint16_t j = b; j != kNone; j = next_[j]) {
      if ((points[i].p_O_m - points[j].p_O_m).squaredNorm() >= merge2) continue;
      unite(i, j);
      return;  // each square is linked in itself
    }
  }
}

void Segmenter::link(const SurfacePoints& points) {
  slots_.fill(Slot{});
  const double square_m = kSquareShare * config_.merge_m;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto index = static_cast<std::uint16_t>(i);
    parent_[i] = index;
    const Vector2& p = points[i].p_O_m;
    const mapping::CellIndex at = mapping::cell_index(p[0], p[1], square_m);
    Slot& home = slot(at.ix, at.iy, 0);
    next_[i] = home.head;
    if (home.head != kNone) unite(index, home.head);
    home = {at.ix, at.iy, 0, index};
  }
  for (const Slot& from : slots_) {
    if (from.head == kNone) continue;
    for (std::int32_t dy = 0; dy <= kReach; ++dy) {
      for (std::int32_t dx = dy == 0 ? 1 : -kReach; dx <= kReach; ++dx) {
        const Slot& to = slot(from.ix + dx, from.iy + dy, 0);
        if (to.head != kNone) link_squares(points, from.head, to.head);
      }
    }
  }
}

// A group is a component, or a component's share of a square of the cutting grid.
void Segmenter::group(const SurfacePoints& points, const Vector2& robot_O_m) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint16_t r = root(static_cast<std::uint16_t>(i));
    component_[i] = r;
    const Vector2& p = points[i].p_O_m;
    low_[r] = r == i ? p : Vector2(low_[r].cwiseMin(p));
    high_[r] = r == i ? p : Vector2(high_[r].cwiseMax(p));
  }
  slots_.fill(Slot{});
  groups_.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t r = component_[i];
    const Vector2& p = points[i].p_O_m;
    const bool cut = (high_[r] - low_[r]).maxCoeff() > config_.piece_m;
    mapping::CellIndex at;
    if (cut) at = mapping::cell_index(p[0], p[1], config_.piece_m);
    Slot& found = slot(at.ix, at.iy, r);
    const double away2 = (p - robot_O_m).squaredNorm();
    if (found.head == kNone) {
      found = {at.ix, at.iy, r, static_cast<std::uint16_t>(groups_.size())};
      static_cast<void>(groups_.push_back({away2, 0, cut, kNone}));  // at most one for each point
    }
    Group& mine = groups_[found.head];
    mine.nearest2 = std::min(mine.nearest2, away2);
    ++mine.count;
    group_of_[i] = found.head;
  }
}

void Segmenter::choose(Pieces& out) {
  out.clear();
  std::size_t wanted = 0;
  for (const Group& group : groups_) {
    if (group.count >= config_.min_points) order_[wanted++] = group.nearest2;
  }
  double limit2 = 0;
  if (wanted > kMaxPieces) {
    const auto last = order_.begin() + static_cast<std::ptrdiff_t>(wanted);
    const auto middle = order_.begin() + static_cast<std::ptrdiff_t>(kMaxPieces - 1);
    // Heaps, not nth_element: a bound that does not depend on luck.
    std::make_heap(order_.begin(), last);
    std::sort_heap(order_.begin(), last);
    limit2 = *middle;
  }
  for (Group& group : groups_) {
    if (group.count < config_.min_points) {
      counters_.lone_points += group.count;
    } else if (out.full() || (wanted > kMaxPieces && group.nearest2 > limit2)) {
      ++counters_.dropped;
    } else {
      group.piece = static_cast<std::uint16_t>(out.size());
      static_cast<void>(out.resize(out.size() + 1));
      out.back().cut = group.cut;
      ++counters_.pieces;
    }
  }
}

void Segmenter::fill(const SurfacePoints& points, Pieces& out) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint16_t index = groups_[group_of_[i]].piece;
    if (index == kNone) continue;
    Piece& piece = out[index];
    const SurfacePoint& point = points[i];
    const bool first = piece.count == 0;
    piece.low_O_m = first ? point.p_O_m : Vector2(piece.low_O_m.cwiseMin(point.p_O_m));
    piece.high_O_m = first ? point.p_O_m : Vector2(piece.high_O_m.cwiseMax(point.p_O_m));
    piece.z_low_m = first ? point.z_O_m : std::min(piece.z_low_m, point.z_O_m);
    piece.z_high_m = first ? point.z_O_m : std::max(piece.z_high_m, point.z_O_m);
    piece.first_beam = std::min(piece.first_beam, point.beam);
    piece.last_beam = std::max(piece.last_beam, point.beam);
    piece.centre_O_m += point.p_O_m;
    ++piece.count;
    if (!add_thinned(point.p_O_m, config_.thin_m, piece.points_O_m)) ++counters_.points_full;
  }
  for (Piece& piece : out) piece.centre_O_m /= static_cast<double>(piece.count);
}

void Segmenter::segment(const SurfacePoints& points, const Vector2& robot_O_m, Pieces& out) {
  link(points);
  group(points, robot_O_m);
  choose(out);
  fill(points, out);
}

}  // namespace surefoot::objects
