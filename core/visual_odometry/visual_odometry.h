// Motion of a stereo camera from its pictures (paper 003, section III-A.1, reference 6: Howard,
// IROS 2008): corners, matches by similarity, the largest set that keeps its distances, least
// squares. README.md has the equations.
//
// Frames: N is the rectified left camera now, K the same at the keyframe, P at the last picture.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/status.h"
#include "core/base/time.h"
#include "core/math/linear.h"
#include "core/stereo/calibration.h"
#include "core/stereo/images.h"
#include "core/visual_odometry/clique.h"
#include "core/visual_odometry/config.h"
#include "core/visual_odometry/features.h"
#include "core/visual_odometry/motion_solver.h"

namespace surefoot::visual_odometry {

// A rectified pair; or the left picture alone with the disparities that somebody has matched.
struct Pictures {
  TimeNs stamp;  // middle of the exposure
  stereo::GreyView left;
  stereo::GreyView right;                               // not used if there are disparities
  const stereo::DisparityImage* disparities = nullptr;  // of the left picture
};

// How the camera moved since the last picture, by others: the turn from the gyro, the displacement
// from the legs or none.
struct Prediction {
  Matrix3 R_PN = Matrix3::Identity();
  Vector3 p_PN_m = Vector3::Zero();
};

enum class MotionStatus : std::uint8_t {
  kOk,
  kFirst,           // there was no keyframe; this picture is it now
  kTooFewFeatures,  // dark, without texture or without depth
  kInconsistent,    // what was found does not belong to one motion, or not to the predicted turn
};

struct Motion {
  MotionStatus status = MotionStatus::kTooFewFeatures;
  TimeNs from;  // the keyframe's stamp
  TimeNs to;    // the picture's
  // Valid if kOk. Where N is in K.
  Matrix3 R_KN = Matrix3::Identity();
  Vector3 p_KN_m = Vector3::Zero();
  // Of (displacement of N's origin [m], small rotation [rad]), both in K's axes. Errors of motions
  // from one keyframe are alike: most of them are those of its disparities.
  Matrix6 covariance = Matrix6::Zero();
  bool new_keyframe = false;  // this picture is the `from` of what follows
  // Counts of the work
  std::int32_t corners = 0;  // of this picture
  std::int32_t with_depth = 0;
  std::int32_t matched = 0;  // with the keyframe's, alike
  std::int32_t clique = 0;   // of these, one rigid motion
  std::int32_t tracked = 0;  // keyframe's points found again under that motion
  std::int32_t inliers = 0;
  double residual_px = 0;  // root mean square of the inliers
};

class VisualOdometry {
 public:
  // kInvalid: see validate(), or the pair is not one (sizes, focal length, baseline); nothing
  // changed. Forgets the keyframe.
  Status configure(const VisualOdometryConfig& config, const stereo::RectifiedPair& pair);

  // Forgets the keyframe.
  void reset();

  // kInvalid: a picture has another size than the pair, the stamp is not after the last one, the
  // prediction is no rotation or not finite; nothing changed. Cost: README.md, bounded.
  Status update(const Pictures& pictures, const Prediction& prediction, Motion& out);

  bool has_keyframe() const { return has_keyframe_; }

 private:
  void look(const Pictures& pictures, Motion& out);
  void match(const KeyframeView& predicted);
  void pair_up(std::size_t from, const KeyframeView& predicted);
  bool start(const KeyframeView& predicted, KeyframeView& out, Motion& motion);
  void track(const KeyframeView& view);
  void track_one(std::size_t index, const KeyframeView& view);
  bool refine(const KeyframeView& first, const KeyframeView& predicted, Motion& out);
  bool estimate(const KeyframeView& predicted, Motion& out);
  bool accept(const Solution& solution, const KeyframeView& predicted, Motion& out) const;
  bool keyframe_worn(const Motion& motion) const;
  void make_keyframe(const Motion& motion);
  NoisyPoint noisy_point(const Feature& feature) const;

  VisualOdometryConfig config_;
  stereo::RectifiedPair pair_;
  bool configured_ = false;
  bool has_keyframe_ = false;
  TimeNs keyframe_stamp_;
  TimeNs last_stamp_;
  bool started_ = false;       // last_stamp_ is one
  KeyframeView last_;          // of the last picture, by the prediction if it failed
  std::int32_t failures_ = 0;  // in a row
  std::int32_t keyframe_points_ = 0;

  stereo::GreyImage left_;  // smoothed
  stereo::GreyImage right_;
  CornerFinder corners_;
  std::array<Features, 2> features_{};  // the keyframe's and the present ones
  std::size_t present_ = 0;
  Matches matches_;
  std::array<double, kMaxFeatures> best_for_{};  // best similarity of each present feature
  std::array<std::uint16_t, kMaxFeatures> best_from_{};
  CliqueFinder cliques_;
  std::array<bool, kMaxFeatures> chosen_{};
  Observations observations_;
};

}  // namespace surefoot::visual_odometry
