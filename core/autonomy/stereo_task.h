// The stereo task: slow, released by a pair. Rectifies, matches and makes a picture of depth with
// the noise of every pixel, which the mapping task then takes as it takes a depth camera's frame.
// Also finds the camera's motion from the same pictures (camera_motion.h) and decides when the
// camera exposes.
//
// Memory: sizeof(StereoTask) 23 MB, for pictures up to the port's capacity. Nothing allocates.
#pragma once

#include <array>
#include <cstdint>

#include "core/autonomy/camera_motion.h"
#include "core/autonomy/map_task.h"
#include "core/autonomy/stereo_config.h"
#include "core/mapping/depth_image.h"
#include "core/robot/robot_model.h"
#include "core/stereo/calibration.h"
#include "core/stereo/matcher.h"
#include "core/stereo/rectifier.h"
#include "hal/api/depth_camera_port.h"
#include "hal/api/stereo_camera_port.h"

namespace surefoot::autonomy {

// The pair that is matched: the camera's pictures over `shrink`, made wider on the left by the
// disparities that are tried. The matcher gives no result for so many columns (core/stereo), and
// these are empty.
struct StereoPlan {
  stereo::StereoCalibration calibration;
  stereo::RectifiedPair pair;
  std::uint16_t margin_px = 0;
};

// kInvalid: no camera or no configuration, the calibration is none, or a range of the configuration
// is broken. kOutOfRange: the baseline is none (stereo::rectify). kExhausted: the pictures exceed
// 640 x 480 after shrinking, or 1024 pixels with the margin. out is unchanged then.
Status plan_stereo(const robot::StereoCameraSpecification& camera, const StereoConfig& config,
                   StereoPlan& out);

// What decides whether it is time to expose.
struct StereoMoment {
  bool standing = false;  // on its feet
  bool shifted = false;   // the trunk has come to rest before a step
  double turn_rate_rad_s = 0;
  double speed_m_s = 0;
};

class StereoTrigger {
 public:
  void reset(const StereoConfig& config);
  // Every tick. true: expose now.
  bool update(const StereoMoment& moment, double step_s);

 private:
  StereoConfig config_;
  bool due_ = false;
  double since_s_ = 0;  // the last trigger
};

struct StereoCounters {
  std::uint64_t pairs_matched = 0;   // or only looked at for the motion
  std::uint64_t pairs_refused = 0;   // another size than the calibration's
  std::uint64_t pairs_unusable = 0;  // too few disparities
};

// What the mapping task takes.
struct StereoPicture {
  bool usable = false;
  hal::DepthFrame depth;
  mapping::DepthNoise noise;
};

class StereoTask {
 public:
  // Without a camera the task does nothing. Otherwise see plan_stereo(); matches an empty pair, so
  // that every page it will use has been touched. motion: see CameraMotion::reset(). maps: pairs
  // become pictures of depth; else they are not matched, and the camera is an odometer only.
  Status reset(const robot::StereoCameraSpecification& camera, const StereoConfig& config,
               const CameraMotionConfig& motion, bool maps);
  bool enabled() const { return enabled_; }
  // Only where enabled.
  bool maps() const { return maps_; }
  // Frame C is the rectified left camera. Only where enabled.
  const MapCamera& camera() const { return camera_; }

  // Copies the pair. false: it is of another size than the calibration (counted).
  bool release(const hal::StereoFrame& pair, const PoseHistory& history);
  // May run anywhere between release and publish.
  void run();
  void publish();

  // The picture published last, once; null: taken, or unusable, or none yet.
  const StereoPicture* take();

  CameraMotion& motion() { return motion_; }
  const CameraMotion& motion() const { return motion_; }
  const StereoCounters& counters() const { return counters_; }
  double valid_share() const { return valid_share_; }
  double mean_valid_share() const;

 private:
  void fill(StereoPicture& picture);
  void warm_up();

  bool enabled_ = false;
  bool maps_ = false;
  StereoConfig config_;
  StereoPlan plan_;
  MapCamera camera_;
  double depth_unit_m_ = 0;
  hal::StereoFrame pair_{};
  stereo::Rectifier rectifier_;
  stereo::GreyImage left_;
  stereo::GreyImage right_;
  stereo::Matcher matcher_;
  stereo::DisparityImage disparities_;
  CameraMotion motion_;
  std::array<StereoPicture, 2> pictures_{};  // one is written by run(), the other is published
  std::size_t working_ = 0;
  double working_share_ = 0;
  bool fresh_ = false;
  double valid_share_ = 0;
  double valid_share_sum_ = 0;
  StereoCounters counters_;
};

}  // namespace surefoot::autonomy
