#include "core/objects/scan_points.h"

#include "core/geometry/rotations.h"
#include "core/mapping/height_map.h"
#include "core/math/elementary.h"

namespace surefoot::objects {
namespace {

constexpr double kRotationTolerance = 1e-6;
constexpr double kOnLine_m = 0.1;
constexpr double kOnLineShare = 0.25;  // of the gap to the neighbour

bool is_pose(const ScannerPose& pose) {
  if (!geometry::is_rotation(pose.R_OL, kRotationTolerance)) return false;
  for (int i = 0; i < 3; ++i) {
    if (!mapping::is_mappable(pose.p_OL_m[i])) return false;
  }
  return true;
}

// Along a straight line one over the range is linear in the beam for small steps.
bool goes_on(double far_r, double near_r, double r) {
  if (!(far_r > 0) || !(near_r > 0)) return false;
  const double inverse = 2.0 / near_r - 1.0 / far_r;
  if (!(inverse > 0)) return false;
  const double gap = math::magnitude(r - near_r);
  return math::magnitude(1.0 / inverse - r) <= kOnLine_m + kOnLineShare * gap;
}

class Ranges {
 public:
  explicit Ranges(const hal::LidarScan& scan) : scan_(scan) {}
  // 0: none, or outside the sweep.
  double at(std::int32_t i) const {
    if (i < 0 || i >= std::int32_t{scan_.beam_count}) return 0;
    const double r = static_cast<double>(scan_.range_m[static_cast<std::size_t>(i)]);
    return math::is_finite(r) && r > 0 ? r : 0;
  }

 private:
  const hal::LidarScan& scan_;
};

bool is_veil(const Ranges& ranges, std::int32_t i, double gap_m) {
  const double before = ranges.at(i - 1);
  const double r = ranges.at(i);
  const double after = ranges.at(i + 1);
  if (!(before > 0) || !(after > 0)) return false;
  const bool between = (before < r) == (r < after);
  if (!between || math::magnitude(r - before) < gap_m || math::magnitude(after - r) < gap_m) {
    return false;
  }
  return !goes_on(ranges.at(i - 2), before, r) && !goes_on(ranges.at(i + 2), after, r);
}

// Whether the beam's range is one to use; counts why not.
bool is_usable(const Ranges& ranges, const hal::LidarScan& scan, std::int32_t i,
               const ObjectsConfig& config, ScanCounters& counters) {
  const double r = static_cast<double>(scan.range_m[static_cast<std::size_t>(i)]);
  if (!math::is_finite(r) || r < 0) {
    ++counters.not_finite;
  } else if (r == 0) {
    ++counters.no_return;
  } else if (r < config.min_range_m) {
    ++counters.too_near;
  } else if (r > config.max_range_m) {
    ++counters.too_far;
  } else if (is_veil(ranges, i, config.veil_gap_m)) {
    ++counters.veil;
  } else {
    return true;
  }
  return false;
}

}  // namespace

ScannerPose moved(const ScannerPose& pose, const Vector3& velocity_O_m_s,
                  const Vector3& rate_O_rad_s, double seconds) {
  const Vector3 turn = rate_O_rad_s * seconds;
  const Matrix3 R = geometry::to_matrix(geometry::from_rotation_vector(turn));
  return {R * pose.R_OL, pose.p_OL_m + velocity_O_m_s * seconds};
}

Status check_scan(const hal::LidarScan& scan, const ScanPoses& poses) {
  if (scan.beam_count == 0 || scan.beam_count > hal::kMaxLidarBeams) return Status::kInvalid;
  const double first = static_cast<double>(scan.first_angle_rad);
  const double step = static_cast<double>(scan.angle_step_rad);
  if (!(math::magnitude(first) <= math::kTwoPi)) return Status::kInvalid;
  if (!(step > 1e-5) || !(step * (scan.beam_count - 1) <= math::kTwoPi)) return Status::kInvalid;
  return is_pose(poses.first) && is_pose(poses.last) ? Status::kOk : Status::kInvalid;
}

void scan_points(const hal::LidarScan& scan, const ScanPoses& poses, const ObjectsConfig& config,
                 SurfacePoints& out, ScanCounters& counters) {
  out.clear();
  const Ranges ranges(scan);
  const double last = scan.beam_count > 1 ? scan.beam_count - 1.0 : 1.0;
  for (std::int32_t i = 0; i < std::int32_t{scan.beam_count}; ++i) {
    if (!is_usable(ranges, scan, i, config, counters)) continue;
    const double r = ranges.at(i);
    const math::SinCos angle = math::sin_cos(static_cast<double>(scan.first_angle_rad) +
                                             i * static_cast<double>(scan.angle_step_rad));
    const Vector3 p_L(r * angle.cos, r * angle.sin, 0);
    const Vector3 at_first = poses.first.R_OL * p_L + poses.first.p_OL_m;
    const Vector3 at_last = poses.last.R_OL * p_L + poses.last.p_OL_m;
    const Vector3 p = at_first + (at_last - at_first) * (i / last);
    const SurfacePoint point{{p[0], p[1]},
                             static_cast<float>(p[2]),
                             static_cast<float>(r),
                             static_cast<std::uint16_t>(i)};
    static_cast<void>(out.push_back(point));  // a scan's beams fit
  }
}

}  // namespace surefoot::objects
