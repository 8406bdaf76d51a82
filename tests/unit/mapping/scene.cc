#include "tests/unit/mapping/scene.h"

#include <cmath>

#include "core/geometry/rotations.h"
#include "core/math/elementary.h"

namespace surefoot::mapping::test {
namespace {

constexpr double kFar = 1e9;

double cast_box(const SceneBox& box, const Vector3& origin, const Vector3& direction) {
  double enter = 0;
  double leave = kFar;
  for (int i = 0; i < 3; ++i) {
    if (std::fabs(direction[i]) < 1e-12) {
      if (origin[i] < box.low[i] || origin[i] > box.high[i]) return -1;
      continue;
    }
    const double a = (box.low[i] - origin[i]) / direction[i];
    const double b = (box.high[i] - origin[i]) / direction[i];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave && enter > 0 ? enter : -1;
}

// Sphere tracing: exact enough (1e-5 m) and simple.
double cast_capsule(const SceneCapsule& capsule, const Vector3& origin, const Vector3& direction) {
  const double length = direction.norm();
  const Vector3 ab = capsule.b - capsule.a;
  double t = 0;
  for (int i = 0; i < 200; ++i) {
    const Vector3 p = origin + direction * (t / length);
    const double along = std::min(1.0, std::max(0.0, (p - capsule.a).dot(ab) / ab.dot(ab)));
    const double distance = (p - capsule.a - along * ab).norm() - capsule.radius_m;
    if (distance < 1e-5) return t / length;
    t += distance;
    if (t > 20) return -1;
  }
  return -1;
}

}  // namespace

double Scene::cast(const Vector3& origin, const Vector3& direction) const {
  double nearest = kFar;
  const auto keep = [&nearest](double t) {
    if (t > 0) nearest = std::min(nearest, t);
  };
  if (has_ground) {
    const double closing = slope_x * direction.x() - direction.z();
    const double above = origin.z() - ground_z_m - slope_x * origin.x();
    if (closing > 1e-12) keep(above / closing);
  }
  for (const SceneBox& box : boxes) keep(cast_box(box, origin, direction));
  for (const SceneCapsule& capsule : capsules) keep(cast_capsule(capsule, origin, direction));
  return nearest < kFar ? nearest : -1;
}

double Scene::height(double x, double y) const {
  double z = ground_z_m + slope_x * x;
  for (const SceneBox& box : boxes) {
    const bool over =
        x >= box.low.x() && x <= box.high.x() && y >= box.low.y() && y <= box.high.y();
    if (over) z = std::max(z, box.high.z());
  }
  return z;
}

CameraPose look(const Vector3& position_O_m, double yaw_rad, double down_rad, double roll_rad) {
  Matrix3 optical;  // x right, y down, z forward, in axes x forward, y left, z up
  optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  CameraPose pose;
  pose.rotation.matrix = geometry::from_roll_pitch_yaw(roll_rad, down_rad, yaw_rad) * optical;
  pose.origin.m = position_O_m;
  return pose;
}

robot::DepthCameraSpecification mini_cheetah_camera_specification() {
  robot::DepthCameraSpecification camera;
  camera.width_px = 160;
  camera.height_px = 90;
  camera.horizontal_view_rad = 1.518;
  camera.vertical_view_rad = 1.012;
  camera.rate_Hz = 30;
  camera.min_range_m = 0.17;
  camera.max_range_m = 4.0;
  camera.disparity_noise_px = 0.08;
  camera.baseline_m = 0.05;
  camera.native_width_px = 848;
  return camera;
}

Camera mini_cheetah_camera(const Vector3& position_O_m, double yaw_rad, double down_rad) {
  const robot::DepthCameraSpecification specification = mini_cheetah_camera_specification();
  Camera camera;
  camera.X_OC = look(position_O_m, yaw_rad, down_rad);
  camera.intrinsics.width_px = specification.width_px;
  camera.intrinsics.height_px = specification.height_px;
  camera.intrinsics.fx_px = 80 / math::tan(0.5 * specification.horizontal_view_rad);
  camera.intrinsics.fy_px = 45 / math::tan(0.5 * specification.vertical_view_rad);
  camera.intrinsics.cx_px = 79.5;
  camera.intrinsics.cy_px = 44.5;
  camera.inverse_depth_sigma_per_m = sensor_model(specification).inverse_depth_sigma_per_m;
  return camera;
}

void render(const Scene& scene, const Camera& camera, TimeNs stamp, Random* random,
            hal::DepthFrame& out) {
  out.stamp = stamp;
  out.intrinsics = camera.intrinsics;
  out.depth_unit_m = 0.001F;
  const Matrix3& R = camera.X_OC.rotation.matrix;
  std::size_t i = 0;
  for (int v = 0; v < camera.intrinsics.height_px; ++v) {
    for (int u = 0; u < camera.intrinsics.width_px; ++u, ++i) {
      const Vector3 ray((u - camera.intrinsics.cx_px) / camera.intrinsics.fx_px,
                        (v - camera.intrinsics.cy_px) / camera.intrinsics.fy_px, 1.0);
      double z = scene.cast(camera.X_OC.origin.m, R * ray);
      double lost = 1;
      if (random != nullptr) {
        z = 1.0 / (1.0 / z + camera.inverse_depth_sigma_per_m * random->normal());
        lost = random->uniform();
      }
      const bool valid =
          z >= camera.min_range_m && z <= camera.max_range_m && !(lost < camera.dropout);
      out.depth[i] = valid ? static_cast<std::uint16_t>(z * 1000 + 0.5) : std::uint16_t{0};
    }
  }
}

SelfModel bodiless(double x_O_m, double y_O_m, double z_O_m) {
  SelfModel self;
  self.X_OB.origin.m = Vector3(x_O_m, y_O_m, z_O_m);
  return self;
}

std::unique_ptr<Mapper> make_mapper(const MappingConfig& config) {
  auto mapper = std::make_unique<Mapper>();
  const Status status = mapper->configure(config, sensor_model(mini_cheetah_camera_specification()),
                                          limits_of(config));
  SUREFOOT_ASSERT(ok(status));
  return mapper;
}

std::unique_ptr<Mapper> make_mapper() { return make_mapper(recommended_config()); }

}  // namespace surefoot::mapping::test
