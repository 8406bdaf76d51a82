// The objects task: slow, released by a laser scan or by a window of the map that is new, working
// on its own copies, published at a fixed later tick (logical execution time). Planning and the
// follower see the published list alone.
//
// Memory: the object map, two lists of objects, a scan and a window. Cost: copies of what is used.
#pragma once

#include "core/autonomy/object_task_counters.h"
#include "core/autonomy/pose_history.h"
#include "core/mapping/map_window.h"
#include "core/objects/object_map.h"
#include "core/robot/robot_model.h"
#include "hal/api/lidar_port.h"

namespace surefoot::autonomy {

// What a release takes over. scan, window: null where there is none.
struct ObjectSight {
  const hal::LidarScan* scan = nullptr;
  const mapping::MapWindow* window = nullptr;
  std::uint64_t window_digest = 0;
  objects::GroundPlane ground;  // under the feet
  Vector2 robot_O_m = Vector2::Zero();
};

class ObjectTask {
 public:
  void reset(const objects::ObjectsConfig& config, const robot::LidarSpecification& lidar);

  // false: no scan that could be placed, and no new window.
  bool release(const ObjectSight& sight, const PoseHistory& history);
  // May run anywhere between release and publish.
  void run();
  void publish();

  const objects::Objects& objects() const { return published_; }
  const objects::ObjectMap& map() const { return map_; }  // not between release and publish
  const ObjectTaskCounters& counters() const { return counters_; }
  std::uint64_t digest() const { return digest_; }  // of the published list

 private:
  bool place(const hal::LidarScan& scan, const PoseHistory& history);
  Result<objects::ScannerPose> scanner(const PoseHistory& history, TimeNs stamp) const;

  Matrix3 R_BL_ = Matrix3::Identity();
  Vector3 p_BL_m_ = Vector3::Zero();
  objects::ObjectMap map_;  // written by run()
  bool has_scan_ = false;
  bool has_window_ = false;  // a new one
  hal::LidarScan scan_;
  objects::ScanPoses poses_;
  objects::GroundPlane ground_;
  Vector2 robot_O_m_ = Vector2::Zero();
  mapping::MapWindow window_;
  std::uint64_t window_digest_ = 0;
  objects::Objects published_;
  std::uint64_t digest_ = 0;
  ObjectTaskCounters counters_;
};

}  // namespace surefoot::autonomy
