// From a sweep of the scanner to points in O (paper 003, section III-A.1: "time-synchronized
// information from the pose estimator").
//
// Every beam is placed at its own time: between the scanner's poses at the first and at the last
// beam, linearly in the point's position. For a turn of angle a during the sweep that is off by at
// most a^2 / 8 of the range (1 rad/s and 13 ms: 1 mm at 50 m).
//
// A beam that hits an edge by half reports a range between the edge and what is behind it. Such a
// veil point is far from both neighbours, between them, and not on a line with the two returns on
// either side (a wall at a grazing angle is).
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/fixed_vector.h"
#include "core/base/status.h"
#include "core/math/linear.h"
#include "core/objects/config.h"
#include "hal/api/lidar_port.h"

namespace surefoot::objects {

// L in O: p_O = R_OL p_L + p_OL_m.
struct ScannerPose {
  Matrix3 R_OL = Matrix3::Identity();
  Vector3 p_OL_m = Vector3::Zero();
};
// At the time of the first and of the last beam.
struct ScanPoses {
  ScannerPose first;
  ScannerPose last;
};
// Where `pose` is after a time, turning and moving steadily (both in O's axes).
ScannerPose moved(const ScannerPose& pose, const Vector3& velocity_O_m_s,
                  const Vector3& rate_O_rad_s, double seconds);

// Most points of one segmentation: a scan's, or a height map's.
inline constexpr std::size_t kMaxSurfacePoints = 1600;
inline constexpr std::uint16_t kNoBeam = 0xffff;

struct SurfacePoint {
  Vector2 p_O_m = Vector2::Zero();
  float z_O_m = 0;
  float range_m = 0;
  std::uint16_t beam = kNoBeam;
};
using SurfacePoints = FixedVector<SurfacePoint, kMaxSurfacePoints>;

// Beams that gave no point, by reason.
struct ScanCounters {
  std::uint64_t not_finite = 0;
  std::uint64_t too_near = 0;
  std::uint64_t too_far = 0;
  std::uint64_t no_return = 0;
  std::uint64_t veil = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("not_finite", self.not_finite);
    visit("too_near", self.too_near);
    visit("too_far", self.too_far);
    visit("no_return", self.no_return);
    visit("veil", self.veil);
  }
};

// kInvalid: no beams or more than a scan can hold, a beam angle, step or pose that is not finite, a
// rotation that is none, a position that no map can hold. Linear in the beams.
Status check_scan(const hal::LidarScan& scan, const ScanPoses& poses);

// Of a scan that check_scan passes; in the order of its beams. Counters add up.
void scan_points(const hal::LidarScan& scan, const ScanPoses& poses, const ObjectsConfig& config,
                 SurfacePoints& out, ScanCounters& counters);

}  // namespace surefoot::objects
