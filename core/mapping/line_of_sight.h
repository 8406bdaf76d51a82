// What a frame says about cells it did not hit: measured cells that it sees through are doubted and
// cleared, unseen cells that its rays pass over get a ceiling.
#pragma once

#include <cstdint>

#include "core/mapping/depth_image.h"
#include "core/mapping/integration.h"
#include "core/mapping/mapping_config.h"

namespace surefoot::mapping {

struct Sight {
  const DepthImage& image;
  const CameraPose& X_OC;
  const MappingConfig& config;
  const DepthSensorModel& sensor;
  std::uint32_t now_ms;
};

// Where a frame's work stopped that had to be bounded; the next frame goes on from there.
struct SightTurn {
  std::int32_t clear_row = 0;      // iy of the row of cells that is looked at first
  std::uint64_t ceiling_pass = 0;  // times that all rays of a pattern had their turn
  std::int32_t ceiling_ray = 0;    // first ray of the present pattern that had not
};

// Every cell with a height within kMaxClearRadius_cells of the camera is projected into the image,
// its centre and, where they are more than a pixel from it, its corners; where all nine pixels
// around each of them lie farther away than the cell by the margin, the cell is doubted, and after
// clear_frames such frames in a row it is cleared: it falls back to bounded. Cells measured in this
// frame (stamp now_ms) are passed over. At most kMaxLooks cells: rows of cells that would exceed it
// are put off, and the next frame begins with them.
void clear_seen_through(const Sight& sight, SightTurn& turn, ControlMap& map,
                        IntegrationReport& report);

// Rays of every ceiling_pixel_stride-th pixel and row, offset by the pass. At most kMaxCeilingSteps
// steps: the rays left over come first in the next frame, which then traces no others.
void lower_ceilings(const Sight& sight, SightTurn& turn, ControlMap& map,
                    IntegrationReport& report);

}  // namespace surefoot::mapping
