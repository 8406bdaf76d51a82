// A small ray caster for depth frames with known truth: a ground plane, boxes standing on anything,
// and capsules (legs). Noise as a stereo camera has it: constant in disparity, that is in 1 / z.
#pragma once

#include <memory>
#include <vector>

#include "core/base/random.h"
#include "core/mapping/mapper.h"
#include "core/robot/robot_model.h"
#include "hal/api/depth_camera_port.h"
#include "tests/support/mapping_setup.h"

namespace surefoot::mapping::test {

struct SceneBox {
  Vector3 low = Vector3::Zero();
  Vector3 high = Vector3::Zero();
};

struct SceneCapsule {
  Vector3 a = Vector3::Zero();
  Vector3 b = Vector3::Zero();
  double radius_m = 0;
};

struct Scene {
  double ground_z_m = 0;
  double slope_x = 0;  // dz/dx, through (0, 0, ground_z_m)
  bool has_ground = true;
  std::vector<SceneBox> boxes;
  std::vector<SceneCapsule> capsules;

  // Distance along direction (any length, in units of it); negative: nothing is hit.
  double cast(const Vector3& origin, const Vector3& direction) const;
  // Highest surface below the sky at a place.
  double height(double x, double y) const;
};

struct Camera {
  CameraPose X_OC;
  hal::PinholeIntrinsics intrinsics;
  double inverse_depth_sigma_per_m = 0;
  double min_range_m = 0.17;
  double max_range_m = 4.0;
  double dropout = 0;  // share of pixels lost
};

// Looks along yaw, pitched down; no roll.
CameraPose look(const Vector3& position_O_m, double yaw_rad, double down_rad, double roll_rad = 0);

// The D435 on Mini-Cheetah: 160 x 90, 87 x 58 degrees.
Camera mini_cheetah_camera(const Vector3& position_O_m, double yaw_rad, double down_rad);
robot::DepthCameraSpecification mini_cheetah_camera_specification();

// random: nullptr for a frame without noise.
void render(const Scene& scene, const Camera& camera, TimeNs stamp, Random* random,
            hal::DepthFrame& out);

// A body without legs at the place.
SelfModel bodiless(double x_O_m, double y_O_m, double z_O_m);

std::unique_ptr<Mapper> make_mapper(const MappingConfig& config);
std::unique_ptr<Mapper> make_mapper();

}  // namespace surefoot::mapping::test
