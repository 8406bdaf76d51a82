// What a HAL backend hands to the executive: the robot's devices, real, simulated or recorded.
// Devices a robot does not have are null.
#pragma once

#include "hal/api/can_port.h"
#include "hal/api/clock.h"
#include "hal/api/depth_camera_port.h"
#include "hal/api/gait_port.h"
#include "hal/api/imu_port.h"
#include "hal/api/lidar_port.h"
#include "hal/api/operator_port.h"
#include "hal/api/pose_port.h"
#include "hal/api/record_sink.h"
#include "hal/api/stereo_camera_port.h"

namespace surefoot::hal {

struct Board {
  Clock* clock = nullptr;      // logical time of the ticks
  Clock* stopwatch = nullptr;  // real time, for execution-time statistics only
  CanPort* can = nullptr;
  GaitPort* gait = nullptr;  // in place of can
  ImuPort* imu = nullptr;
  DepthCameraPort* depth_camera = nullptr;
  LidarPort* lidar = nullptr;
  StereoCameraPort* stereo_camera = nullptr;
  PosePort* pose = nullptr;
  OperatorPort* operator_port = nullptr;
  RecordSink* record = nullptr;
};

}  // namespace surefoot::hal
