// One pose from two odometers (paper 003, section III-A.1): the legs every tick, the camera a few
// times a second, both on the IMU's attitude. Which one counts follows from their covariances: the
// legs drift by the second, even while they trot in place, and more the faster they go and slip;
// the camera drifts by the keyframe, hardly at low speed, more when pictures are blurred and few
// points are left. Either may be missing.
//
// An error-state Kalman filter. Frames: O gravity-aligned, B trunk, N camera, K the same at
// its keyframe.
//
//   p        B in O [m]
//   yaw      turn about up from the attitude that is given to the fused one [rad]
//   rate     of that turn, the gyro's bias about up [rad/s]
//   leg      error of the legs' velocity in B [m/s], a first-order Gauss-Markov process
//   key, now clones of (p, yaw) at the exposures of the keyframe and of the last picture
//   common   six unit normals: the part of a motion's error that all motions from a keyframe share
//   tilt     error of "up" about O's x and y [rad], which bends both odometers' ways alike; nothing
//            here shows it, it is carried so that the height's covariance is right
//
// R = exp(tilt) Rz(yaw) R_OB. The error of a pose is that of the group, p_true = Rz(e) p + d: a
// turn of everything then changes no predicted motion whatever the estimates are, so that no motion
// seems to tell where north is (with d = p_true - p yaw's variance was several times too small).
//
// A motion from K to N is compared with the two clones, six scalars at once, when it arrives
// (stochastic cloning, Roumeliotis and Burdick, ICRA 2002): its age does not matter. Its error is
// sqrt(share) L common + noise of covariance (1 - share) C, C = L L': what the keyframe's
// disparities are off by is the same in every motion from it and must not be averaged away.
//
// How the Estimator calls it:
//   update()          each tick, with its R_OB and what its feet say of the velocity
//   give_attitude()   when it has taken over what was corrected of the yaw
//   note_exposure()   in the tick that asks the camera to expose, with the tick's stamp
//   observe()         when visual odometry has finished that picture
//
// Cost per tick: eight rows and columns of a 24 x 24 covariance; per motion about 15,000
// multiplications. Memory: < 8 kB.
#pragma once

#include <cstdint>

#include "core/base/status.h"
#include "core/base/time.h"
#include "core/estimation/odometry_fusion_config.h"
#include "core/math/linear.h"

namespace surefoot::estimation {

struct LegOdometry {
  bool valid = false;                 // false: no foot carries
  Vector3 v_B_m_s = Vector3::Zero();  // of B's origin over the ground, in B
  double slip = 0;                    // share of the feet in contact that are slipping, 0 to 1
};

// A motion as visual odometry gives it: N in K, covariance of (displacement, rotation) in K's axes.
struct VisualMotion {
  bool valid = false;
  TimeNs from;
  TimeNs to;
  Matrix3 R_KN = Matrix3::Identity();
  Vector3 p_KN_m = Vector3::Zero();
  Matrix6 covariance = Matrix6::Zero();
  bool new_keyframe = false;
};

struct FusionCounters {
  std::uint64_t used = 0;
  std::uint64_t refused = 0;    // not finite, no rotation, no covariance
  std::uint64_t outliers = 0;   // beyond the gate
  std::uint64_t unmatched = 0;  // stamps without a clone

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("used", self.used);
    visit("refused", self.refused);
    visit("outliers", self.outliers);
    visit("unmatched", self.unmatched);
  }
};

class OdometryFusion {
 public:
  using PoseCovariance = Eigen::Matrix<double, 4, 4>;

  // R_BN, p_BN: the rectified left camera in the trunk. kInvalid: a value is outside describe()'s
  // range or the mount is no pose; nothing changed. Forgets everything but starts at p = 0.
  Status configure(const FusionConfig& config, const Matrix3& R_BN, const Vector3& p_BN_m);

  // Starts anew at a pose that is exact by declaration.
  void place(const Vector3& p_OB_m, double yaw_rad);

  // R_OB: attitude by the IMU, its yaw integrated from the gyro. step_s > 0. kInvalid: not finite
  // or not a rotation; nothing changed. Without legs the last velocity is kept, and trusted less.
  Status update(const Matrix3& R_OB, const LegOdometry& legs, double step_s);

  // Whoever gives the attitude has turned it about up since: the pose stays as it is,
  // yaw_offset_rad() becomes what is left of it. R_OB as in update().
  void give_attitude(const Matrix3& R_OB);

  // The camera exposes now: this pose will be asked for. An older exposure that has not been
  // observed is forgotten.
  void note_exposure(TimeNs stamp);

  // kInvalid: see FusionCounters::refused. kUnavailable: the stamps are not those of the keyframe
  // and of the last exposure; a new keyframe is taken over nevertheless if its stamp is.
  // kOutOfRange: farther from the prediction than gate_sigma allows. The pose is unchanged then.
  // A motion that is not valid says only whether its picture is the new keyframe.
  Status observe(const VisualMotion& motion);

  const Vector3& p_OB_m() const { return p_m_; }
  const Matrix3& R_OB() const { return R_; }
  double yaw_offset_rad() const { return yaw_rad_; }
  // Of (p [m], yaw [rad]).
  PoseCovariance pose_covariance() const;
  const Vector3& leg_error_B_m_s() const { return leg_error_m_s_; }
  const FusionCounters& counters() const { return counters_; }

 private:
  static constexpr int kPosition = 0;
  static constexpr int kYaw = 3;
  static constexpr int kRate = 4;
  static constexpr int kLeg = 5;
  static constexpr int kKey = 8;
  static constexpr int kNow = 12;
  static constexpr int kCommon = 16;
  static constexpr int kTilt = 22;
  static constexpr int kStates = 24;
  using Covariance = Eigen::Matrix<double, kStates, kStates>;
  using Rows = Eigen::Matrix<double, 6, kStates>;
  struct Clone {
    bool known = false;
    TimeNs stamp;
    Vector3 p_m = Vector3::Zero();
    Matrix3 R = Matrix3::Identity();
  };
  struct Step;
  struct Innovation {
    Vector6 error = Vector6::Zero();
    Rows jacobian = Rows::Zero();
    Matrix6 noise = Matrix6::Zero();
  };

  void propagate_covariance(const Vector3& v_O_m_s, double step_s);
  void add_noise(double speed_m_s, const LegOdometry& legs, double step_s);
  void copy_clone(int to, int from);
  void take_keyframe(TimeNs stamp);
  bool make_innovation(const VisualMotion& motion, Innovation& out) const;
  Status correct(const Innovation& innovation);
  Matrix3 attitude() const;
  static void move(const Vector3& shift_m, double yaw_rad, Vector3& p_m, Matrix3& R);
  void apply(const Eigen::Matrix<double, kStates, 1>& change);

  FusionConfig config_;
  Matrix3 R_BN_ = Matrix3::Identity();
  Vector3 p_BN_m_ = Vector3::Zero();
  Matrix3 R_given_ = Matrix3::Identity();
  Vector3 last_v_B_m_s_ = Vector3::Zero();
  Vector3 p_m_ = Vector3::Zero();
  Matrix3 R_ = Matrix3::Identity();
  double yaw_rad_ = 0;
  double rate_rad_s_ = 0;
  Vector3 leg_error_m_s_ = Vector3::Zero();
  Vector6 common_ = Vector6::Zero();
  Vector2 tilt_rad_ = Vector2::Zero();
  Clone key_;
  Clone now_;
  Covariance covariance_ = Covariance::Zero();
  FusionCounters counters_;
};

}  // namespace surefoot::estimation
