// What a robot is: geometry, masses, motors, wiring and sensor mounts. Plain data, filled from the
// robot's YAML file (config/robots), constant during a run.
//
// Frames (docs/frames_and_units.md): B has its origin at the centre of the trunk's four abduction
// joints, x forward, y left, z up. Legs are numbered FR, FL, HR, HL = 0..3, joints abad, hip, knee
// = 0..2. All joint angles are zero with the legs straight down. Abduction turns about +x of B, hip
// and knee about -y (a positive hip angle swings the foot forward). Link data, joint stops and
// poses are given for the FRONT LEFT leg; a right leg mirrors y and, where the hind knees point
// forward, a hind leg mirrors x.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/parameters.h"

namespace surefoot::robot {

inline constexpr std::size_t kLegs = 4;
inline constexpr std::size_t kJointsPerLeg = 3;
inline constexpr std::size_t kJoints = kLegs * kJointsPerLeg;

enum Leg : std::uint8_t { kFrontRight = 0, kFrontLeft = 1, kHindRight = 2, kHindLeft = 3 };

constexpr bool is_front(std::size_t leg) { return leg < 2; }
constexpr bool is_left(std::size_t leg) { return leg % 2 == 1; }
constexpr double front_sign(std::size_t leg) { return is_front(leg) ? 1.0 : -1.0; }
constexpr double left_sign(std::size_t leg) { return is_left(leg) ? 1.0 : -1.0; }
constexpr std::size_t joint_index(std::size_t leg, std::size_t joint) {
  return leg * kJointsPerLeg + joint;
}

// A rigid link. Inertia about the centre of mass, axes of the link frame (parallel to B when all
// joint angles are zero): xx, yy, zz, xy, xz, yz.
struct Link {
  double mass_kg = 0;
  std::array<double, 3> centre_of_mass_m{};  // from the link's joint
  std::array<double, 6> inertia_kg_m2{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("mass_kg", self.mass_kg, {0.001, 200.0}, "mass");
    visit.reals("centre_of_mass_m", self.centre_of_mass_m, {-1.0, 1.0}, "from the link's joint");
    visit.reals("inertia_kg_m2", self.inertia_kg_m2, {-50.0, 50.0}, "xx, yy, zz, xy, xz, yz");
  }
};

// A motor with its gear, seen at the joint.
struct Actuator {
  double gear_ratio = 1;           // rotor turns per joint turn
  double rotor_inertia_kg_m2 = 0;  // about the spin axis, before the gear
  double rotor_mass_kg = 0;
  double torque_limit_Nm = 0;        // at the joint
  double no_load_speed_rad_s = 0;    // at the joint, full bus voltage
  double stall_torque_Nm = 0;        // where the torque-speed line meets zero speed
  double viscous_friction_Nm_s = 0;  // at the joint
  double dry_friction_Nm = 0;        // at the joint
  double min_rad = 0;                // mechanical stops
  double max_rad = 0;

  double reflected_inertia_kg_m2() const { return gear_ratio * gear_ratio * rotor_inertia_kg_m2; }

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("gear_ratio", self.gear_ratio, {0.1, 500.0}, "rotor turns per joint turn");
    visit.real("rotor_inertia_kg_m2", self.rotor_inertia_kg_m2, {0.0, 1.0}, "about the spin axis");
    visit.real("rotor_mass_kg", self.rotor_mass_kg, {0.0, 20.0}, "rotor mass");
    visit.real("torque_limit_Nm", self.torque_limit_Nm, {0.01, 2000.0}, "at the joint");
    visit.real("no_load_speed_rad_s", self.no_load_speed_rad_s, {0.1, 200.0}, "at the joint");
    visit.real("stall_torque_Nm", self.stall_torque_Nm, {0.01, 5000.0}, "of the torque-speed line");
    visit.real("viscous_friction_Nm_s", self.viscous_friction_Nm_s, {0.0, 100.0}, "at the joint");
    visit.real("dry_friction_Nm", self.dry_friction_Nm, {0.0, 100.0}, "at the joint");
    visit.real("min_rad", self.min_rad, {-12.6, 12.6}, "lower mechanical stop");
    visit.real("max_rad", self.max_rad, {-12.6, 12.6}, "upper mechanical stop");
  }
};

// How a joint's drive is reached and what its wire fields mean (core/actuation).
// Angle on the wire = direction * belt_ratio * joint angle + offset_rad.
struct JointWiring {
  std::uint8_t bus = 0;
  std::uint16_t can_id = 0;         // commands go to this id; replies name it in byte 0
  double direction = 1;             // +1 or -1
  double belt_ratio = 1;            // drive-output turns per joint turn
  double offset_rad = 0;            // at the drive output
  double position_range_rad = 0;    // wire range is +- this
  double velocity_range_rad_s = 0;  // wire range is +- this
  double kp_max_Nm_rad = 0;         // wire range is 0 .. this
  double kd_max_Nm_s_rad = 0;       // wire range is 0 .. this
  double torque_range_Nm = 0;       // wire range is +- this

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.integer("bus", self.bus, {0, 3}, "CAN bus index");
    visit.integer("can_id", self.can_id, {1, 255}, "drive id");
    visit.real("direction", self.direction, {-1.0, 1.0}, "+1 or -1");
    visit.real("belt_ratio", self.belt_ratio, {0.05, 20.0}, "drive-output turns per joint turn");
    visit.real("offset_rad", self.offset_rad, {-12.6, 12.6}, "at the drive output");
    visit.real("position_range_rad", self.position_range_rad, {1.0, 200.0}, "+- on the wire");
    visit.real("velocity_range_rad_s", self.velocity_range_rad_s, {1.0, 200.0}, "+- on the wire");
    visit.real("kp_max_Nm_rad", self.kp_max_Nm_rad, {1.0, 10000.0}, "0 .. this on the wire");
    visit.real("kd_max_Nm_s_rad", self.kd_max_Nm_s_rad, {0.1, 500.0}, "0 .. this on the wire");
    visit.real("torque_range_Nm", self.torque_range_Nm, {0.1, 2000.0}, "+- on the wire");
  }
};

// A sensor's place on the trunk: p_BX and R_BX = Rz(yaw) Ry(pitch) Rx(roll). For cameras X is the
// housing (x forward, y left, z up); the optical frame follows from it (docs/frames_and_units.md).
struct SensorMount {
  std::array<double, 3> position_B_m{};
  std::array<double, 3> roll_pitch_yaw_rad{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.reals("position_B_m", self.position_B_m, {-2.0, 2.0}, "from the trunk's origin");
    visit.reals("roll_pitch_yaw_rad", self.roll_pitch_yaw_rad, {-6.3, 6.3}, "Rz Ry Rx");
  }
};

struct ImuSpecification {
  SensorMount mount;
  double rate_Hz = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("mount", self.mount);
    visit.real("rate_Hz", self.rate_Hz, {50.0, 8000.0}, "samples per second");
  }
};

struct DepthCameraSpecification {
  SensorMount mount;
  std::uint16_t width_px = 0;
  std::uint16_t height_px = 0;
  double horizontal_view_rad = 0;
  double vertical_view_rad = 0;
  double rate_Hz = 0;
  double min_range_m = 0;
  double max_range_m = 0;
  double disparity_noise_px = 0;  // one sigma; depth noise = z^2 * this / (focal_px * baseline)
  double baseline_m = 0;
  double native_width_px = 0;  // image width at which the disparity noise is stated

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("mount", self.mount);
    visit.integer("width_px", self.width_px, {16, 640}, "delivered image");
    visit.integer("height_px", self.height_px, {16, 480}, "delivered image");
    visit.real("horizontal_view_rad", self.horizontal_view_rad, {0.2, 2.8}, "full angle");
    visit.real("vertical_view_rad", self.vertical_view_rad, {0.2, 2.8}, "full angle");
    visit.real("rate_Hz", self.rate_Hz, {0.0, 120.0}, "frames per second; 0: no such camera");
    visit.real("min_range_m", self.min_range_m, {0.01, 2.0}, "nearest depth");
    visit.real("max_range_m", self.max_range_m, {0.2, 50.0}, "farthest depth");
    visit.real("disparity_noise_px", self.disparity_noise_px, {0.0, 2.0}, "one sigma");
    visit.real("baseline_m", self.baseline_m, {0.01, 1.0}, "of the stereo pair");
    visit.real("native_width_px", self.native_width_px, {16.0, 4096.0}, "of the disparity image");
  }
};

// Reports its own pose: the frame T is its housing.
struct TrackingCameraSpecification {
  SensorMount mount;
  double rate_Hz = 0;  // 0: the robot has none

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("mount", self.mount);
    visit.real("rate_Hz", self.rate_Hz, {0.0, 1000.0}, "samples per second; 0: no such camera");
  }
};

// One camera of a stereo pair as OpenCV calibrates it.
struct StereoLens {
  std::array<double, 9> matrix{};      // row by row: fx 0 cx, 0 fy cy, 0 0 1 [px]
  std::array<double, 8> distortion{};  // k1 k2 p1 p2 k3 k4 k5 k6
};

// What OpenCV's stereo calibration says of a pair; the keys are those of its files.
struct StereoCameraCalibration {
  std::uint16_t width_px = 0;  // of both pictures
  std::uint16_t height_px = 0;
  StereoLens left;
  StereoLens right;
  std::array<double, 9> R_EV{};    // turns the left camera's axes into the right one's, row by row
  std::array<double, 3> p_EV_m{};  // the left camera from the right one

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.integer("image_width", self.width_px, {16, 1024}, "pixels");
    visit.integer("image_height", self.height_px, {16, 768}, "pixels");
    visit.reals("camera_matrix_left", self.left.matrix, {-1e5, 1e5}, "row by row");
    visit.reals("distortion_coefficients_left", self.left.distortion, {-999.0, 999.0},
                "k1 k2 p1 p2 k3 k4 k5 k6");
    visit.reals("camera_matrix_right", self.right.matrix, {-1e5, 1e5}, "row by row");
    visit.reals("distortion_coefficients_right", self.right.distortion, {-999.0, 999.0},
                "k1 k2 p1 p2 k3 k4 k5 k6");
    visit.reals("R", self.R_EV, {-1.0001, 1.0001}, "from the left to the right camera's axes");
    visit.reals("T", self.p_EV_m, {-10.0, 10.0}, "metres, the left camera from the right one");
  }
};

// Two grey cameras that are exposed together, on demand.
struct StereoCameraSpecification {
  bool present = false;
  SensorMount mount;  // of the left camera
  double min_range_m = 0;
  double max_range_m = 0;
  StereoCameraCalibration calibration;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("mount", self.mount);
    visit.real("min_range_m", self.min_range_m, {0.01, 2.0}, "nearest distance along the axis");
    visit.real("max_range_m", self.max_range_m, {0.2, 50.0}, "farthest distance along the axis");
    visit.group("calibration", self.calibration);
  }
};

// A planar laser scanner: beams in the x-y plane of its housing L, counter-clockwise.
struct LidarSpecification {
  SensorMount mount;
  std::uint16_t beams = 0;
  double view_rad = 0;  // from the first beam to the last, symmetric about x
  double rate_Hz = 0;   // 0: the robot has none
  double min_range_m = 0;
  double max_range_m = 0;
  double range_noise_m = 0;        // one sigma
  double beam_divergence_rad = 0;  // full angle: what makes mixed pixels

  double angle_step_rad() const { return beams < 2 ? 0.0 : view_rad / (beams - 1); }

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("mount", self.mount);
    visit.integer("beams", self.beams, {2, 1081}, "of one scan");
    visit.real("view_rad", self.view_rad, {0.1, 6.2}, "from the first beam to the last");
    visit.real("rate_Hz", self.rate_Hz, {0.0, 100.0}, "scans per second; 0: no scanner");
    visit.real("min_range_m", self.min_range_m, {0.01, 5.0}, "nearest return");
    visit.real("max_range_m", self.max_range_m, {1.0, 200.0}, "farthest return");
    visit.real("range_noise_m", self.range_noise_m, {0.0, 0.5}, "one sigma");
    visit.real("beam_divergence_rad", self.beam_divergence_rad, {0.0, 0.1}, "full angle");
  }
};

struct JointRange {
  double min_rad = 0;
  double max_rad = 0;
};

struct RobotModel {
  Link trunk;
  std::array<double, 3> trunk_size_m{};  // box around the trunk, for contact and self filtering
  double abad_x_m = 0;                   // abduction joint from B, per side: (+-x, +-y, 0)
  double abad_y_m = 0;
  double hip_offset_m = 0;    // abduction joint to hip joint, outwards (y)
  double thigh_length_m = 0;  // hip to knee
  double knee_offset_m = 0;   // hip to knee, outwards (y)
  double shank_length_m = 0;  // knee to centre of the foot sphere
  double foot_radius_m = 0;
  bool hind_knees_forward = false;
  double thigh_radius_m = 0;  // capsules around the links, for contact and self filtering
  double shank_radius_m = 0;
  Link abad;  // joint frames: abduction, hip, knee
  Link thigh;
  Link shank;
  std::array<Actuator, kJointsPerLeg> actuators;
  std::array<JointWiring, kJoints> wiring;
  double drive_timeout_s = 0;  // drives go limp after this long without a command
  ImuSpecification imu;
  DepthCameraSpecification depth_camera;
  TrackingCameraSpecification tracking_camera;
  StereoCameraSpecification stereo_camera;
  LidarSpecification lidar;

  double total_mass_kg() const {
    double rotors = 0;
    for (const Actuator& actuator : actuators) rotors += actuator.rotor_mass_kg;
    return trunk.mass_kg + 4.0 * (abad.mass_kg + thigh.mass_kg + shank.mass_kg + rotors);
  }

  // +1: the leg is as the front ones along x, -1: mirrored. So is the sense of hip and knee: a knee
  // is bent where its angle times this is positive.
  double bend_sign(std::size_t leg) const {
    return hind_knees_forward && !is_front(leg) ? -1.0 : 1.0;
  }
  // Joint angles stated for the front left leg, for this one.
  std::array<double, kJointsPerLeg> pose_of(std::size_t leg,
                                            const std::array<double, kJointsPerLeg>& pose) const {
    return {left_sign(leg) * pose[0], bend_sign(leg) * pose[1], bend_sign(leg) * pose[2]};
  }
  // A link stated for the front left leg, for this one.
  Link link_of(std::size_t leg, const Link& link) const {
    const double x = bend_sign(leg);
    const double y = left_sign(leg);
    const auto& c = link.centre_of_mass_m;
    const auto& i = link.inertia_kg_m2;
    return {link.mass_kg,
            {x * c[0], y * c[1], c[2]},
            {i[0], i[1], i[2], x * y * i[3], x * i[4], y * i[5]}};
  }
  // Between the mechanical stops.
  JointRange joint_range(std::size_t joint) const {
    const Actuator& a = actuators[joint % kJointsPerLeg];
    const bool turned = joint % kJointsPerLeg != 0 && bend_sign(joint / kJointsPerLeg) < 0;
    return turned ? JointRange{-a.max_rad, -a.min_rad} : JointRange{a.min_rad, a.max_rad};
  }

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("trunk", self.trunk);
    visit.reals("trunk_size_m", self.trunk_size_m, {0.01, 3.0}, "length, width, height");
    visit.real("abad_x_m", self.abad_x_m, {0.01, 2.0}, "abduction joint from B, forward");
    visit.real("abad_y_m", self.abad_y_m, {0.001, 1.0}, "abduction joint from B, outwards");
    visit.real("hip_offset_m", self.hip_offset_m, {0.0, 0.5}, "abduction to hip, outwards");
    visit.real("thigh_length_m", self.thigh_length_m, {0.02, 1.0}, "hip to knee");
    visit.real("knee_offset_m", self.knee_offset_m, {-0.2, 0.2}, "hip to knee, outwards");
    visit.real("shank_length_m", self.shank_length_m, {0.02, 1.0}, "knee to foot centre");
    visit.real("foot_radius_m", self.foot_radius_m, {0.001, 0.1}, "foot sphere");
    visit.boolean("hind_knees_forward", self.hind_knees_forward, "hind legs mirror the front ones");
    visit.real("thigh_radius_m", self.thigh_radius_m, {0.001, 0.2}, "capsule");
    visit.real("shank_radius_m", self.shank_radius_m, {0.001, 0.2}, "capsule");
    visit.group("abad", self.abad);
    visit.group("thigh", self.thigh);
    visit.group("shank", self.shank);
    visit.groups("actuators", self.actuators);
    visit.groups("wiring", self.wiring);
    visit.real("drive_timeout_s", self.drive_timeout_s, {0.001, 1.0}, "of the drive firmware");
    visit.group("imu", self.imu);
    visit.group("depth_camera", self.depth_camera);
    visit.group("tracking_camera", self.tracking_camera);
    visit.group("lidar", self.lidar);
    visit.optional("stereo_camera", self.stereo_camera);
  }
};

}  // namespace surefoot::robot
