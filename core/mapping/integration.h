// Names shared by the parts of one integration step.
#pragma once

#include <cstdint>

#include "core/geometry/frames.h"
#include "core/mapping/height_map.h"

namespace surefoot::mapping {

inline constexpr std::int32_t kMapSide = 1000;
// Cells one ray may pass when it bounds unseen ground.
inline constexpr std::int32_t kMaxCellsPerRay = 256;
// Farthest cell from the camera that is examined for clearing, in cells: 256 x 1.5 cm = 3.8 m.
inline constexpr std::int32_t kMaxClearRadius_cells = 256;
// Cells that one frame looks at for clearing: 400 x 400 and a little more.
inline constexpr std::uint32_t kMaxLooks = 163840;
// Steps of all rays of one frame that bound unseen ground.
inline constexpr std::int32_t kMaxCeilingSteps = 163840;

using ControlMap = HeightMap<kMapSide>;
using CameraPose = geometry::Pose<geometry::Odometry, geometry::DepthCamera>;
using BodyPose = geometry::Pose<geometry::Odometry, geometry::Body>;

// What became of a frame's pixels and of the cells it saw.
struct IntegrationReport {
  std::uint32_t pixels = 0;    // looked at
  std::uint32_t no_depth = 0;  // 0 or outside the sensor's range
  std::uint32_t mixed = 0;     // dropped by the depth-edge filter
  std::uint32_t self = 0;      // on the robot itself
  std::uint32_t too_high = 0;
  std::uint32_t outside = 0;  // beyond the map
  std::uint32_t points = 0;   // used
  std::uint32_t cells_hit = 0;
  std::uint32_t cells_new = 0;
  std::uint32_t cells_fused = 0;
  std::uint32_t cells_pending = 0;    // outliers waiting for confirmation
  std::uint32_t cells_replaced = 0;   // outliers confirmed: the surface moved
  std::uint32_t cells_looked_at = 0;  // for clearing
  std::uint32_t rows_put_off = 0;     // rows of cells left to the next frame: kMaxLooks
  std::uint32_t cells_doubted = 0;    // seen through, not yet cleared
  std::uint32_t cells_cleared = 0;
  std::uint32_t ceilings = 0;      // bounds set or tightened
  std::uint32_t rays_put_off = 0;  // left to the next frame: kMaxCeilingSteps
};

}  // namespace surefoot::mapping
