// What enters and leaves the autonomy at a tick: the seam that is recorded, hashed and replayed.
#pragma once

#include <array>
#include <cstdint>

#include "core/autonomy/camera_motion_counters.h"
#include "core/autonomy/jump_pilot.h"
#include "core/autonomy/localisation_counters.h"
#include "core/autonomy/object_task_counters.h"
#include "core/autonomy/terrain_counters.h"
#include "core/base/fields.h"
#include "core/base/fixed_vector.h"
#include "core/base/time.h"
#include "core/control/foothold_reason.h"
#include "core/estimation/odometry_fusion.h"
#include "core/estimation/tracking.h"
#include "core/navigation/status.h"
#include "core/obstacles/field_pool.h"
#include "core/robot/robot_model.h"
#include "hal/api/can_port.h"
#include "hal/api/depth_camera_port.h"
#include "hal/api/gait_port.h"
#include "hal/api/imu_port.h"
#include "hal/api/lidar_port.h"
#include "hal/api/operator_port.h"
#include "hal/api/pose_port.h"
#include "hal/api/stereo_camera_port.h"

namespace surefoot::autonomy {

inline constexpr std::size_t kMaxCanFramesPerTick = 64;
inline constexpr std::size_t kMaxImuSamplesPerTick = 16;
inline constexpr std::size_t kMaxPoseSamplesPerTick = 8;
inline constexpr std::size_t kMaxGaitSamplesPerTick = 8;
inline constexpr std::size_t kMaxSlowTasks = 8;

// Everything a tick may depend on, latched once by the executive. Depth frames, stereo pairs and
// laser scans are large and rare: they are kept beside this struct and recorded on channels of
// their own, just before the tick.
struct TickInputs {
  std::uint64_t tick = 0;
  TimeNs stamp;       // logical time of the tick
  bool late = false;  // the tick began after its deadline
  FixedVector<hal::CanFrame, kMaxCanFramesPerTick> can;
  FixedVector<hal::ImuSample, kMaxImuSamplesPerTick> imu;
  FixedVector<hal::PoseSample, kMaxPoseSamplesPerTick> pose;
  FixedVector<hal::GaitSample, kMaxGaitSamplesPerTick> gait;  // where the body has gaits of its own
  bool operator_fresh = false;
  hal::OperatorCommand operator_command;  // meaningful where operator_fresh
  bool depth_fresh = false;
  const hal::DepthFrame* depth = nullptr;  // valid during the tick where depth_fresh; not a field
  bool stereo_fresh = false;
  const hal::StereoFrame* stereo = nullptr;  // likewise, where stereo_fresh
  bool lidar_fresh = false;
  const hal::LidarScan* lidar = nullptr;  // likewise, where lidar_fresh
  // Bit i: slow task i of the table was due at this tick but had not finished (an overrun). Its
  // result stays back until the first tick where the bit is clear.
  std::uint32_t slow_task_overruns = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("tick", self.tick);
    visit("stamp_ns", self.stamp);
    visit("late", self.late);
    visit("can", self.can);
    visit("imu", self.imu);
    visit("pose", self.pose);
    visit("gait", self.gait);
    visit("operator_fresh", self.operator_fresh);
    if (self.operator_fresh) visit("operator_command", self.operator_command);
    visit("depth_fresh", self.depth_fresh);
    visit("stereo_fresh", self.stereo_fresh);
    visit("lidar_fresh", self.lidar_fresh);
    visit("slow_task_overruns", self.slow_task_overruns);
  }
};

enum class MissionPhase : std::uint8_t {
  kEnableDrives = 0,
  kRecover,  // from any resting pose to the belly, legs folded
  kStandUp,
  kSettle,  // stand still: gyro bias, first map
  kWalk,
  kArrived,  // standing at the goal
  kStopped,  // ended short of the goal; `stop_reason` says why
};

enum class StopReason : std::uint8_t {
  kNone = 0,
  kNoFoothold,   // no cell within reach can bear a foot, for longer than the patience
  kDriveSilent,  // a joint's replies stopped
  kTilt,         // attitude beyond recovery
  kImuSilent,
  kOperator,  // emergency stop
  kMissionTimeout,
  kDriveFault,      // a drive reported an error code
  kRecoveryFailed,  // on the ground, and no roll has turned the robot over
  kLiveLock,        // walks, and gets no nearer to the goal
  kNoJump,          // an edge ahead that no jump takes, or not from here; telemetry says why
  kNoPath,          // navigation: no way to the goal is left open
};

// One leg, in the odometry frame O (docs/frames_and_units.md).
struct LegTelemetry {
  bool stance_planned = true;
  bool contact = false;               // estimated, from torques and gait phase
  std::array<double, 3> foot_O_m{};   // centre of the foot sphere
  std::array<double, 3> force_O_N{};  // commanded ground force on the robot
  std::array<double, 3> foothold_nominal_O_m{};
  std::array<double, 3> foothold_O_m{};
  control::FootholdReason foothold_reason = control::FootholdReason::kNominal;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("stance_planned", self.stance_planned);
    visit("contact", self.contact);
    visit("foot_O_m", self.foot_O_m);
    visit("force_O_N", self.force_O_N);
    visit("foothold_nominal_O_m", self.foothold_nominal_O_m);
    visit("foothold_O_m", self.foothold_O_m);
    visit("foothold_reason", self.foothold_reason);
  }
};

struct JointTelemetry {
  double position_rad = 0;
  double velocity_rad_s = 0;
  double torque_Nm = 0;  // measured by the drive
  double position_command_rad = 0;
  double torque_command_Nm = 0;  // feed-forward

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("position_rad", self.position_rad);
    visit("velocity_rad_s", self.velocity_rad_s);
    visit("torque_Nm", self.torque_Nm);
    visit("position_command_rad", self.position_command_rad);
    visit("torque_command_Nm", self.torque_command_Nm);
  }
};

// The tracking camera against the estimate.
struct TrackingTelemetry {
  std::array<double, 3> position_error_O_m{};
  double yaw_error_rad = 0;
  estimation::TrackingCounters samples;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("position_error_O_m", self.position_error_O_m);
    visit("yaw_error_rad", self.yaw_error_rad);
    visit("samples", self.samples);
  }
};

// What the robot goes round.
struct ObstacleTelemetry {
  FixedVector<std::array<double, 2>, obstacles::kMaxFields> fields_O_m;  // centres
  int side = 0;             // on which it passes what is ahead: +1 left, -1 right, 0 nothing is
  double free_space_m = 0;  // before the nearest field, at most their reach; 0: no fields
  obstacles::FieldCounters counters;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("fields_O_m", self.fields_O_m);
    visit("side", self.side);
    visit("free_space_m", self.free_space_m);
    visit("counters", self.counters);
  }
};

// What became of the stereo camera's pairs.
struct StereoTelemetry {
  std::uint64_t triggers = 0;
  std::uint64_t pairs_matched = 0;
  std::uint64_t pairs_refused = 0;   // another size than the calibration's
  std::uint64_t pairs_unusable = 0;  // too few disparities: nothing was mapped
  double valid_share = 0;            // of the last pair's pixels, with a disparity in range

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("triggers", self.triggers);
    visit("pairs_matched", self.pairs_matched);
    visit("pairs_refused", self.pairs_refused);
    visit("pairs_unusable", self.pairs_unusable);
    visit("valid_share", self.valid_share);
  }
};

// How far dead reckoning was off, by the pictures.
struct LocalisationTelemetry {
  LocalisationCounters counters;
  std::array<double, 3> shift_O_m{};  // by the picture published last
  double yaw_rad = 0;
  std::int32_t observed_directions = 0;
  double residual_m = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("counters", self.counters);
    visit("shift_O_m", self.shift_O_m);
    visit("yaw_rad", self.yaw_rad);
    visit("observed_directions", self.observed_directions);
    visit("residual_m", self.residual_m);
  }
};

// The ground that footsteps are planned on.
struct TerrainTelemetry {
  TerrainCounters counters;
  std::uint64_t map_digest = 0;  // hash of the published terrain map

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("counters", self.counters);
    visit("map_digest", self.map_digest);
  }
};

// What navigation makes of the objects around the robot.
struct NavigationTelemetry {
  navigation::NavigationState state = navigation::NavigationState::kIdle;
  navigation::NavigationReason reason = navigation::NavigationReason::kNoGoal;
  double rest_m = 0;      // of the way, when last planned
  double off_path_m = 0;  // robot to the left of the path
  double free_m = 0;      // of the way ahead
  std::uint32_t objects = 0;
  std::uint32_t path_points = 0;
  std::uint64_t objects_digest = 0;
  navigation::NavigationCounters plans;
  ObjectTaskCounters sight;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("state", self.state);
    visit("reason", self.reason);
    visit("rest_m", self.rest_m);
    visit("off_path_m", self.off_path_m);
    visit("free_m", self.free_m);
    visit("objects", self.objects);
    visit("path_points", self.path_points);
    visit("objects_digest", self.objects_digest);
    visit("plans", self.plans);
    visit("sight", self.sight);
  }
};

// The stereo camera as an odometer.
struct CameraMotionTelemetry {
  CameraMotionCounters pairs;
  estimation::FusionCounters motions;
  std::int32_t inliers = 0;  // of the newest pair

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("pairs", self.pairs);
    visit("motions", self.motions);
    visit("inliers", self.inliers);
  }
};

// The jump pilot: what it does, and the edge it looks at.
struct JumpTelemetry {
  PilotStage pilot = PilotStage::kWatch;
  motions::JumpStage stage = motions::JumpStage::kIdle;
  JumpCounters counters;
  double edge_m = 0;  // trunk's origin to the edge; 0 without one
  double heading_rad = 0;
  double rise_m = 0;
  double gap_m = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("pilot", self.pilot);
    visit("stage", self.stage);
    visit("counters", self.counters);
    visit("edge_m", self.edge_m);
    visit("heading_rad", self.heading_rad);
    visit("rise_m", self.rise_m);
    visit("gap_m", self.gap_m);
  }
};

// The visible state of the autonomy. Enough to draw a run; hashed and compared by replay.
struct Telemetry {
  MissionPhase phase = MissionPhase::kEnableDrives;
  StopReason stop_reason = StopReason::kNone;
  std::array<double, 3> p_OB_m{};
  std::array<double, 4> q_OB_wxyz{1, 0, 0, 0};
  std::array<double, 3> v_OB_m_s{};
  std::array<double, 3> angular_velocity_B_rad_s{};
  std::array<double, 3> velocity_command_B{};  // forward m/s, left m/s, yaw rad/s
  std::array<LegTelemetry, robot::kLegs> legs;
  std::array<JointTelemetry, robot::kJoints> joints;
  TrackingTelemetry tracking;
  ObstacleTelemetry obstacles;
  JumpTelemetry jump;
  StereoTelemetry stereo;
  CameraMotionTelemetry visual_odometry;
  LocalisationTelemetry localisation;
  TerrainTelemetry terrain;
  NavigationTelemetry navigation;
  std::uint64_t depth_frames_mapped = 0;
  std::uint64_t map_digest = 0;  // hash of the published map window
  std::uint64_t replies_missed = 0;
  std::uint64_t replies_invalid = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("phase", self.phase);
    visit("stop_reason", self.stop_reason);
    visit("p_OB_m", self.p_OB_m);
    visit("q_OB_wxyz", self.q_OB_wxyz);
    visit("v_OB_m_s", self.v_OB_m_s);
    visit("angular_velocity_B_rad_s", self.angular_velocity_B_rad_s);
    visit("velocity_command_B", self.velocity_command_B);
    visit("legs", self.legs);
    visit("joints", self.joints);
    visit("tracking", self.tracking);
    visit("obstacles", self.obstacles);
    visit("jump", self.jump);
    visit("stereo", self.stereo);
    visit("visual_odometry", self.visual_odometry);
    visit("localisation", self.localisation);
    visit("terrain", self.terrain);
    visit("navigation", self.navigation);
    visit("depth_frames_mapped", self.depth_frames_mapped);
    visit("map_digest", self.map_digest);
    visit("replies_missed", self.replies_missed);
    visit("replies_invalid", self.replies_invalid);
  }
};

struct TickOutputs {
  FixedVector<hal::CanFrame, kMaxCanFramesPerTick> can;
  hal::GaitCommand gait;        // for a body with gaits of its own
  bool stereo_trigger = false;  // asks the stereo camera for a pair
  Telemetry telemetry;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("can", self.can);
    visit("gait", self.gait);
    visit("stereo_trigger", self.stereo_trigger);
    visit("telemetry", self.telemetry);
  }
};

}  // namespace surefoot::autonomy
