// The mapping task: slow, released by a depth frame, working on its own copies, published at a
// fixed later tick (logical execution time). Control never sees the big map, only the published
// window.
#pragma once

#include "core/autonomy/pose_history.h"
#include "core/autonomy/posed_picture.h"
#include "core/mapping/mapper.h"
#include "core/obstacles/field_pool.h"
#include "core/robot/robot_model.h"
#include "hal/api/depth_camera_port.h"

namespace surefoot::autonomy {

struct MapTaskCounters {
  std::uint64_t frames_integrated = 0;
  std::uint64_t frames_without_pose = 0;  // stamp outside the pose history
  std::uint64_t frames_refused = 0;       // by the mapper: header, order, nothing usable
  std::uint64_t frames_bounded = 0;       // left cells or rays to the next frame (kMaxLooks)

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("frames_integrated", self.frames_integrated);
    visit("frames_without_pose", self.frames_without_pose);
    visit("frames_refused", self.frames_refused);
    visit("frames_bounded", self.frames_bounded);
  }
};

// Where the pictures of depth come from: the frame C of their camera and its noise.
struct MapCamera {
  geometry::Pose<geometry::Body, geometry::DepthCamera> X_BC;
  mapping::DepthSensorModel sensor;
};

// Optical axes of a camera in a housing mounted like that.
geometry::Pose<geometry::Body, geometry::DepthCamera> optical_pose(const robot::SensorMount& mount);
MapCamera depth_map_camera(const robot::RobotModel& model);

// What a camera must not take for ground: the robot's own trunk and legs in a past pose.
mapping::SelfModel self_model(const robot::RobotModel& model, const PastPose& pose);

class MapTask {
 public:
  // kInvalid: configuration out of its domain.
  Status reset(const mapping::MappingConfig& config, const mapping::TraversabilityLimits& limits,
               const robot::RobotModel& model, const MapCamera& camera);

  // Finds obstacles in every window from now on.
  void watch_obstacles(const obstacles::ObstacleConfig& config,
                       const obstacles::BlockingRule& rule);

  // The ground under the standing robot, vouched for by the operator.
  Status assume_pad(const mapping::AssumedPad& pad);

  // The ground around a place is not where the map has it any more. Not between release and
  // publish.
  Status forget(double x_O_m, double y_O_m, double half_side_m) {
    pool_.forget_around({x_O_m, y_O_m}, half_side_m);
    return mapper_.forget(x_O_m, y_O_m, half_side_m);
  }

  // Copies frame, noise (null: the sensor's) and pose. false: mapping is off or there is no pose of
  // the frame's stamp (counted).
  bool release(const hal::DepthFrame& frame, const mapping::DepthNoise* noise,
               const Result<PastPose>& pose, const Vector3& window_centre_O_m);
  // May run anywhere between release and publish.
  void run();
  void publish();

  const mapping::MapWindow& window() const { return window_; }
  const obstacles::Fields& fields() const { return fields_; }  // none where nothing is avoided
  const obstacles::FieldCounters& field_counters() const { return field_counters_; }
  const mapping::Mapper& mapper() const { return mapper_; }
  const MapTaskCounters& counters() const { return counters_; }
  std::uint64_t window_digest() const { return window_digest_; }

 private:
  robot::RobotModel model_;
  bool enabled_ = false;
  geometry::Pose<geometry::Body, geometry::DepthCamera> X_BC_;
  PosedPicture picture_;
  Vector3 window_centre_O_m_ = Vector3::Zero();
  MapTaskCounters counters_;
  mapping::Mapper mapper_;
  mapping::MapWindow working_;  // written by run()
  std::uint64_t working_digest_ = 0;
  bool watches_obstacles_ = false;
  obstacles::BlockingRule blocking_;
  obstacles::FieldPool pool_;  // written by run()
  obstacles::Fields fields_;   // what control sees
  obstacles::FieldCounters field_counters_;
  mapping::MapWindow window_;  // what control sees
  std::uint64_t window_digest_ = 0;
};

}  // namespace surefoot::autonomy
