#include "core/objects/object_map.h"

#include "core/math/elementary.h"

namespace surefoot::objects {
namespace {

bool is_plane(const GroundPlane& ground) {
  for (int i = 0; i < 3; ++i) {
    if (!mapping::is_mappable(ground.feet_O_m[i])) return false;
  }
  return math::is_finite(ground.slope[0]) && math::is_finite(ground.slope[1]);
}

}  // namespace

void ObjectMap::reset(const ObjectsConfig& config) {
  config_ = config;
  ground_or_wall_.reset(config);
  terrain_points_.reset(config);
  segmenter_.reset(config);
  tracker_.reset(config);
  memory_.reset(config);
  line_of_sight_.reset(config);
  newest_ = TimeNs{};
  any_ = false;
  until_next_ = 0;
  counters_ = ObjectCounters{};
}

Status ObjectMap::update(const hal::LidarScan& scan, const ScanPoses& poses,
                         const GroundPlane& ground, const mapping::MapWindow* map) {
  if (!ok(check_scan(scan, poses)) || !is_plane(ground)) {
    ++counters_.invalid;
    return Status::kInvalid;
  }
  if (any_ && scan.stamp <= newest_) {
    ++counters_.late;
    return Status::kOutOfRange;
  }
  any_ = true;
  newest_ = scan.stamp;
  if (until_next_ > 0) {
    --until_next_;
    ++counters_.skipped;
    return Status::kOk;
  }
  until_next_ = config_.scan_stride - 1;
  ++counters_.scans;

  const Vector2 robot_O_m = ground.feet_O_m.head<2>();
  const View view{scan.stamp, robot_O_m, poses.first.p_OL_m.head<2>(),
                  static_cast<double>(scan.angle_step_rad), true};
  scan_points(scan, poses, config_, points_, counters_.beams);
  ground_or_wall_.part(points_, scan.stamp, ground, map, obstacles_, grounds_);
  segmenter_.segment(obstacles_, robot_O_m, pieces_);
  LineOfSight::mark_partial(scan, pieces_);
  tracker_.update(pieces_, ObjectClass::kObstacle, view, memory_);
  segmenter_.segment(grounds_, robot_O_m, pieces_);
  tracker_.update(pieces_, ObjectClass::kGround, view, memory_);
  line_of_sight_.clear(scan, poses, scan.stamp, memory_);
  tracker_.settle(scan.stamp, memory_);
  memory_.forget(scan.stamp, robot_O_m);
  return Status::kOk;
}

Status ObjectMap::add_terrain(const mapping::MapWindow& window, const Vector2& robot_O_m) {
  if (!(window.cell_size_m > 0)) return Status::kUnavailable;
  ++counters_.windows;
  terrain_points_.find(window, points_);
  segmenter_.segment(points_, robot_O_m, pieces_);
  tracker_.update(pieces_, ObjectClass::kObstacle, {window.stamp, robot_O_m, robot_O_m, 0, false},
                  memory_);
  clear_levelled(window);
  return Status::kOk;
}

void ObjectMap::clear_levelled(const mapping::MapWindow& window) {
  for (std::size_t i = 0; i < memory_.objects().size(); ++i) {
    Track& track = memory_.track(i);
    Object& object = memory_.objects()[i];
    if (!track.by_map_only || object.kind != ObjectClass::kObstacle) continue;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < object.points_O_m.size(); ++k) {
      if (terrain_points_.is_level(window, object.points_O_m[k])) continue;
      object.points_O_m[kept] = object.points_O_m[k];
      track.through[kept++] = 0;
    }
    if (kept == object.points_O_m.size()) continue;
    static_cast<void>(object.points_O_m.resize(kept));
    measure(object, track);
  }
  memory_.remove_cleared();
}

ObjectCounters ObjectMap::counters() const {
  ObjectCounters all = counters_;
  all.ground = ground_or_wall_.counters();
  all.terrain = terrain_points_.counters();
  all.segments = segmenter_.counters();
  all.tracker = tracker_.counters();
  all.memory = memory_.counters();
  return all;
}

}  // namespace surefoot::objects
