// Builds the height map from depth frames. Equations, bounds and limits: README.md.
#pragma once

#include <cstdint>

#include "core/base/status.h"
#include "core/base/time.h"
#include "core/mapping/classifier.h"
#include "core/mapping/depth_image.h"
#include "core/mapping/height_map.h"
#include "core/mapping/integration.h"
#include "core/mapping/line_of_sight.h"
#include "core/mapping/map_window.h"
#include "core/mapping/mapping_config.h"
#include "core/mapping/scan_cells.h"
#include "core/mapping/scan_points.h"
#include "core/mapping/self_filter.h"
#include "hal/api/depth_camera_port.h"

namespace surefoot::mapping {

// A plane z = z_m + slope_x * (x - x_O_m) + slope_y * (y - y_O_m) over a turned rectangle.
struct AssumedPad {
  double x_O_m = 0;  // centre
  double y_O_m = 0;
  double z_O_m = 0;
  double yaw_rad = 0;
  double half_length_m = 0;  // along yaw
  double half_width_m = 0;
  double slope_x = 0;
  double slope_y = 0;
  double sigma_m = 0.01;
};

// Size: sizeof(Mapper), about 18 MB; meant to be a static object. No heap, no clock. Every function
// that returns a Status other than kOk has left map and window bitwise unchanged.
class Mapper {
 public:
  // Checks and keeps the configuration and forgets the map. Touches every page of the object.
  // kInvalid: see validate().
  Status configure(const MappingConfig& config, const DepthSensorModel& sensor,
                   const TraversabilityLimits& limits);
  bool configured() const { return configured_; }

  // Marks the cells of the rectangle that were never measured as assumed and centres the map there
  // if it is still empty. kUnavailable: not configured. kInvalid: not finite, |slope| > 1, sides
  // above 5 m. kOutOfRange: unmappable.
  Status assume(const AssumedPad& pad);

  // Makes the cells of a square of side 2 half_side_m around a position unknown; the rest stays.
  // kUnavailable: not configured. kInvalid: not finite, half_side_m negative or above 5 m.
  // kOutOfRange: unmappable.
  Status forget(double x_O_m, double y_O_m, double half_side_m);

  // One depth frame, taken from X_OC at frame.stamp. The map follows the body.
  // kUnavailable: not configured or mapping disabled. kInvalid: header or pose breaks its domain,
  // or the stamp is not after the last one. kOutOfRange: body or camera unmappable. kNotFound: no
  // pixel can be used. `report`, when given, is written only on kOk and kNotFound. `noise`: of each
  // pixel, null where all have the sensor's. Cost: bounded by
  // kMaxPixels points, one look at each cell within kMaxClearRadius_cells of the camera, and
  // kMaxPixels / ceiling_pixel_stride^2 rays of kMaxCellsPerRay cells.
  Status integrate(const hal::DepthFrame& frame, const CameraPose& X_OC, const SelfModel& self,
                   IntegrationReport* report = nullptr, const DepthNoise* noise = nullptr);

  // Copies and classifies the 100 x 100 cells around a position. kUnavailable: not configured.
  // kInvalid, kOutOfRange: position not finite or unmappable, `out` unchanged. Cells beyond the map
  // are unknown.
  Status publish(double x_O_m, double y_O_m, MapWindow& out);

  // The big map, for pictures and tests.
  const HeightMap<kMapSide>& map() const { return map_; }
  double cell_size_m() const { return config_.cell_size_m; }
  std::uint64_t frames() const { return frames_; }
  TimeNs stamp() const { return stamp_; }
  // Hash of map, stamp and frame count: 16 MB, for tests and run ends, not for every tick.
  std::uint64_t digest() const;

 private:
  Status check(const hal::DepthFrame& frame, const CameraPose& X_OC, const SelfModel& self) const;
  void gather(const CameraPose& X_OC, const SelfModel& self, IntegrationReport& report);
  void sort_in(const ScanPoints& points, std::size_t i, std::size_t pixel, double max_z_O_m,
               const SelfFilter& self_filter, IntegrationReport& report);
  void fuse(std::uint32_t now_ms, IntegrationReport& report);

  MappingConfig config_;
  DepthSensorModel sensor_;
  bool configured_ = false;
  TimeNs stamp_;
  std::uint64_t frames_ = 0;
  HeightMap<kMapSide> map_;
  SightTurn turn_;
  // Scratch of one call; never read across calls.
  DepthImage image_;
  ScanCells scan_;
  WindowClassifier classifier_;
};

}  // namespace surefoot::mapping
