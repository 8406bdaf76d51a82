#include "core/autonomy/map_task.h"

#include "core/robot/kinematics.h"

namespace surefoot::autonomy {
namespace {

Vector3 from_array(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

// From the camera's housing (x forward, y left, z up) to its optical frame (x right, y down, z
// forward).
Matrix3 optical_axes() {
  Matrix3 axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return axes;
}

}  // namespace

geometry::Pose<geometry::Body, geometry::DepthCamera> optical_pose(
    const robot::SensorMount& mount) {
  geometry::Pose<geometry::Body, geometry::DepthCamera> X_BC;
  const auto& rpy = mount.roll_pitch_yaw_rad;
  X_BC.rotation.matrix = geometry::from_roll_pitch_yaw(rpy[0], rpy[1], rpy[2]) * optical_axes();
  X_BC.origin.m = from_array(mount.position_B_m);
  return X_BC;
}

MapCamera depth_map_camera(const robot::RobotModel& model) {
  return {optical_pose(model.depth_camera.mount), mapping::sensor_model(model.depth_camera)};
}

Status MapTask::reset(const mapping::MappingConfig& config,
                      const mapping::TraversabilityLimits& limits, const robot::RobotModel& model,
                      const MapCamera& camera) {
  model_ = model;
  enabled_ = config.enabled;
  counters_ = MapTaskCounters{};
  X_BC_ = camera.X_BC;
  const Status status = mapper_.configure(config, camera.sensor, limits);
  if (!ok(status)) return status;
  // Touch every page now: no page fault may happen in a tick.
  picture_.touch();
  working_.clear();
  window_.clear();
  window_digest_ = window_.digest();
  watches_obstacles_ = false;
  pool_.reset(obstacles::ObstacleConfig{});
  fields_.clear();
  field_counters_ = obstacles::FieldCounters{};
  return Status::kOk;
}

void MapTask::watch_obstacles(const obstacles::ObstacleConfig& config,
                              const obstacles::BlockingRule& rule) {
  watches_obstacles_ = true;
  blocking_ = rule;
  pool_.reset(config);
}

Status MapTask::assume_pad(const mapping::AssumedPad& pad) {
  if (!enabled_) return Status::kUnavailable;
  const Status status = mapper_.assume(pad);
  if (!ok(status)) return status;
  const Status copied = mapper_.publish(pad.x_O_m, pad.y_O_m, window_);
  window_digest_ = window_.digest();
  return copied;
}

bool MapTask::release(const hal::DepthFrame& frame, const mapping::DepthNoise* noise,
                      const Result<PastPose>& pose, const Vector3& window_centre_O_m) {
  if (!enabled_) return false;
  if (!pose.ok()) {
    ++counters_.frames_without_pose;
    return false;
  }
  picture_.assign(frame, noise, pose.value());
  window_centre_O_m_ = window_centre_O_m;
  return true;
}

mapping::SelfModel self_model(const robot::RobotModel& model, const PastPose& pose) {
  mapping::SelfModel self;
  self.X_OB = pose.X_OB();
  self.trunk_size_m = model.trunk_size_m;
  for (std::size_t leg = 0; leg < robot::kLegs; ++leg) {
    Vector3 q;
    for (std::size_t i = 0; i < robot::kJointsPerLeg; ++i) {
      q[static_cast<Eigen::Index>(i)] = pose.joint_rad[robot::joint_index(leg, i)];
    }
    const robot::LegPoints points = robot::leg_points_B(model, leg, q);
    const double radii[3] = {model.thigh_radius_m, model.thigh_radius_m, model.shank_radius_m};
    for (std::size_t link = 0; link < 3; ++link) {
      mapping::SelfCapsule capsule;
      capsule.a_O_m = self.X_OB.rotation.matrix * points.p_B_m[link] + self.X_OB.origin.m;
      capsule.b_O_m = self.X_OB.rotation.matrix * points.p_B_m[link + 1] + self.X_OB.origin.m;
      capsule.radius_m = radii[link];
      SUREFOOT_ASSERT(ok(self.capsules.push_back(capsule)));
    }
  }
  return self;
}

void MapTask::run() {
  const mapping::SelfModel self = self_model(model_, picture_.pose);
  mapping::IntegrationReport report;
  const Status status =
      mapper_.integrate(picture_.frame, self.X_OB * X_BC_, self, &report, picture_.noise());
  if (ok(status)) {
    ++counters_.frames_integrated;
    if (report.rows_put_off + report.rays_put_off > 0) ++counters_.frames_bounded;
  } else {
    ++counters_.frames_refused;
  }
  if (ok(mapper_.publish(window_centre_O_m_[0], window_centre_O_m_[1], working_))) {
    working_digest_ = working_.digest();
  }
  if (watches_obstacles_) pool_.update(working_, blocking_, window_centre_O_m_.head<2>());
}

void MapTask::publish() {
  window_ = working_;
  window_digest_ = working_digest_;
  fields_ = pool_.fields();
  field_counters_ = pool_.counters();
}

}  // namespace surefoot::autonomy
