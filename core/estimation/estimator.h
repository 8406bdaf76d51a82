// The state estimator: attitude, contacts, position and velocity, once per tick, from IMU samples
// and joint states; a tracking camera, where there is one, takes the drift out slowly. Where a
// stereo camera is an odometer, place and heading are the fusion's (odometry_fusion.h) of legs and
// camera: what it corrects is moved into attitude and body state at once, so that there is one O.
#pragma once

#include <array>
#include <span>

#include "core/actuation/joint_bus.h"
#include "core/estimation/attitude.h"
#include "core/estimation/body_state.h"
#include "core/estimation/config.h"
#include "core/estimation/contact.h"
#include "core/estimation/odometry_fusion.h"
#include "core/estimation/relocation.h"
#include "core/estimation/tracking.h"
#include "core/geometry/frames.h"
#include "core/robot/robot_model.h"
#include "hal/api/gait_port.h"

namespace surefoot::estimation {

struct FootState {
  Vector3 p_B_m = Vector3::Zero();    // centre of the foot sphere
  Vector3 v_B_m_s = Vector3::Zero();  // relative to the trunk
  Matrix3 jacobian_B = Matrix3::Zero();
  Vector3 p_O_m = Vector3::Zero();
  bool in_contact = false;
  std::uint32_t ticks_since_change = 0;
  Vector3 force_O_N = Vector3::Zero();
};

// Everything the controllers know of the body.
struct RobotState {
  TimeNs stamp;
  Vector3 p_OB_m = Vector3::Zero();
  Vector3 v_OB_m_s = Vector3::Zero();  // of B's origin, in O
  geometry::Quaternion q_OB;
  Matrix3 R_OB = Matrix3::Identity();
  Vector3 angular_velocity_B_rad_s = Vector3::Zero();
  double yaw_rad = 0;
  std::array<FootState, robot::kLegs> feet;
  std::array<actuation::JointState, robot::kJoints> joints;
};

class Estimator {
 public:
  void reset(const EstimationConfig& config, const robot::RobotModel& model, double tick_s);

  // imu: samples of this tick, oldest first. Returns how many were refused (not finite, out of
  // order).
  std::size_t update(TimeNs stamp, std::span<const hal::ImuSample> imu,
                     const std::array<actuation::JointState, robot::kJoints>& joints,
                     const std::array<GaitPhase, robot::kLegs>& gait, bool lying_still);

  // The same for a body with gaits of its own: its leg odometry takes the place of joints and feet,
  // which stay as they are. gait: samples of this tick, oldest first. Returns how many samples of
  // either kind were refused.
  std::size_t update(TimeNs stamp, std::span<const hal::ImuSample> imu,
                     std::span<const hal::GaitSample> gait, bool lying_still);

  // A sample of the tracking camera and this estimator's own pose at its stamp, where it knows it
  // (kUnavailable: it does not); corrects what the next update() starts from. Status:
  // DriftEstimator::check(), nothing changed but the counters then.
  Status observe_pose(const hal::PoseSample& sample, const Result<PoseAtStamp>& own);

  // From here on legs and stereo camera are fused. kInvalid: see OdometryFusion::configure().
  Status fuse_camera(const FusionConfig& config, const Matrix3& R_BN, const Vector3& p_BN_m);
  // In the tick that asks for an exposure, after update().
  void note_exposure(TimeNs tick);
  // The motion up to that exposure: how far the pose was off that this estimator believed in, which
  // is put right already. Zero if the motion was not used (fusion().counters()).
  DriftCorrection observe_motion(const VisualMotion& motion);

  // The robot has fallen; its pose was right at `trusted`.
  void note_fall(TimeNs trusted) { relocation_.pin(trusted); }
  // It stands again: where and which way, by the camera. kUnavailable: the camera cannot tell,
  // nothing changed.
  Status relocate(TimeNs now);

  // The robot stands at rest on ground that is known to be level: the feet tell where up is. A
  // share of what is off is put right, and of the accelerometer's bias learned. Nothing happens
  // while a foot is in the air.
  void level_on_pad(double share);

  // O and what is in it were off: the trunk is `shift_O_m` from where it was believed to be, and
  // turned about up by yaw_rad. Whoever keeps poses of O moves them too.
  void shift(const Vector3& shift_O_m, double yaw_rad);

  // Declares where the trunk is: O's origin lies on the ground below it. Whoever keeps poses of O
  // forgets them now.
  void place(const Vector3& p_OB_m);
  // Declares which way it looks: O's x axis lies along heading 0.
  void set_yaw(double yaw_rad);

  const RobotState& state() const { return state_; }
  const DriftEstimator& drift() const { return drift_; }
  const OdometryFusion& fusion() const { return fusion_; }
  bool ready() const { return attitude_.initialised(); }
  // The newest sample of a body with gaits of its own; null: none yet.
  const hal::GaitSample* gait() const { return has_gait_ ? &gait_ : nullptr; }
  const Vector3& gyro_bias_B_rad_s() const { return attitude_.gyro_bias_B_rad_s(); }

 private:
  std::size_t observe_attitude(std::span<const hal::ImuSample> imu, bool lying_still, bool carried);
  void observe_feet();
  LegOdometry leg_odometry();
  void fuse(const LegOdometry& legs);
  DriftCorrection follow_fusion();
  void place_feet();
  void decide_contacts(const std::array<GaitPhase, robot::kLegs>& gait);

  robot::RobotModel model_;
  double tick_s_ = 0;
  AttitudeEstimator attitude_;
  ContactEstimator contact_;
  BodyStateEstimator body_;
  CameraMount camera_;
  DriftEstimator drift_;
  Relocation relocation_;
  bool fuses_ = false;
  OdometryFusion fusion_;
  Vector3 fused_O_m_ = Vector3::Zero();  // where the fusion had put the trunk after the last tick
  std::uint64_t slips_ = 0;              // of the body state, up to the last tick
  double uncarried_s_ = 0;               // no foot carries
  std::array<FootObservation, robot::kLegs> observations_;
  bool has_gait_ = false;
  hal::GaitSample gait_;
  RobotState state_;
};

}  // namespace surefoot::estimation
