// What the scanner sees through is not there any more: people who walked on, ghosts, and the smear
// that the robot's own drift leaves on an object.
//
// A point of an object is seen through by a scan if the scanner's plane passes its place at a
// height the object was seen at (within 0.15 m), and the beam towards it and both neighbours go on
// for more than clear_margin_m behind it; a beam without return is taken to see no_return_clear_m
// far. After clear_scans such scans without one that ends on it, the point goes; after its last
// point the object. Nothing that was seen in the last 0.4 s goes entirely. Things lower than the
// scanner's plane are never seen through; the height map clears those (object_map.h).
#pragma once

#include <cstddef>

#include "core/objects/config.h"
#include "core/objects/memory.h"
#include "core/objects/scan_points.h"
#include "core/objects/segmentation.h"
#include "hal/api/lidar_port.h"

namespace surefoot::objects {

class LineOfSight {
 public:
  void reset(const ObjectsConfig& config);

  // Sets `partial` of pieces whose edge is not their own: hidden by something nearer, or at the end
  // of the sweep.
  static void mark_partial(const hal::LidarScan& scan, Pieces& pieces);

  // After tracking. At most kPoints points of the memory, going on where the last scan ended: with
  // everything full every object has its turn after 8 scans.
  void clear(const hal::LidarScan& scan, const ScanPoses& poses, TimeNs now, ObjectMemory& memory);

 private:
  static constexpr std::size_t kPoints = 4096;
  enum class Sight : std::uint8_t { kUnknown = 0, kHit, kThrough };

  Sight look(const hal::LidarScan& scan, const ScanPoses& poses, const Vector2& p_O_m,
             const Track& track) const;
  void clear_object(const hal::LidarScan& scan, const ScanPoses& poses, TimeNs now, Object& object,
                    Track& track) const;

  ObjectsConfig config_;
  std::size_t next_ = 0;
};

}  // namespace surefoot::objects
