// Everything that is adjustable in the simulated robot's devices. Recommended values: README.md.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/parameters.h"
#include "core/robot/robot_model.h"
#include "sim_hal/scenario.h"

namespace surefoot::sim {

struct PhysicsConfig {
  double step_s = 0.0005;
  double contact_erp = 0.3;                  // part of a penetration removed per step
  double contact_cfm = 1e-5;                 // softness [s/kg]
  double max_correcting_velocity_m_s = 0.5;  // at which a penetration is pushed out

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("step_s", self.step_s, {0.0001, 0.002}, "fixed step of the integrator");
    visit.real("contact_erp", self.contact_erp, {0.01, 0.9}, "penetration removed per step");
    visit.real("contact_cfm", self.contact_cfm, {1e-9, 0.01}, "softness");
    visit.real("max_correcting_velocity_m_s", self.max_correcting_velocity_m_s, {0.01, 10.0},
               "at which a penetration is pushed out");
  }
};

// White noise of density d gives samples of deviation d * sqrt(rate). Biases start at a normal draw
// of the stated deviation and then walk.
struct ImuNoiseConfig {
  double gyro_noise_rad_s_rtHz = 0;
  double gyro_bias_rad_s = 0;
  double gyro_bias_walk_rad_s2_rtHz = 0;
  double accelerometer_noise_m_s2_rtHz = 0;
  double accelerometer_bias_m_s2 = 0;
  double accelerometer_bias_walk_m_s3_rtHz = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("gyro_noise_rad_s_rtHz", self.gyro_noise_rad_s_rtHz, {0.0, 0.1}, "density");
    visit.real("gyro_bias_rad_s", self.gyro_bias_rad_s, {0.0, 0.5}, "one sigma at start");
    visit.real("gyro_bias_walk_rad_s2_rtHz", self.gyro_bias_walk_rad_s2_rtHz, {0.0, 0.1},
               "density");
    visit.real("accelerometer_noise_m_s2_rtHz", self.accelerometer_noise_m_s2_rtHz, {0.0, 1.0},
               "density");
    visit.real("accelerometer_bias_m_s2", self.accelerometer_bias_m_s2, {0.0, 2.0},
               "one sigma at start");
    visit.real("accelerometer_bias_walk_m_s3_rtHz", self.accelerometer_bias_walk_m_s3_rtHz,
               {0.0, 1.0}, "density");
  }
};

struct DepthNoiseConfig {
  double latency_s = 0;        // from exposure to delivery
  double edge_dropout = 0;     // probability at a pixel beside a depth discontinuity
  double random_dropout = 0;   // probability anywhere else
  double correlated_part = 0;  // share of the disparity variance common to a 4 x 4 patch

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("latency_s", self.latency_s, {0.0, 0.2}, "from exposure to delivery");
    visit.real("edge_dropout", self.edge_dropout, {0.0, 1.0}, "probability at discontinuities");
    visit.real("random_dropout", self.random_dropout, {0.0, 1.0}, "probability elsewhere");
    visit.real("correlated_part", self.correlated_part, {0.0, 1.0},
               "share of the disparity variance common to a 4 x 4 patch");
  }
};

// White noise is per sample. The walks are random walks of what the camera takes for its pose; a
// jump is what a relocalisation does to it.
struct TrackingNoiseConfig {
  double latency_s = 0;            // from exposure to delivery
  double position_noise_m = 0;     // one sigma per axis
  double attitude_noise_rad = 0;   // one sigma per axis
  double position_walk_m_rts = 0;  // drift, one sigma per axis after a second
  double yaw_walk_rad_rts = 0;
  double jump_interval_s = 0;  // mean time between jumps; 0: none
  double jump_m = 0;           // one sigma per axis
  double jump_rad = 0;         // one sigma, yaw
  double regain_s = 0;         // low confidence after start and outage
  double regain_noise_factor = 1;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("latency_s", self.latency_s, {0.0, 0.2}, "from exposure to delivery");
    visit.real("position_noise_m", self.position_noise_m, {0.0, 0.1}, "one sigma per axis");
    visit.real("attitude_noise_rad", self.attitude_noise_rad, {0.0, 0.1}, "one sigma per axis");
    visit.real("position_walk_m_rts", self.position_walk_m_rts, {0.0, 0.1},
               "drift, one sigma per axis after a second");
    visit.real("yaw_walk_rad_rts", self.yaw_walk_rad_rts, {0.0, 0.1}, "drift of yaw");
    visit.real("jump_interval_s", self.jump_interval_s, {0.0, 1e6}, "mean time; 0: none");
    visit.real("jump_m", self.jump_m, {0.0, 2.0}, "one sigma per axis");
    visit.real("jump_rad", self.jump_rad, {0.0, 1.0}, "one sigma, yaw");
    visit.real("regain_s", self.regain_s, {0.0, 60.0}, "low confidence after start and outage");
    visit.real("regain_noise_factor", self.regain_noise_factor, {1.0, 100.0},
               "on the noise while confidence is low");
  }
};

// The pictures of a stereo pair. The ground's pattern is made up; what is seen of it is the same
// for both eyes but for noise and exposure.
struct StereoImageConfig {
  bool present = false;
  double latency_s = 0;   // from exposure to delivery
  double texture = 0;     // contrast of the pattern; 0: a surface without any
  double grey_noise = 0;  // one sigma, grey levels
  double right_gain = 1;  // brightness of the right picture
  double right_offset = 0;
  double dropout = 0;  // probability that a pair is lost

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("latency_s", self.latency_s, {0.0, 0.5}, "from exposure to delivery");
    visit.real("texture", self.texture, {0.0, 2.0}, "contrast of the ground's pattern");
    visit.real("grey_noise", self.grey_noise, {0.0, 50.0}, "one sigma, grey levels");
    visit.real("right_gain", self.right_gain, {0.5, 2.0}, "brightness of the right picture");
    visit.real("right_offset", self.right_offset, {-50.0, 50.0}, "grey levels added to it");
    visit.real("dropout", self.dropout, {0.0, 1.0}, "probability that a pair is lost");
  }
};

// Of the laser scanner, beside what its specification says.
struct LidarNoiseConfig {
  bool present = false;
  double latency_s = 0;       // from the end of a sweep to delivery
  double mixed_pixel = 0;     // probability, of a beam on two surfaces up to 2 m apart
  double random_dropout = 0;  // probability of a beam
  double sapling_return = 0;  // probability that a sapling as wide as the beam gives an echo

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("latency_s", self.latency_s, {0.0, 0.1}, "from the end of a sweep to delivery");
    visit.real("mixed_pixel", self.mixed_pixel, {0.0, 1.0},
               "probability, of a beam on two surfaces up to 2 m apart");
    visit.real("random_dropout", self.random_dropout, {0.0, 1.0}, "probability of a beam");
    visit.real("sapling_return", self.sapling_return, {0.0, 1.0},
               "probability that a sapling as wide as the beam gives an echo");
  }
};

struct CanConfig {
  double frame_time_s = 0.00012;    // one frame on the wire; commands and replies share the bus
  double reply_loss = 0;            // probability that a reply never arrives
  std::uint8_t reply_size = 8;      // 6 (original), 7 (motorcontrol v2) or 8 (CubeMars)
  std::uint16_t reply_id = 0;       // CAN id of every reply; byte 0 names the drive
  double encoder_noise_rad = 0;     // at the drive output, one sigma
  double velocity_noise_rad_s = 0;  // at the drive output, one sigma

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("frame_time_s", self.frame_time_s, {0.0, 0.002}, "one frame on the wire");
    visit.real("reply_loss", self.reply_loss, {0.0, 1.0}, "probability");
    visit.integer("reply_size", self.reply_size, {6, 8}, "bytes");
    visit.integer("reply_id", self.reply_id, {0, 2047}, "CAN id of every reply");
    visit.real("encoder_noise_rad", self.encoder_noise_rad, {0.0, 0.1}, "one sigma");
    visit.real("velocity_noise_rad_s", self.velocity_noise_rad_s, {0.0, 2.0}, "one sigma");
  }
};

// Faults injected on purpose. Times are simulated time; a period with end <= begin never happens.
struct FaultConfig {
  std::int32_t silent_joint = -1;  // this drive stops answering and goes limp; -1: none
  double silent_from_s = 0;
  double camera_off_from_s = 0;  // exposures in [from, until) are lost, of either camera
  double camera_off_until_s = 0;
  double imu_off_from_s = 0;  // samples in [from, until) are lost
  double imu_off_until_s = 0;
  double pose_off_from_s = 0;  // the tracking camera's samples in [from, until) are lost
  double pose_off_until_s = 0;
  double lidar_off_from_s = 0;  // scans that begin in [from, until) are lost
  double lidar_off_until_s = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.integer("silent_joint", self.silent_joint, {-1, 11}, "drive that dies; -1: none");
    visit.real("silent_from_s", self.silent_from_s, {0.0, 1e6}, "when it dies");
    visit.real("camera_off_from_s", self.camera_off_from_s, {0.0, 1e6}, "camera lost from");
    visit.real("camera_off_until_s", self.camera_off_until_s, {0.0, 1e6}, "camera lost until");
    visit.real("imu_off_from_s", self.imu_off_from_s, {0.0, 1e6}, "IMU lost from");
    visit.real("imu_off_until_s", self.imu_off_until_s, {0.0, 1e6}, "IMU lost until");
    visit.real("pose_off_from_s", self.pose_off_from_s, {0.0, 1e6}, "tracking camera lost from");
    visit.real("pose_off_until_s", self.pose_off_until_s, {0.0, 1e6}, "tracking camera lost until");
    visit.real("lidar_off_from_s", self.lidar_off_from_s, {0.0, 1e6}, "scanner lost from");
    visit.real("lidar_off_until_s", self.lidar_off_until_s, {0.0, 1e6}, "scanner lost until");
  }
};

// How the robot is set down. Not in configuration files: the default is what every mission starts
// from, the rest serves tests and benches.
struct StartPose {
  std::array<double, robot::kJointsPerLeg> leg_rad{0.0, -1.4, 2.7};  // folded
  double drop_height_m = 0.0005;  // clearance between the lowest point of the robot and the ground
  bool trunk_fixed = false;       // bolted to a stand
};

// legged: the robot on its legs, behind CAN. fast: a body that follows velocities, without legs.
enum class PlantKind : std::uint8_t { kLegged = 0, kFast };
inline constexpr std::array<const char*, 2> kPlantNames{"legged", "fast"};

struct SimulatorConfig {
  PlantKind plant = PlantKind::kLegged;
  PhysicsConfig physics;
  ImuNoiseConfig imu;
  DepthNoiseConfig depth;
  TrackingNoiseConfig tracking;
  StereoImageConfig stereo;  // where the robot has a stereo camera
  LidarNoiseConfig lidar;    // where the robot has a scanner
  CanConfig can;
  FaultConfig faults;
  StartPose start;
  ScenarioConfig scenario;  // described apart: the mission's file gives it

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("plant", self.plant, kPlantNames, "what moves: legs or a body without");
    visit.group("physics", self.physics);
    visit.group("imu", self.imu);
    visit.group("depth", self.depth);
    visit.group("tracking", self.tracking);
    visit.optional("stereo", self.stereo);
    visit.optional("lidar", self.lidar);
    visit.group("can", self.can);
    visit.group("faults", self.faults);
  }
};

}  // namespace surefoot::sim
