#include "core/objects/split.h"

#include <algorithm>
#include <array>

#include "core/math/elementary.h"
#include "core/objects/outline.h"

namespace surefoot::objects {
namespace {

constexpr double kNowhere2_m2 = 1e18;
constexpr std::size_t kMaxClaims = 12;
constexpr double kMoverRadius_m = 0.25;
constexpr double kMoverReach_m = 0.3;  // from its predicted position to the piece's box
constexpr double kApart_m = 0.4;       // nearer to each other two movers are one
constexpr double kProven_s = 1.0;      // tracked for: a ghost born inside a person claims nothing
constexpr double kStranger_m = 0.3;    // from all that is known here: something new
constexpr std::size_t kLeastStranger = 2;  // points

// What may share a piece.
struct Claim {
  std::size_t object = 0;
  bool moving = false;
  bool compact = false;
  Vector2 at_O_m = Vector2::Zero();  // of what moves: where it is expected
  double tracked_s = 0;
};
struct Claims {
  FixedVector<Claim, kMaxClaims> list;
  std::size_t small = 0;  // claims that split a piece: all but long standing things
};
// Of each point of the piece: long things share part 0, claim i is part i + 1, strangers the last.
constexpr std::size_t kStranger = kMaxClaims + 1;
using Parts = std::array<std::uint8_t, kMaxObjectPoints>;
using Sizes = std::array<std::size_t, kMaxClaims + 2>;

// Of two movers in one place the one that was tracked for longer claims.
void add_claim(const Claim& claim, Claims& claims) {
  for (Claim& known : claims.list) {
    if (!claim.moving || !known.moving) continue;
    if ((known.at_O_m - claim.at_O_m).squaredNorm() >= math::square(kApart_m)) continue;
    if (claim.tracked_s > known.tracked_s) known = claim;
    return;
  }
  if (!ok(claims.list.push_back(claim))) return;  // what comes later stays with the piece
  claims.small += claim.moving || claim.compact ? 1 : 0;
}

Claims claims_on(const Piece& piece, TimeNs now, const ObjectMemory& memory) {
  Claims claims;
  for (std::size_t i = 0; i < memory.objects().size(); ++i) {
    const Object& object = memory.objects()[i];
    const Track& track = memory.track(i);
    if (object.kind != ObjectClass::kObstacle) continue;
    const Vector2 at = track.position_O_m + drift(object, track, now);
    if (object.moving) {
      if (now - object.last_seen > kCoast) continue;
      if (!boxes_within(piece.low_O_m, piece.high_O_m, at, at, kMoverReach_m)) continue;
    } else {
      if (object.tracked_s <= kProven_s) continue;
      if (!boxes_within(piece.low_O_m, piece.high_O_m, track.low_O_m, track.high_O_m, 0)) continue;
    }
    add_claim({i, object.moving, track.compact, at, object.tracked_s}, claims);
  }
  return claims;
}

std::uint8_t part_of(const Vector2& p, const Claims& claims, const ObjectMemory& memory) {
  double best_m = kNowhere2_m2;
  std::size_t part = 0;
  bool long_thing = false;
  for (std::size_t i = 0; i < claims.list.size(); ++i) {
    const Claim& claim = claims.list[i];
    // Negative inside of a mover's disc, so that of two discs the nearer centre wins.
    const double away_m = claim.moving
                              ? (p - claim.at_O_m).norm() - kMoverRadius_m
                              : math::sqrt(nearest2(p, memory.objects()[claim.object].points_O_m));
    long_thing = long_thing || (!claim.moving && !claim.compact);
    if (away_m >= best_m) continue;
    best_m = away_m;
    part = claim.moving || claim.compact ? i + 1 : 0;
  }
  if (!long_thing && best_m > kStranger_m) part = kStranger;
  return static_cast<std::uint8_t>(part);
}

void take(const Piece& from, const Parts& parts, std::size_t part, Piece& to) {
  // By pointer: `to` may be `from`, whose points then close up.
  const Vector2* const points_O_m = from.points_O_m.begin();
  const std::size_t count = from.points_O_m.size();
  std::size_t kept = 0;
  for (std::size_t k = 0; k < count; ++k) {
    if (parts[k] != part) continue;
    const Vector2 p = points_O_m[k];
    if (kept == to.points_O_m.size()) static_cast<void>(to.points_O_m.resize(kept + 1));
    to.points_O_m.begin()[kept++] = p;
  }
  static_cast<void>(to.points_O_m.resize(kept));
  const Outline outline = outline_of(to.points_O_m);
  to.low_O_m = outline.low_O_m;
  to.high_O_m = outline.high_O_m;
  to.centre_O_m = outline.mean_O_m;
  to.count = static_cast<std::uint32_t>(kept);
  to.z_low_m = from.z_low_m;
  to.z_high_m = from.z_high_m;
  to.partial = true;
}

std::size_t split_piece(Pieces& pieces, std::size_t index, TimeNs now, const ObjectMemory& memory) {
  const Claims claims = claims_on(pieces[index], now, memory);
  if (claims.small == 0) return 0;
  Piece& whole = pieces[index];
  const std::size_t count = whole.points_O_m.size();
  Parts parts{};
  Sizes sizes{};
  const Vector2* const points_O_m = whole.points_O_m.begin();
  for (std::size_t k = 0; k < count; ++k) {
    parts[k] = part_of(points_O_m[k], claims, memory);
    ++sizes[parts[k]];
  }
  std::size_t first = 0;
  while (sizes[first] == 0) ++first;
  if (sizes[first] == count) return 0;
  std::size_t made = 0;
  for (std::size_t m = first + 1; m < sizes.size(); ++m) {
    if (sizes[m] == 0) continue;
    const bool is_speck = m == kStranger && sizes[m] < kLeastStranger;
    if (is_speck || !ok(pieces.resize(pieces.size() + 1))) {
      for (std::uint8_t& part : parts) {
        if (part == m) part = static_cast<std::uint8_t>(first);
      }
      continue;
    }
    take(whole, parts, m, pieces.back());
    ++made;
  }
  if (made > 0) take(whole, parts, first, whole);
  return made;
}

}  // namespace

Vector2 drift(const Object& object, const Track& track, TimeNs now) {
  if (!object.moving) return Vector2::Zero();
  const double dt_s = (now - track.filter_stamp).seconds();
  return track.velocity_O_m_s * math::clamp(dt_s, 0.0, kCoast.seconds());
}

bool boxes_within(const Vector2& low_a, const Vector2& high_a, const Vector2& low_b,
                  const Vector2& high_b, double gap_m) {
  return (low_a - high_b).maxCoeff() < gap_m && (low_b - high_a).maxCoeff() < gap_m;
}

double nearest2(const Vector2& p_O_m, const FixedVector<Vector2, kMaxObjectPoints>& points) {
  double least2 = kNowhere2_m2;
  for (const Vector2& q : points) least2 = std::min(least2, (p_O_m - q).squaredNorm());
  return least2;
}

std::size_t split_pieces(Pieces& pieces, TimeNs now, const ObjectMemory& memory) {
  const std::size_t count = pieces.size();  // not those made on the way
  std::size_t made = 0;
  for (std::size_t i = 0; i < count; ++i) made += split_piece(pieces, i, now, memory);
  return made;
}

}  // namespace surefoot::objects
