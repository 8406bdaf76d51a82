// What stands and moves around the robot, from the scanner and the height map (paper 003, sections
// III-A.2 and III-B.1): the one thing others use of this folder.
//
//   scan -> points -> ground or wall -> pieces -> tracked objects -> memory -> line of sight
//   height map -> points that stand up -> pieces -> objects in the same memory
//
// O: odometry frame, z up. Everything is bounded and in place: sizeof(ObjectMap) is the memory it
// takes (README.md), the stack below 4 kB. Same inputs, same bits.
#pragma once

#include "core/base/status.h"
#include "core/mapping/map_window.h"
#include "core/objects/config.h"
#include "core/objects/ground_or_wall.h"
#include "core/objects/line_of_sight.h"
#include "core/objects/memory.h"
#include "core/objects/object.h"
#include "core/objects/scan_points.h"
#include "core/objects/segmentation.h"
#include "core/objects/terrain_points.h"
#include "core/objects/tracker.h"
#include "hal/api/lidar_port.h"

namespace surefoot::objects {

struct ObjectCounters {
  std::uint64_t scans = 0;    // used
  std::uint64_t skipped = 0;  // by scan_stride
  std::uint64_t invalid = 0;  // scans or poses that cannot be
  std::uint64_t late = 0;     // scans not newer than the last
  std::uint64_t windows = 0;
  ScanCounters beams;
  GroundCounters ground;
  TerrainCounters terrain;
  SegmentCounters segments;
  TrackerCounters tracker;
  MemoryCounters memory;
};

class ObjectMap {
 public:
  void reset(const ObjectsConfig& config);

  // Takes a scan in. map: nullptr, or the heights around the robot.
  // kInvalid: a scan, pose or ground that cannot be (scan_points.h); kOutOfRange: not newer than
  // the last scan. Both are counted and change nothing else. kOk also for scans that are skipped.
  Status update(const hal::LidarScan& scan, const ScanPoses& poses, const GroundPlane& ground,
                const mapping::MapWindow* map);

  // Takes a published height map in. Objects only the map has shown lose the points whose place it
  // shows level now. kUnavailable: never published.
  Status add_terrain(const mapping::MapWindow& window, const Vector2& robot_O_m);

  // Everything is forgotten, ids go on (after a fall, or a jump of the odometry).
  void forget_all() { memory_.clear(); }

  // In no order. tracked_s == 0: seen once. kGround never blocks. Valid until the next call.
  const Objects& objects() const { return memory_.objects(); }
  // What tracking knows of objects()[i] besides.
  const Track& track(std::size_t i) const { return memory_.track(i); }
  ObjectCounters counters() const;

 private:
  void clear_levelled(const mapping::MapWindow& window);

  ObjectsConfig config_;
  GroundOrWall ground_or_wall_;
  TerrainPoints terrain_points_;
  Segmenter segmenter_;
  Tracker tracker_;
  ObjectMemory memory_;
  LineOfSight line_of_sight_;
  SurfacePoints points_;
  SurfacePoints obstacles_;
  SurfacePoints grounds_;
  Pieces pieces_;
  TimeNs newest_;
  bool any_ = false;
  std::uint32_t until_next_ = 0;
  ObjectCounters counters_;
};

}  // namespace surefoot::objects
