// The one aggregate: all state of the robot's mind, statically allocated, driven by the executive
// through its tasks. `control` runs every tick; `mapping` and `stereo` are slow and published
// kMapLatencyTicks and kStereoLatencyTicks later.
//
// Memory: sizeof(Autonomy), printed per module by `surefoot info`. Nothing allocates. Not copyable
// in practice: make it a static object of the program.
#pragma once

#include "core/actuation/joint_bus.h"
#include "core/autonomy/config.h"
#include "core/autonomy/jump_pilot.h"
#include "core/autonomy/localisation_task.h"
#include "core/autonomy/map_task.h"
#include "core/autonomy/mission.h"
#include "core/autonomy/mpc_task.h"
#include "core/autonomy/object_task.h"
#include "core/autonomy/own_gaits.h"
#include "core/autonomy/pose_history.h"
#include "core/autonomy/stereo_task.h"
#include "core/autonomy/terrain_task.h"
#include "core/autonomy/tick.h"
#include "core/control/locomotion.h"
#include "core/control/recovery.h"
#include "core/control/stand_up.h"
#include "core/control/static_walk.h"
#include "core/estimation/estimator.h"
#include "core/navigation/navigator.h"
#include "core/obstacles/avoidance.h"

namespace surefoot::autonomy {

inline constexpr TimeNs kTickPeriod = milliseconds(2);
inline constexpr std::uint32_t kMapLatencyTicks =
    5;  // 10 ms from a frame's arrival to its footholds

inline constexpr std::uint32_t kTerrainLatencyTicks = 1;  // of a slice

inline constexpr std::uint32_t kObjectsLatencyTicks = 5;        // 10 ms from a scan to its objects
inline constexpr std::uint32_t kPlanningPeriodTicks = 500;      // a plan a second
inline constexpr std::uint32_t kPlanningLatencyTicks = 50;      // 100 ms to make it
inline constexpr std::uint32_t kStereoLatencyTicks = 60;        // 120 ms to match a pair
inline constexpr std::uint32_t kLocalisationLatencyTicks = 20;  // 40 ms to register a picture

class Autonomy {
 public:
  // Touches every page of the object. kInvalid, kOutOfRange: a module refused its configuration.
  Status reset(const robot::RobotModel& model, const AutonomyConfig& config);

  // The control task: estimate, decide, command. Every tick.
  void begin_control(const TickInputs& inputs) { inputs_ = &inputs; }
  void run_control();
  void publish_control(TickOutputs& outputs) const { outputs = outputs_; }

  // The predictive controller's task.
  bool begin_mpc(const TickInputs& inputs);
  void run_mpc() { mpc_.run(); }
  void publish_mpc() { mpc_.publish(); }

  // The stereo task: what it publishes the localisation task, or else the mapping task, takes in
  // the same tick. Publishing moves the estimate where the camera is an odometer.
  bool begin_stereo(const TickInputs& inputs);
  void run_stereo() { stereo_.run(); }
  void publish_stereo();

  // The localisation task: likewise for the mapping task. Publishing moves the estimate.
  bool begin_localisation(const TickInputs& inputs);
  void run_localisation() { localisation_.run(); }
  void publish_localisation();

  // The mapping task.
  bool begin_mapping(const TickInputs& inputs);
  void run_mapping() { map_.run(); }
  void publish_mapping() { map_.publish(); }

  // The terrain task: a slice of it. What the mapping task publishes it takes in the same tick.
  bool begin_terrain(const TickInputs& inputs);
  void run_terrain() { terrain_.run(); }
  void publish_terrain() { terrain_.publish(); }

  // The objects task: after the mapping task, whose window it takes in the same tick.
  bool begin_objects(const TickInputs& inputs);
  void run_objects() { objects_.run(); }
  void publish_objects() { objects_.publish(); }

  // The planning task of mission navigate, with the objects as they are published.
  bool begin_planning(const TickInputs& inputs);
  void run_planning() { navigator_.run(); }
  void publish_planning() { navigator_.publish(); }

  bool finished() const { return mission_.finished(); }
  const Mission& mission() const { return mission_; }
  const estimation::Estimator& estimator() const { return estimator_; }
  const MapTask& map() const { return map_; }
  const StereoTask& stereo() const { return stereo_; }
  const LocalisationTask& localisation() const { return localisation_; }
  const TerrainTask& terrain() const { return terrain_; }
  const ObjectTask& objects() const { return objects_; }
  const navigation::Navigator& navigator() const { return navigator_; }
  const control::StaticWalk& static_walk() const { return static_walk_; }
  const actuation::JointBus& joint_bus() const { return bus_; }

 private:
  void receive();
  void receive_poses();
  double height_over_ground_m(const estimation::RobotState& state) const;
  StopReason find_fault();
  void act(const estimation::RobotState& state);
  bool locomotion_acts() const;
  bool walks_statically() const { return config_.control.static_walk.enabled; }
  bool at_rest() const;
  double blocked_s() const;
  const std::array<control::LegStatus, robot::kLegs>& legs() const;
  control::WalkCommand walk_command(const estimation::RobotState& state);
  control::VelocityCommand avoiding(const estimation::RobotState& state);
  void walk(const estimation::RobotState& state);
  std::array<estimation::GaitPhase, robot::kLegs> gait_phases() const;
  void begin_walking(const estimation::RobotState& state);
  void recover(const estimation::RobotState& state);
  void start_stand_up();
  bool must_recover(const estimation::RobotState& state) const;
  bool is_tilted(const estimation::RobotState& state) const;
  bool has_fallen(const estimation::RobotState& state);
  void note_footing(const estimation::RobotState& state);
  const mapping::MapWindow* window() const;
  void send();
  void watch(const estimation::RobotState& state);
  void report(const estimation::RobotState& state);
  void report_obstacles(const estimation::RobotState& state);
  void report_legs(const estimation::RobotState& state);
  void report_jump();
  void report_stereo();
  void report_localisation();
  void report_terrain();
  void report_navigation();
  Status reset_navigation();
  void follow_slope(const estimation::RobotState& state);
  void navigate(const estimation::RobotState& state);
  StopReason navigation_fault() const;
  void level_on_pad();
  struct Sight {
    const hal::DepthFrame* frame = nullptr;
    const mapping::DepthNoise* noise = nullptr;  // null: the sensor's
  };
  Sight take_sight(const TickInputs& inputs);

  robot::RobotModel model_;
  AutonomyConfig config_;
  const TickInputs* inputs_ = nullptr;  // of the tick under way
  TickOutputs outputs_;

  actuation::JointBus bus_;
  OwnGaits own_gaits_;
  estimation::Estimator estimator_;
  PoseHistory history_;
  MapTask map_;
  StereoTask stereo_;
  LocalisationTask localisation_;
  TerrainTask terrain_;
  StereoTrigger trigger_;
  Mission mission_;
  control::StandUp stand_up_;
  control::Recovery recovery_;
  control::Locomotion locomotion_;  // one of these two walks, as the robot's file says
  control::StaticWalk static_walk_;
  JumpPilot jump_pilot_;
  MpcTask mpc_;
  ObjectTask objects_;
  navigation::Navigator navigator_;
  bool navigates_ = false;
  control::VelocityCommand navigation_command_;
  Vector2 slope_ = Vector2::Zero();  // of the ground under the trunk: dz/dx, dz/dy in O
  double blind_s_ = 0;               // since the last scan
  obstacles::Avoidance avoidance_;
  control::VelocityCommand velocity_;  // what locomotion was told last
  bool changed_side_ = false;          // for the present standstill
  actuation::JointCommands commands_;
  bool walking_ready_ = false;  // stand-up is over, O has its place
  bool has_stood_ = false;      // O's origin is where it stood up first
  bool on_pad_ = false;         // it has not left the place where it stood up first
  // Ground below the trunk where it last stood upright on its feet: where it gets up again.
  Vector3 footing_O_m_ = Vector3::Zero();
  double collapsed_s_ = 0;
  double imu_silent_s_ = 0;
  double tick_s_ = 0;
  std::uint64_t imu_refused_ = 0;
  std::uint64_t encode_refused_ = 0;
};

}  // namespace surefoot::autonomy
