// The autonomy's parameters: one group per module, keys as in the robot and mission files.
#pragma once

#include "core/actuation/joint_bus.h"
#include "core/autonomy/camera_motion_config.h"
#include "core/autonomy/jump_pilot_config.h"
#include "core/autonomy/localisation_config.h"
#include "core/autonomy/navigation_config.h"
#include "core/autonomy/stereo_config.h"
#include "core/autonomy/terrain_config.h"
#include "core/base/fixed_vector.h"
#include "core/base/parameters.h"
#include "core/control/config.h"
#include "core/estimation/config.h"
#include "core/mapping/mapping_config.h"
#include "core/motions/jump_config.h"
#include "core/motions/motion.h"
#include "core/obstacles/config.h"

namespace surefoot::autonomy {

// What is limp, tilted or silent too long ends a mission with a reason instead of a broken robot.
struct SafetyConfig {
  double max_tilt_rad = 0;         // beyond: drives go to damping
  double drive_silence_s = 0;      // no reply of a drive
  double imu_silence_s = 0;        // no sample
  double foothold_patience_s = 0;  // no foothold for a leg

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("max_tilt_rad", self.max_tilt_rad, {0.1, 3.2}, "beyond: damping");
    visit.real("drive_silence_s", self.drive_silence_s, {0.002, 5.0}, "no reply of a drive");
    visit.real("imu_silence_s", self.imu_silence_s, {0.002, 5.0}, "no sample");
    visit.real("foothold_patience_s", self.foothold_patience_s, {0.1, 60.0},
               "no foothold for a leg");
  }
};

// The ground the robot stands on when it is switched on: it cannot see it, so the operator vouches
// for a level pad around the feet (docs/running.md). Any measurement overrides it.
struct StartPadConfig {
  double length_m = 0;
  double width_m = 0;
  double level_gain_1_s = 0;  // pull of the feet's plane on attitude and accelerometer bias

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("length_m", self.length_m, {0.0, 4.0}, "along the robot, centred on it");
    visit.real("width_m", self.width_m, {0.0, 4.0}, "across");
    visit.real("level_gain_1_s", self.level_gain_1_s, {0.0, 50.0},
               "while it first stands, the feet level the IMU; 0: not");
  }
};

// One line of a scripted mission: a velocity command held for a while.
struct ScriptStep {
  double duration_s = 0;
  control::GaitKind gait = control::GaitKind::kTrot;
  double forward_m_s = 0;
  double left_m_s = 0;
  double yaw_rate_rad_s = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("duration_s", self.duration_s, {0.0, 3600.0}, "how long");
    visit.choice("gait", self.gait, control::kGaitNames, "how the legs move");
    visit.real("forward_m_s", self.forward_m_s, {-4.0, 4.0}, "commanded");
    visit.real("left_m_s", self.left_m_s, {-2.0, 2.0}, "commanded");
    visit.real("yaw_rate_rad_s", self.yaw_rate_rad_s, {-5.0, 5.0}, "commanded");
  }
};

inline constexpr std::size_t kMaxScriptSteps = 24;

// A place to go to in a straight line from the one before, in O.
struct Waypoint {
  double x_m = 0;
  double y_m = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("x_m", self.x_m, {-1000.0, 1000.0}, "ahead of the start");
    visit.real("y_m", self.y_m, {-1000.0, 1000.0}, "to its left");
  }
};

inline constexpr std::size_t kMaxWaypoints = 16;

struct MissionConfig {
  enum class Kind : std::uint8_t { kStand = 0, kCross, kScript, kNavigate };
  static constexpr const char* kKindNames[] = {"stand", "cross", "script", "navigate"};

  Kind kind = Kind::kStand;
  control::GaitKind gait = control::GaitKind::kTrot;  // cross: how the legs move
  double goal_x_m = 0;          // ahead of the start, along its heading; see waypoints
  double goal_tolerance_m = 0;  // by the robot's own estimate
  double speed_m_s = 0;
  double line_gain_1_s = 0;  // back to the line from start to goal
  double heading_gain_1_s = 0;
  double max_lateral_m_s = 0;
  double max_yaw_rate_rad_s = 0;
  double rest_s = 0;           // lying still before standing up: the gyro's bias is learned
  double settle_s = 0;         // standing still before the first step
  double stand_s = 0;          // mission stand: how long
  double timeout_s = 0;        // of the whole mission
  bool unseen_ground = false;  // the operator vouches for ground that the robot has not seen
  bool jump = false;           // over what cannot be walked over, where a motion reaches
  bool recover = false;        // after a fall, and from any pose at the start: get up and go on
  bool avoid = false;          // goes round what it cannot step over (core/obstacles)
  double blocked_rise_m = 0;   // avoid: what rises by more; 0: what it cannot step over
  double live_lock_s = 0;  // without getting nearer to the goal for so long it gives up; 0: never
  FixedVector<Waypoint, kMaxWaypoints> waypoints;   // cross: instead of goal_x_m, in this order
  FixedVector<ScriptStep, kMaxScriptSteps> script;  // mission script: one after the other

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("kind", self.kind, kKindNames, "what to do");
    visit.choice("gait", self.gait, control::kGaitNames, "cross: how the legs move");
    visit.real("goal_x_m", self.goal_x_m, {0.0, 1000.0}, "ahead of the start; 0: the world's");
    visit.real("goal_tolerance_m", self.goal_tolerance_m, {0.001, 10.0}, "by own estimate");
    visit.real("speed_m_s", self.speed_m_s, {0.0, 4.0}, "commanded");
    visit.real("line_gain_1_s", self.line_gain_1_s, {0.0, 10.0}, "back to the line");
    visit.real("heading_gain_1_s", self.heading_gain_1_s, {0.0, 10.0}, "along the line");
    visit.real("max_lateral_m_s", self.max_lateral_m_s, {0.0, 2.0}, "sideways");
    visit.real("max_yaw_rate_rad_s", self.max_yaw_rate_rad_s, {0.0, 5.0}, "turning");
    visit.real("rest_s", self.rest_s, {0.0, 60.0}, "lying still before standing up");
    visit.real("settle_s", self.settle_s, {0.1, 60.0}, "standing still before the first step");
    visit.real("stand_s", self.stand_s, {0.0, 3600.0}, "mission stand: how long");
    visit.real("timeout_s", self.timeout_s, {1.0, 36000.0}, "of the whole mission");
    visit.boolean("unseen_ground", self.unseen_ground, "the operator vouches for unseen ground");
    visit.boolean("jump", self.jump, "over what cannot be walked over");
    visit.boolean("recover", self.recover, "get up after a fall and go on");
    visit.boolean("avoid", self.avoid, "go round what it cannot step over");
    visit.real("blocked_rise_m", self.blocked_rise_m, {0.0, 2.0},
               "avoid: what rises by more; 0: what it cannot step over");
    visit.real("live_lock_s", self.live_lock_s, {0.0, 3600.0},
               "not nearer to the goal for so long: give up; 0: never");
    visit.list("waypoints", self.waypoints);
    visit.list("script", self.script);
  }
};

struct AutonomyConfig {
  bool own_gaits = false;  // the body moves its own legs (hal::GaitPort); by the plant, not a key
  actuation::ActuationParameters actuation;
  estimation::EstimationConfig estimation;
  mapping::MappingConfig mapping;
  control::ControlConfig control;
  obstacles::ObstacleConfig obstacles;
  SafetyConfig safety;
  StartPadConfig start_pad;
  motions::JumpConfig jump;
  JumpPilotConfig jump_pilot;
  motions::MotionLibrary motions;      // none where the mission does not jump
  StereoConfig stereo;                 // where the robot has a stereo camera
  CameraMotionConfig visual_odometry;  // where that camera is an odometer too
  LocalisationConfig localisation;     // where pictures are registered with each other
  TerrainConfig terrain;               // where footsteps are planned on completed ground
  NavigationTaskConfig navigation;     // where the robot has a laser scanner
  MissionConfig mission;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("actuation", self.actuation);
    visit.group("estimation", self.estimation);
    visit.group("mapping", self.mapping);
    visit.group("control", self.control);
    visit.group("obstacles", self.obstacles);
    visit.group("safety", self.safety);
    visit.group("start_pad", self.start_pad);
    visit.group("jump", self.jump);
    visit.group("jump_pilot", self.jump_pilot);
    visit.list("motions", self.motions);
    visit.optional("stereo", self.stereo);
    visit.optional("visual_odometry", self.visual_odometry);
    visit.optional("localisation", self.localisation);
    visit.optional("terrain", self.terrain);
    visit.optional("navigation", self.navigation);
    visit.group("mission", self.mission);
  }
};

}  // namespace surefoot::autonomy
