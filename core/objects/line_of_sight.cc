#include "core/objects/line_of_sight.h"

#include <algorithm>

#include "core/math/elementary.h"

namespace surefoot::objects {
namespace {

constexpr double kHeightMargin_m = 0.15;
constexpr float kHides_m = 0.3F;  // nearer by this: hides the edge
constexpr TimeNs kLeastUnseen = milliseconds(400);
constexpr double kLeastNormal_z = 0.1;  // a scanner on its side sees no plane to speak of

// In L's axes, the point of the scanner's plane above or below a place in O.
struct OnPlane {
  double x_m = 0;
  double y_m = 0;
  double z_O_m = 0;
  bool good = false;
};

OnPlane on_plane(const Matrix3& R_OL, const Vector3& p_OL_m, const Vector2& p_O_m) {
  OnPlane out;
  const Vector3 normal = R_OL.col(2);
  if (normal[2] < kLeastNormal_z) return out;
  const Vector2 off = p_O_m - p_OL_m.head<2>();
  const double dz = -(normal[0] * off[0] + normal[1] * off[1]) / normal[2];
  const Vector3 d(off[0], off[1], dz);
  out.x_m = R_OL.col(0).dot(d);
  out.y_m = R_OL.col(1).dot(d);
  out.z_O_m = p_OL_m[2] + dz;
  out.good = true;
  return out;
}

// Beam towards a place in L; -1: outside the sweep.
std::int32_t beam_at(const hal::LidarScan& scan, const OnPlane& at) {
  const double step = static_cast<double>(scan.angle_step_rad);
  double angle = math::atan2(at.y_m, at.x_m) - static_cast<double>(scan.first_angle_rad);
  if (angle < -0.5 * step) angle += math::kTwoPi;
  if (angle >= math::kTwoPi - 0.5 * step) angle -= math::kTwoPi;
  const double beam = angle / step + 0.5;
  if (!(beam >= 0) || beam >= static_cast<double>(scan.beam_count)) return -1;
  return static_cast<std::int32_t>(beam);
}

}  // namespace

void LineOfSight::reset(const ObjectsConfig& config) {
  config_ = config;
  next_ = 0;
}

void LineOfSight::mark_partial(const hal::LidarScan& scan, Pieces& pieces) {
  for (Piece& piece : pieces) {
    const std::size_t first = piece.first_beam;
    const std::size_t last = piece.last_beam;
    if (first == 0 || last + 1 >= scan.beam_count || last < first) {
      piece.partial = true;
      continue;
    }
    const float before = scan.range_m[first - 1];
    const float after = scan.range_m[last + 1];
    const bool hidden_before = before > 0 && before < scan.range_m[first] - kHides_m;
    const bool hidden_after = after > 0 && after < scan.range_m[last] - kHides_m;
    piece.partial = piece.partial || hidden_before || hidden_after;
  }
}

LineOfSight::Sight LineOfSight::look(const hal::LidarScan& scan, const ScanPoses& poses,
                                     const Vector2& p_O_m, const Track& track) const {
  OnPlane at = on_plane(poses.first.R_OL, poses.first.p_OL_m, p_O_m);
  std::int32_t beam = at.good ? beam_at(scan, at) : -1;
  if (beam < 0) return Sight::kUnknown;
  // Again with the pose at that beam's time.
  const double s = beam / std::max(1.0, scan.beam_count - 1.0);
  const Matrix3 R = poses.first.R_OL + (poses.last.R_OL - poses.first.R_OL) * s;
  at = on_plane(R, poses.first.p_OL_m + (poses.last.p_OL_m - poses.first.p_OL_m) * s, p_O_m);
  beam = at.good ? beam_at(scan, at) : -1;
  if (beam < 1 || beam + 1 >= std::int32_t{scan.beam_count}) return Sight::kUnknown;
  if (at.z_O_m < static_cast<double>(track.z_low_m) - kHeightMargin_m ||
      at.z_O_m > static_cast<double>(track.z_high_m) + kHeightMargin_m) {
    return Sight::kUnknown;
  }
  const double away_m = math::sqrt(at.x_m * at.x_m + at.y_m * at.y_m);
  bool through = true;
  for (std::int32_t i = beam - 1; i <= beam + 1; ++i) {
    const double r = static_cast<double>(scan.range_m[static_cast<std::size_t>(i)]);
    if (!math::is_finite(r) || r < 0 || (r > 0 && r < config_.min_range_m)) {
      return Sight::kUnknown;
    }
    const double seen_m = r > 0 ? r - config_.clear_margin_m : config_.no_return_clear_m;
    if (r > 0 && math::magnitude(r - away_m) <= config_.clear_margin_m) return Sight::kHit;
    through = through && seen_m > away_m;
  }
  return through ? Sight::kThrough : Sight::kUnknown;
}

void LineOfSight::clear_object(const hal::LidarScan& scan, const ScanPoses& poses, TimeNs now,
                               Object& object, Track& track) const {
  const bool fresh = now - object.last_seen < kLeastUnseen;
  std::size_t kept = 0;
  const std::size_t count = object.points_O_m.size();
  for (std::size_t k = 0; k < count; ++k) {
    std::uint8_t through = track.through[k];
    const Sight sight = look(scan, poses, object.points_O_m[k], track);
    if (sight == Sight::kHit) through = 0;
    if (sight == Sight::kThrough && through < 255) ++through;
    const bool last = kept == 0 && k + 1 == count;
    if (through >= config_.clear_scans && !(fresh && (last || !track.matched))) continue;
    object.points_O_m[kept] = object.points_O_m[k];
    track.through[kept++] = through;
  }
  if (kept == count) return;
  static_cast<void>(object.points_O_m.resize(kept));
  measure(object, track);
}

void LineOfSight::clear(const hal::LidarScan& scan, const ScanPoses& poses, TimeNs now,
                        ObjectMemory& memory) {
  const std::size_t count = memory.objects().size();
  std::size_t looked = 0;
  for (std::size_t n = 0; n < count && looked < kPoints; ++n) {
    if (next_ >= count) next_ = 0;
    Object& object = memory.objects()[next_];
    Track& track = memory.track(next_++);
    if (object.kind == ObjectClass::kGround || (object.moving && track.matched)) continue;
    looked += object.points_O_m.size();
    clear_object(scan, poses, now, object, track);
  }
  memory.remove_cleared();
}

}  // namespace surefoot::objects
