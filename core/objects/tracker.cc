#include "core/objects/tracker.h"

#include <algorithm>

#include "core/math/elementary.h"
#include "core/objects/split.h"

namespace surefoot::objects {
namespace {

constexpr double kCompact_m = 1.2;
constexpr double kFaceToCentre = math::kPi / 4;  // radii
constexpr double kMaxRadius_m = 0.25;
constexpr double kMovingPartial = 10.0;  // times the standard deviation
constexpr double kStandingPartial = 4.0;
constexpr double kHeadingNoise_rad = 0.01;
constexpr double kFirstSpeed_m_s = 1.0;  // standard deviation
constexpr double kAfterGapSpeed_m_s = 0.3;
constexpr double kSignificance = 3.0;
constexpr double kLeftPlace_m = 0.15;
constexpr double kLeftPartial_m = 0.4;  // more than hiding half a trunk does
constexpr double kMostStep_s = 0.25;    // between two sightings that count as tracking
constexpr double kNew_s = 0.5;          // tracked for less:
constexpr double kNewCost_m = 0.1;      // gives way to what is proven
constexpr TimeNs kAnchorAge = milliseconds(1000);
constexpr TimeNs kStandsAfter = milliseconds(500);
constexpr double kFar_m = 1e9;
constexpr std::size_t kShapePoints = 16;  // of a shape compared with another

using Points = FixedVector<Vector2, kMaxObjectPoints>;

bool is_compact(const Piece& piece) { return !piece.cut && piece.extent_m() < kCompact_m; }

// Of a small thing: across the line of sight the middle of what is seen of it (two legs have it
// between them, whichever shows more), along it the mean and what lies behind the face.
Vector2 position_of(const Piece& piece, const View& view) {
  const Vector2 off = piece.centre_O_m - view.scanner_O_m;
  const double away_m = math::sqrt(off.squaredNorm());
  if (!view.by_scan || !is_compact(piece) || !(away_m > 0)) return piece.centre_O_m;
  const Vector2 sight = off / away_m;
  const Vector2 side = math::left_of(sight);
  double low_m = kFar_m;
  double high_m = -kFar_m;
  for (const Vector2& p : piece.points_O_m) {
    const double across_m = side.dot(p - piece.centre_O_m);
    low_m = std::min(low_m, across_m);
    high_m = std::max(high_m, across_m);
  }
  const double radius_m = math::clamp(0.5 * (high_m - low_m), 0.0, kMaxRadius_m);
  return piece.centre_O_m + side * (0.5 * (low_m + high_m)) + sight * (kFaceToCentre * radius_m);
}

// Mean distance of some of a's points to the nearest of b's.
double shape_distance_m(const Points& a, const Vector2& shift_a, const Points& b) {
  const std::size_t step = (a.size() + kShapePoints - 1) / kShapePoints;
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); i += step, ++count) {
    sum += math::sqrt(nearest2(a[i] + shift_a, b));
  }
  return count > 0 ? sum / static_cast<double>(count) : kFar_m;
}

}  // namespace

void Tracker::reset(const ObjectsConfig& config) {
  config_ = config;
  candidates_.clear();
  counters_ = TrackerCounters{};
}

void Tracker::find_candidates(const Pieces& pieces, ObjectClass kind, const View& view,
                              const ObjectMemory& memory) {
  candidates_.clear();
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const Piece& piece = pieces[p];
    const bool compact = is_compact(piece);
    const Vector2 position = position_of(piece, view);
    for (std::size_t i = 0; i < memory.objects().size(); ++i) {
      const Object& object = memory.objects()[i];
      const Track& track = memory.track(i);
      if (object.kind != kind) continue;
      const Vector2 shift = drift(object, track, view.stamp);
      if (!boxes_within(piece.low_O_m, piece.high_O_m, track.low_O_m + shift,
                        track.high_O_m + shift, config_.gate_m)) {
        continue;
      }
      double cost_m = 0;
      if (compact && track.compact && view.by_scan) {
        cost_m = (position - track.position_O_m - shift).norm();
      } else {
        cost_m = std::min(shape_distance_m(piece.points_O_m, -shift, object.points_O_m),
                          shape_distance_m(object.points_O_m, shift, piece.points_O_m));
      }
      if (cost_m >= config_.gate_m) continue;
      if (object.tracked_s < kNew_s) cost_m += kNewCost_m;
      const Candidate candidate{static_cast<float>(cost_m), static_cast<std::uint16_t>(p),
                                static_cast<std::uint16_t>(i)};
      if (!ok(candidates_.push_back(candidate))) ++counters_.candidates_full;
    }
  }
}

void Tracker::update(Pieces& pieces, ObjectClass kind, const View& view, ObjectMemory& memory) {
  if (kind == ObjectClass::kObstacle && view.by_scan)
    counters_.split += split_pieces(pieces, view.stamp, memory);
  find_candidates(pieces, kind, view, memory);
  match_nearest(candidates_, object_of_piece_);
  for (std::size_t i = 0; i < memory.objects().size(); ++i) {
    if (memory.objects()[i].kind == kind) memory.track(i).matched = false;
  }
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const std::uint16_t i = object_of_piece_[p];
    if (i == kNoObject) continue;
    refresh(pieces[p], view, memory.objects()[i], memory.track(i));
    ++counters_.matched;
  }
  // Only now: what gives way moves the others about.
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    if (object_of_piece_[p] != kNoObject) continue;
    const auto made = memory.add(pieces[p].points_O_m, kind, view.stamp, view.robot_O_m);
    if (!made.ok()) continue;
    Track& track = memory.track(made.value());
    start(pieces[p], view, track);
    track.by_map_only = !view.by_scan;
    track.z_low_m = pieces[p].z_low_m;
    track.z_high_m = pieces[p].z_high_m;
  }
}

void Tracker::start(const Piece& piece, const View& view, Track& track) const {
  track.compact = is_compact(piece);
  track.matched = true;
  track.whole = !piece.partial;
  track.velocity_O_m_s = Vector2::Zero();
  track.position_O_m = position_of(piece, view);
  track.anchor_O_m = track.position_O_m;
  track.anchor_stamp = view.stamp;
  track.filter_stamp = view.stamp;
  track.p_pp = math::square(config_.position_noise_m);
  track.p_pv = 0;
  track.p_vv = math::square(kFirstSpeed_m_s);
}

void Tracker::refresh(const Piece& piece, const View& view, Object& object, Track& track) {
  const double step_s = (view.stamp - object.last_seen).seconds();
  object.tracked_s += math::clamp(step_s, 0.0, kMostStep_s);
  track.matched = true;
  if (view.by_scan) track.by_map_only = false;
  if (view.by_scan) filter(piece, view, object, track);
  if (view.stamp > object.last_seen) object.last_seen = view.stamp;
  refresh_points(piece, object, track);
}

void Tracker::filter(const Piece& piece, const View& view, Object& object, Track& track) const {
  track.compact = is_compact(piece);
  if (!track.whole && !piece.partial) {
    start(piece, view, track);
    return;
  }
  const Vector2 measured = position_of(piece, view);
  const double dt_s = (view.stamp - track.filter_stamp).seconds();
  const bool gap = view.stamp - track.filter_stamp > kCoast;
  track.filter_stamp = view.stamp;
  if (!track.compact || gap || dt_s <= 0) {
    object.moving = object.moving && track.compact && !gap;
    if (!object.moving) object.velocity_O_m_s = Vector2::Zero();
    track.velocity_O_m_s = object.velocity_O_m_s;
    track.position_O_m = measured;
    track.anchor_O_m = measured;
    track.anchor_stamp = view.stamp;
    track.p_pp = math::square(config_.position_noise_m);
    track.p_pv = 0;
    track.p_vv = math::square(kAfterGapSpeed_m_s);
    return;
  }
  const double q = config_.acceleration_m2_s3;
  track.position_O_m += track.velocity_O_m_s * dt_s;
  track.p_pp += dt_s * (2 * track.p_pv + dt_s * (track.p_vv + q * dt_s / 3));
  track.p_pv += dt_s * (track.p_vv + 0.5 * q * dt_s);
  track.p_vv += q * dt_s;
  // Half a trunk at the end of the sweep or behind another has its centre elsewhere.
  const double factor = !piece.partial ? 1.0 : object.moving ? kMovingPartial : kStandingPartial;
  const double noise_m = config_.position_noise_m * factor;
  // What the beams' spacing and the robot's heading leave open grows with the distance.
  const double away_m = (measured - view.scanner_O_m).norm();
  const double beams_m = view.beam_step_rad * away_m;
  const double sideways_m = kHeadingNoise_rad * away_m;
  const double total =
      track.p_pp + math::square(noise_m) + math::square(0.5 * beams_m) + math::square(sideways_m);
  const double k_p = track.p_pp / total;
  const double k_v = track.p_pv / total;
  const Vector2 off = measured - track.position_O_m;
  track.position_O_m += off * k_p;
  track.velocity_O_m_s += off * k_v;
  track.p_vv -= k_v * track.p_pv;
  track.p_pv -= k_p * track.p_pv;
  track.p_pp -= k_p * track.p_pp;

  const double left_m = piece.partial || !track.whole ? kLeftPartial_m : kLeftPlace_m;
  const double speed_m_s = track.velocity_O_m_s.norm();
  if (speed_m_s > config_.moving_off_m_s) track.fast_stamp = view.stamp;
  if (object.moving) {
    object.moving = view.stamp - track.fast_stamp < kStandsAfter;
  } else {
    object.moving = speed_m_s > config_.moving_on_m_s &&
                    speed_m_s > kSignificance * math::sqrt(track.p_vv) &&
                    (track.position_O_m - track.anchor_O_m).norm() > left_m + beams_m + sideways_m;
  }
  if (object.moving || view.stamp - track.anchor_stamp > kAnchorAge) {
    track.anchor_O_m = track.position_O_m;
    track.anchor_stamp = view.stamp;
  }
  object.velocity_O_m_s = object.moving ? track.velocity_O_m_s : Vector2::Zero();
}

// What moves is where it is now; what stands is where it was ever seen, but for what line of sight
// takes away.
void Tracker::refresh_points(const Piece& piece, Object& object, Track& track) {
  if (object.moving || object.kind == ObjectClass::kGround) {
    object.points_O_m = piece.points_O_m;
    track.through.fill(0);
    track.z_low_m = piece.z_low_m;
    track.z_high_m = piece.z_high_m;
    measure(object, track);
    return;
  }
  track.z_low_m = std::min(track.z_low_m, piece.z_low_m);
  track.z_high_m = std::max(track.z_high_m, piece.z_high_m);
  const double thin2 = math::square(config_.thin_m);
  for (const Vector2& p : piece.points_O_m) {
    bool known = false;
    for (std::size_t k = 0; k < object.points_O_m.size(); ++k) {
      if ((object.points_O_m[k] - p).squaredNorm() >= thin2) continue;
      track.through[k] = 0;
      known = true;
    }
    if (known) continue;
    if (ok(object.points_O_m.push_back(p))) {
      track.through[object.points_O_m.size() - 1] = 0;
    } else {
      ++counters_.points_full;
    }
  }
  measure(object, track);
}

void Tracker::settle(TimeNs now, ObjectMemory& memory) const {
  for (std::size_t i = 0; i < memory.objects().size(); ++i) {
    Object& object = memory.objects()[i];
    if (!object.moving || now - object.last_seen <= kCoast) continue;
    object.moving = false;
    object.velocity_O_m_s = Vector2::Zero();
    memory.track(i).velocity_O_m_s = Vector2::Zero();
  }
}

}  // namespace surefoot::objects
