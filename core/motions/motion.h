// A motion made off-line (surefoot-lab motion): what the trunk, the joints and the ground forces do
// at given times, and from where it may begin. Plain data of fixed size, filled from a file of
// config/motions; the checks of its meaning are check_motion().
//
// The motion is the same left and right: it lies in the robot's sagittal plane. Angles are those of
// robot_model.h. Origin: the ground below the trunk's origin when the motion begins, x forward.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/fixed_vector.h"
#include "core/base/parameters.h"
#include "core/base/status.h"
#include "core/robot/robot_model.h"

namespace surefoot::motions {

inline constexpr std::size_t kPlanarJoints = 4;  // front hip, front knee, hind hip, hind knee
inline constexpr std::size_t kMaxRows = 160;
inline constexpr std::size_t kMaxMotions = 4;
inline constexpr int kMotionVersion = 1;

constexpr std::size_t planar_joint(std::size_t leg, std::size_t joint) {
  return (robot::is_front(leg) ? 0 : 2) + joint - 1;
}
// The joint of a leg that a planar joint stands for: 1 hip, 2 knee.
constexpr std::size_t leg_joint(std::size_t planar) { return 1 + planar % 2; }

struct MotionRow {
  double time_s = 0;
  std::array<double, 3> trunk{};       // x [m], z [m], nose up [rad]
  std::array<double, 3> trunk_rate{};  // per second
  std::array<double, kPlanarJoints> joint_rad{};
  std::array<double, kPlanarJoints> joint_rad_s{};
  std::array<double, kPlanarJoints> torque_Nm{};  // of one joint of the pair
  std::array<double, 4> force_N{};  // ground on one foot of the pair: front x, z, hind x, z

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("time_s", self.time_s, {0.0, 10.0}, "since the motion began");
    visit.reals("trunk", self.trunk, {-5.0, 5.0}, "x m, z m, nose up rad");
    visit.reals("trunk_rate", self.trunk_rate, {-20.0, 20.0}, "per second");
    visit.reals("joint_rad", self.joint_rad, {-12.6, 12.6}, "front hip, knee, hind hip, knee");
    visit.reals("joint_rad_s", self.joint_rad_s, {-100.0, 100.0}, "their rates");
    visit.reals("torque_Nm", self.torque_Nm, {-500.0, 500.0}, "of one joint of the pair");
    visit.reals("force_N", self.force_N, {-2000.0, 2000.0}, "on one foot: front x, z, hind x, z");
  }
};

// The states that the motion may begin from. What lies outside is refused.
struct StartSet {
  double edge_min_m = 0;  // trunk's origin to the edge ahead
  double edge_max_m = 0;
  double rise_min_m = 0;  // of the ground to land on
  double rise_max_m = 0;
  double max_heading_rad = 0;  // between the robot and the edge's normal
  double max_tilt_rad = 0;
  double max_speed_m_s = 0;
  double max_rate_rad_s = 0;       // of the trunk
  double max_joint_error_rad = 0;  // to the first row

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("edge_min_m", self.edge_min_m, {0.0, 5.0}, "trunk to the edge ahead, at least");
    visit.real("edge_max_m", self.edge_max_m, {0.0, 5.0}, "at most");
    visit.real("rise_min_m", self.rise_min_m, {-1.0, 1.0}, "of the landing, at least");
    visit.real("rise_max_m", self.rise_max_m, {-1.0, 1.0}, "at most");
    visit.real("max_heading_rad", self.max_heading_rad, {0.0, 1.0}, "off the edge's normal");
    visit.real("max_tilt_rad", self.max_tilt_rad, {0.0, 1.0}, "of the trunk");
    visit.real("max_speed_m_s", self.max_speed_m_s, {0.0, 5.0}, "of the trunk");
    visit.real("max_rate_rad_s", self.max_rate_rad_s, {0.0, 20.0}, "of the trunk");
    visit.real("max_joint_error_rad", self.max_joint_error_rad, {0.0, 3.0}, "to the first row");
  }
};

struct Motion {
  enum class Kind : std::uint8_t { kPlatform = 0, kGap };
  static constexpr const char* kKindNames[] = {"platform", "gap"};

  int version = 0;
  Kind kind = Kind::kPlatform;
  double rise_m = 0;        // of the ground landed on
  double gap_m = 0;         // widest gap it crosses
  double edge_m = 0;        // trunk's origin to the edge, as planned
  double travel_m = 0;      // of the trunk's origin, to touchdown
  double front_lift_s = 0;  // the front feet leave the ground
  double hind_lift_s = 0;
  StartSet start;
  FixedVector<MotionRow, kMaxRows> rows;  // the last one is the touchdown

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.integer("version", self.version, {kMotionVersion, kMotionVersion}, "of this format");
    visit.choice("kind", self.kind, kKindNames, "what it is for");
    visit.real("rise_m", self.rise_m, {-1.0, 1.0}, "of the ground landed on");
    visit.real("gap_m", self.gap_m, {0.0, 5.0}, "widest gap it crosses");
    visit.real("edge_m", self.edge_m, {0.0, 5.0}, "trunk to the edge, as planned");
    visit.real("travel_m", self.travel_m, {0.0, 5.0}, "of the trunk, to touchdown");
    visit.real("front_lift_s", self.front_lift_s, {0.0, 10.0}, "front feet leave the ground");
    visit.real("hind_lift_s", self.hind_lift_s, {0.0, 10.0}, "hind feet leave the ground");
    visit.group("start", self.start);
    visit.list("rows", self.rows);
  }
};

using MotionLibrary = FixedVector<Motion, kMaxMotions>;

enum class MotionFault : std::uint8_t {
  kNone = 0,
  kTooShort,  // fewer than two rows
  kTimes,     // not in order, or the lift-offs not within
  kTorque,    // above an actuator's limit
  kSpeed,     // of a joint, above no-load speed
  kPower,     // torque and speed above the torque-speed line
  kStop,      // a joint beyond a mechanical stop
  kStartSet,  // an interval that is empty
};
inline constexpr const char* kMotionFaultNames[] = {"none",
                                                    "fewer than two rows",
                                                    "times out of order",
                                                    "torque above the actuator's limit",
                                                    "joint faster than the actuator",
                                                    "torque and speed above the actuator's line",
                                                    "joint beyond its stop",
                                                    "the start set is empty"};

struct MotionCheck {
  MotionFault fault = MotionFault::kNone;
  std::size_t row = 0;  // of the fault
};

// Whether this robot can do it: order of times, and every row within the actuators' limits.
MotionCheck check_motion(const Motion& motion, const robot::RobotModel& model);

// The motion at a time: angles by cubic Hermite interpolation, the rest linear; the last row after
// the end. rows.size() >= 2. `hint`: a row to begin the search at, updated; 0 to begin with.
MotionRow motion_at(const Motion& motion, double time_s, std::size_t& hint);

}  // namespace surefoot::motions
