// Reads the recorded depth frames with poses (shared/data/depth/MANIFEST.md, section 3).
#pragma once

#include <string>
#include <vector>

#include "core/mapping/mapper.h"
#include "hal/api/depth_camera_port.h"

namespace surefoot::real_data {

// Camera to the recording's world, whose z is not up.
struct PosedFrame {
  std::string image_path;
  Matrix3 R_WC = Matrix3::Identity();
  Vector3 p_WC_m = Vector3::Zero();
};

// Sorted by number. Empty where the folder is missing.
std::vector<PosedFrame> list_frames(const std::string& folder);

hal::PinholeIntrinsics read_intrinsics(const std::string& folder);

// 16-bit grey PNG in millimetres; 65535 becomes 0 (both mean no measurement). False: not readable.
bool read_depth(const std::string& path, hal::DepthFrame& out);

}  // namespace surefoot::real_data
