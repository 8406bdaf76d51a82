// The localisation task: slow, released by a picture of depth. Registers it with the pictures
// before it (core/registration) and says how far dead reckoning was off. The picture is then mapped
// from where it was found to be, and the estimate follows (paper 001, section II: the robot
// localises itself against its own map).
//
// The coarse cloud it aligns to is built anew each time from the scans that are kept: the last
// `scans` pictures, `scan_distance_m` apart, each where it was registered. So the error grows with
// the number of times the ground has left the window of scans, not with every picture.
//
// The attitude of a picture comes from the registration as well, but the estimate's roll and pitch
// do not follow: the accelerometer knows them better in the long run.
//
// Memory: sizeof(LocalisationTask) 17 MB, most of it two clouds. Nothing allocates.
#pragma once

#include <array>
#include <cstdint>

#include "core/autonomy/localisation_config.h"
#include "core/autonomy/localisation_counters.h"
#include "core/autonomy/map_task.h"
#include "core/autonomy/pose_history.h"
#include "core/autonomy/posed_picture.h"
#include "core/base/fixed_vector.h"
#include "core/mapping/depth_image.h"
#include "core/registration/registration.h"
#include "core/robot/robot_model.h"

namespace surefoot::autonomy {

class LocalisationTask {
 public:
  // kInvalid: the configuration is out of its domain.
  Status reset(const LocalisationConfig& config, const mapping::MappingConfig& mapping,
               const robot::RobotModel& model, const MapCamera& camera);
  bool enabled() const { return enabled_; }
  // Forgets the scans: O and the ground have parted.
  void forget();

  // Copies the picture and its pose. false: not enabled, or no pose (counted).
  bool release(const hal::DepthFrame& frame, const mapping::DepthNoise* noise,
               const Result<PastPose>& pose);
  // May run anywhere between release and publish.
  void run();
  void publish();

  // The picture published last, once, with the pose that it was registered at; null: taken, or none
  // yet.
  const PosedPicture* take();

  // How far dead reckoning was off at the picture published last.
  const OdometryShift& shift() const { return shift_; }
  std::int32_t observed_directions() const { return registration_.observed_directions; }
  double residual_m() const { return registration_.residual_m; }
  const LocalisationCounters& counters() const { return counters_; }

 private:
  struct Point {
    float x_B_m = 0;
    float y_B_m = 0;
    float z_B_m = 0;

    Vector3 p_B_m() const {
      return {static_cast<double>(x_B_m), static_cast<double>(y_B_m), static_cast<double>(z_B_m)};
    }
  };
  // Every third pixel or so: a scan takes part of the picture's points.
  static constexpr std::size_t kScanPoints = 6144;
  struct Scan {
    registration::SourcePose X_OB;
    FixedVector<Point, kScanPoints> points;
  };

  void touch();
  void gather();
  void add_to_source();
  void build_target();
  void align();
  void keep_scan(const registration::SourcePose& X_OB);

  bool enabled_ = false;
  LocalisationConfig config_;
  mapping::MappingConfig mapping_;
  robot::RobotModel model_;
  MapCamera camera_;
  PosedPicture picture_;
  mapping::DepthImage image_;
  FixedVector<Point, mapping::kMaxPixels> points_;  // of the picture
  std::array<Scan, kMaxScans> scans_{};             // a ring of config_.scans
  std::size_t scan_count_ = 0;
  std::size_t next_scan_ = 0;
  registration::Cloud source_;
  registration::Cloud target_;
  registration::Aligner aligner_;
  registration::Registration working_;  // written by run()
  Status working_status_ = Status::kUnavailable;
  bool fresh_ = false;
  OdometryShift shift_;
  registration::Registration registration_;
  LocalisationCounters counters_;
};

}  // namespace surefoot::autonomy
