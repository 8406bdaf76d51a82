#include "core/autonomy/object_task.h"

#include "core/base/fields.h"
#include "core/base/hash.h"
#include "core/geometry/rotations.h"

namespace surefoot::autonomy {
namespace {

std::uint64_t digest_of(const objects::Objects& objects) {
  Fnv64 hash;
  for (const objects::Object& object : objects) {
    hash.word(object.id, sizeof(object.id));
    hash.word(object.points_O_m.size(), sizeof(std::uint32_t));
    hash.word(scalar_bits(object.centre_O_m[0]), sizeof(double));
    hash.word(scalar_bits(object.centre_O_m[1]), sizeof(double));
    hash.word(scalar_bits(object.velocity_O_m_s[0]), sizeof(double));
    hash.word(scalar_bits(object.velocity_O_m_s[1]), sizeof(double));
  }
  return hash.value();
}

}  // namespace

void ObjectTask::reset(const objects::ObjectsConfig& config,
                       const robot::LidarSpecification& lidar) {
  const std::array<double, 3>& rpy = lidar.mount.roll_pitch_yaw_rad;
  const std::array<double, 3>& p = lidar.mount.position_B_m;
  R_BL_ = geometry::from_roll_pitch_yaw(rpy[0], rpy[1], rpy[2]);
  p_BL_m_ = Vector3(p[0], p[1], p[2]);
  map_.reset(config);
  has_scan_ = false;
  has_window_ = false;
  window_.clear();
  window_digest_ = 0;
  published_.clear();
  digest_ = 0;
  counters_ = ObjectTaskCounters{};
}

Result<objects::ScannerPose> ObjectTask::scanner(const PoseHistory& history, TimeNs stamp) const {
  const Result<PastPose> past = history.at(stamp);
  if (!past.ok()) return past.status();
  const Matrix3 R_OB = geometry::to_matrix(past.value().q_OB);
  return objects::ScannerPose{R_OB * R_BL_, past.value().p_OB_m + R_OB * p_BL_m_};
}

bool ObjectTask::place(const hal::LidarScan& scan, const PoseHistory& history) {
  const std::int64_t beams = scan.beam_count;
  const TimeNs end = scan.stamp + scan.beam_interval * (beams > 0 ? beams - 1 : 0);
  const Result<objects::ScannerPose> first = scanner(history, scan.stamp);
  const Result<objects::ScannerPose> last = scanner(history, end);
  if (!first.ok() || !last.ok()) {
    ++counters_.scans_without_pose;
    return false;
  }
  poses_ = {first.value(), last.value()};
  scan_ = scan;
  return true;
}

bool ObjectTask::release(const ObjectSight& sight, const PoseHistory& history) {
  has_scan_ = sight.scan != nullptr && place(*sight.scan, history);
  has_window_ = sight.window != nullptr && sight.window_digest != window_digest_;
  if (!has_scan_ && !has_window_) return false;
  if (has_window_) {
    window_ = *sight.window;
    window_digest_ = sight.window_digest;
  }
  ground_ = sight.ground;
  robot_O_m_ = sight.robot_O_m;
  return true;
}

void ObjectTask::run() {
  if (has_scan_) {
    const mapping::MapWindow* const heights = window_.cell_size_m > 0 ? &window_ : nullptr;
    ++(ok(map_.update(scan_, poses_, ground_, heights)) ? counters_.scans
                                                        : counters_.scans_refused);
  }
  if (has_window_ && ok(map_.add_terrain(window_, robot_O_m_))) ++counters_.windows;
}

void ObjectTask::publish() {
  objects::assign(published_, map_.objects());
  digest_ = digest_of(published_);
}

}  // namespace surefoot::autonomy
