// Parameters of the state estimator.
#pragma once

#include "core/base/parameters.h"

namespace surefoot::estimation {

struct AttitudeConfig {
  double correction_gain_1_s = 0;        // pull of the accelerometer's "up" on roll and pitch
  double bias_gain_1_s2 = 0;             // the same error's pull on the gyro bias
  double max_gravity_error_m_s2 = 0;     // no correction when | |f| - g | exceeds this
  double still_correction_gain_1_s = 0;  // the same while the robot lies still
  double still_bias_gain_1_s = 0;        // bias = low-pass of the gyro while the robot lies still

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("correction_gain_1_s", self.correction_gain_1_s, {0.0, 10.0},
               "pull of the accelerometer on roll and pitch");
    visit.real("bias_gain_1_s2", self.bias_gain_1_s2, {0.0, 10.0},
               "the same error on the gyro bias");
    visit.real("max_gravity_error_m_s2", self.max_gravity_error_m_s2, {0.1, 20.0},
               "no correction when | |f| - g | exceeds this");
    visit.real("still_correction_gain_1_s", self.still_correction_gain_1_s, {0.0, 50.0},
               "pull of the accelerometer while lying still");
    visit.real("still_bias_gain_1_s", self.still_bias_gain_1_s, {0.0, 20.0},
               "gyro bias low-pass while lying still");
  }
};

struct ContactConfig {
  double observer_gain_1_s = 0;        // bandwidth of the momentum observer
  double touchdown_force_N = 0;        // above: contact begins
  double surprise_force_N = 0;         // the same, farther above the expected ground than
  double expected_height_m = 0;        // this
  double lift_off_force_N = 0;         // below: contact ends
  double max_touchdown_speed_m_s = 0;  // a foot that sinks faster is still in the air
  double earliest_swing_phase = 0;     // no touchdown before this share of a swing
  int confirm_ticks = 0;               // consecutive ticks above the threshold

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("observer_gain_1_s", self.observer_gain_1_s, {1.0, 1000.0}, "momentum observer");
    visit.real("touchdown_force_N", self.touchdown_force_N, {0.1, 500.0}, "above: contact begins");
    visit.real("surprise_force_N", self.surprise_force_N, {0.1, 500.0},
               "the same far above the expected ground");
    visit.real("expected_height_m", self.expected_height_m, {0.0, 0.5},
               "a foot lower than this above its landing is where ground is expected");
    visit.real("lift_off_force_N", self.lift_off_force_N, {0.0, 500.0}, "below: contact ends");
    visit.real("max_touchdown_speed_m_s", self.max_touchdown_speed_m_s, {0.01, 5.0},
               "a foot that sinks faster is still in the air");
    visit.real("earliest_swing_phase", self.earliest_swing_phase, {0.0, 1.0},
               "no touchdown before this share of a swing");
    visit.integer("confirm_ticks", self.confirm_ticks, {1, 50}, "consecutive ticks required");
  }
};

struct BodyStateConfig {
  double accelerometer_noise_m_s2_sqrtHz = 0;
  double foot_position_noise_m = 0;     // forward kinematics, per measurement
  double foot_velocity_noise_m_s = 0;   // encoder velocities, foot deformation
  double foot_slip_noise_m_sqrt_s = 0;  // random walk of a foot in contact
  double slip_gate_sigma = 0;           // a foot whose velocity is farther off is not used

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("accelerometer_noise_m_s2_sqrtHz", self.accelerometer_noise_m_s2_sqrtHz,
               {1e-5, 10.0}, "noise density, vibration included");
    visit.real("foot_position_noise_m", self.foot_position_noise_m, {1e-5, 0.1},
               "of forward kinematics");
    visit.real("foot_velocity_noise_m_s", self.foot_velocity_noise_m_s, {1e-4, 5.0},
               "of a foot in contact");
    visit.real("foot_slip_noise_m_sqrt_s", self.foot_slip_noise_m_sqrt_s, {0.0, 1.0},
               "random walk of a foot in contact");
    visit.real("slip_gate_sigma", self.slip_gate_sigma, {1.0, 100.0},
               "a foot whose velocity is farther off is not used");
  }
};

struct TrackingConfig {
  int min_confidence = 0;           // samples below are not used
  double jump_m = 0;                // a larger change of the error between two samples is the
  double jump_rad = 0;              // camera's
  double odometry_drift_m_s = 0;    // and grows by this over a gap: what the estimate without
  double odometry_drift_rad_s = 0;  // the camera may drift
  double own_horizontal_m = 0;      // an error up to this may be the camera's own
  double own_vertical_m = 0;
  double own_yaw_rad = 0;
  double own_error_share = 0;     // of the gains that acts on it nevertheless
  double position_gain_1_s = 0;   // share of the error that is given back
  double max_horizontal_m_s = 0;  // at most
  double max_vertical_m_s = 0;
  double yaw_gain_1_s = 0;
  double max_yaw_rate_rad_s = 0;
  double yaw_bias_gain_1_s2 = 0;  // of the yaw error on the gyro's bias
  double tilt_gain_1_s = 0;       // at which the tilt of S follows gravity

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.integer("min_confidence", self.min_confidence, {0, 3}, "samples below are not used");
    visit.real("jump_m", self.jump_m, {0.001, 1.0},
               "a larger change of the error between two samples is the camera's");
    visit.real("jump_rad", self.jump_rad, {0.001, 1.0}, "the same of attitude");
    visit.real("odometry_drift_m_s", self.odometry_drift_m_s, {0.0, 1.0},
               "the estimate's drift without the camera");
    visit.real("odometry_drift_rad_s", self.odometry_drift_rad_s, {0.0, 1.0}, "the same of yaw");
    visit.real("own_horizontal_m", self.own_horizontal_m, {0.0, 1.0},
               "an error up to this may be the camera's own");
    visit.real("own_vertical_m", self.own_vertical_m, {0.0, 1.0}, "the same of height");
    visit.real("own_yaw_rad", self.own_yaw_rad, {0.0, 1.0}, "the same of yaw");
    visit.real("own_error_share", self.own_error_share, {0.0, 1.0},
               "of the gains that acts on it nevertheless");
    visit.real("position_gain_1_s", self.position_gain_1_s, {0.0, 10.0},
               "share of the position error given back");
    visit.real("max_horizontal_m_s", self.max_horizontal_m_s, {0.0, 1.0}, "at most");
    visit.real("max_vertical_m_s", self.max_vertical_m_s, {0.0, 1.0}, "at most, up and down");
    visit.real("yaw_gain_1_s", self.yaw_gain_1_s, {0.0, 10.0}, "share of the yaw error given back");
    visit.real("max_yaw_rate_rad_s", self.max_yaw_rate_rad_s, {0.0, 1.0}, "at most");
    visit.real("yaw_bias_gain_1_s2", self.yaw_bias_gain_1_s2, {0.0, 10.0},
               "of the yaw error on the gyro's bias");
    visit.real("tilt_gain_1_s", self.tilt_gain_1_s, {0.0, 10.0},
               "at which the tilt of S follows gravity");
  }
};

struct EstimationConfig {
  AttitudeConfig attitude;
  ContactConfig contact;
  BodyStateConfig body;
  TrackingConfig tracking;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("attitude", self.attitude);
    visit.group("contact", self.contact);
    visit.group("body", self.body);
    visit.group("tracking", self.tracking);
  }
};

}  // namespace surefoot::estimation
