// Position and velocity of the trunk in O from the accelerometer and the feet that stand.
//
// A Kalman filter with the trunk's position and velocity and the four feet as landmarks, after
// Bloesch et al., RSS 2012 (attitude comes from AttitudeEstimator instead of being part of the
// state). Nothing assumes flat ground: a foot's height is a state like its other coordinates.
//
// With isotropic noise the three axes share one 6x6 covariance: state per axis [p, v, foot 0..3].
// Measurements, taken one scalar at a time:
//   foot in contact:  foot_i - p = R_OB * fk_i(q)                       (position)
//                     v = rolling velocity of the foot's centre - R_OB (J qd + omega x fk)
// A round foot rolls: its centre moves with omega_shank x r n although the contact does not slip;
// over a stance of the Mini-Cheetah that is about 1 cm, 10 % of a step, so it is modelled (n = up).
// A foot whose velocity disagrees with the prediction by more than slip_gate_sigma is slipping or
// in the air: it is left out and its landmark starts anew when it agrees again.
//
// Cost: at most 8 scalar updates of a 6x6 covariance. Memory: < 1 kB.
#pragma once

#include <array>
#include <cstdint>

#include "core/estimation/config.h"
#include "core/math/linear.h"
#include "core/robot/robot_model.h"

namespace surefoot::estimation {

// One foot as the joints and the attitude show it, rotated into O.
struct FootObservation {
  bool in_contact = false;
  Vector3 from_body_O_m = Vector3::Zero();             // trunk origin to foot centre
  Vector3 velocity_from_body_O_m_s = Vector3::Zero();  // its rate of change as seen from O's axes
  Vector3 rolling_velocity_O_m_s = Vector3::Zero();    // of the foot's centre over its contact
};

class BodyStateEstimator {
 public:
  void reset(const BodyStateConfig& config);

  // Places the trunk at p_OB_m at rest; feet start unknown.
  void initialise(const Vector3& p_OB_m);

  // acceleration_O_m_s2: trunk origin, gravity removed. step_s > 0.
  void update(const Vector3& acceleration_O_m_s2,
              const std::array<FootObservation, robot::kLegs>& feet, double step_s);

  // In place of update(): another's odometry says how the trunk moves, feet are not known.
  void carry(const Vector3& v_OB_m_s, double step_s);

  // Moves trunk and feet together: O's place and heading under them change, their relation does
  // not.
  void move(const Vector3& shift_O_m, double yaw_rad);

  const Vector3& p_OB_m() const { return p_O_m_; }
  const Vector3& v_OB_m_s() const { return v_O_m_s_; }
  // What the feet changed of the velocity in the last update. Zero in the first one after
  // initialise(): at rest was only said.
  const Vector3& correction_O_m_s() const { return correction_O_m_s_; }
  bool carried() const { return carried_; }  // a foot was used in the last update
  // Foot observations left out as slipping since initialise().
  std::uint64_t slips() const { return slips_; }
  // Landmark of a foot in contact.
  const Vector3& foot_O_m(std::size_t leg) const { return feet_O_m_[leg]; }
  double position_variance_m2() const { return covariance_(0, 0); }
  double velocity_variance_m2_s2() const { return covariance_(1, 1); }

 private:
  static constexpr int kStates = 6;
  using StateVector = Eigen::Matrix<double, kStates, 1>;
  using Covariance = Eigen::Matrix<double, kStates, kStates>;

  void predict(const Vector3& acceleration_O_m_s2,
               const std::array<FootObservation, robot::kLegs>& feet, double step_s);
  void correct_with_foot(std::size_t leg, const FootObservation& foot);
  void start_landmark(std::size_t leg, const FootObservation& foot);
  // Scalar measurement h . x = z on the three axes at once.
  void correct(const StateVector& h, const Vector3& innovation, double variance);

  BodyStateConfig config_;
  Vector3 p_O_m_ = Vector3::Zero();
  Vector3 v_O_m_s_ = Vector3::Zero();
  std::array<Vector3, robot::kLegs> feet_O_m_;
  std::array<bool, robot::kLegs> landmark_{};
  Covariance covariance_ = Covariance::Zero();
  Vector3 correction_O_m_s_ = Vector3::Zero();
  bool carried_ = false;
  bool fresh_ = true;  // no update since initialise()
  std::uint64_t slips_ = 0;
};

}  // namespace surefoot::estimation
