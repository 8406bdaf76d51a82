// Walking with one leg in the air at a time and the centre of mass over the feet that stand
// (paper 001, section IV): for ground where every foot has to be placed.
//
// In: the estimator's RobotState, the published map window (or none), the filled terrain (or
// none), a velocity command.
// Out: twelve joint commands for this tick, and for each leg what it is about.
//
// Legs step in the order hind right, front right, hind left, front left. Each step:
//   shift  the centre of mass moves into the triangle of the feet that will stand and, where both
//          have room in common, into that of the next step, so that this one needs no shift
//   swing  the foot goes up, over and down to its foothold; then straight down until it feels
//          ground
// Footholds: with filled terrain the first step of a plan of four (planning/footsteps.h), made anew
// for every step; without it the nearest good cell (foothold.h).
// A foot that finds no ground goes back to where it came from and the step is planned anew, and so
// does one that hangs by its shank. When a standing foot slips, the one in the air comes down where
// it is; during a shift the trunk goes back over the middle of its feet:
//   retreat  and then the step is planned anew
// Without a foothold the robot stands and blocked_s() counts.
//
// Frames: O, metres, N. Memory: sizeof(StaticWalk) 106 kB, most of it the search for footsteps.
// Cost per tick: one whole-body solve, at most one foothold search or plan for each leg, none
// within 0.1 s of one in vain. No allocation.
#pragma once

#include <array>

#include "core/actuation/joint_bus.h"
#include "core/control/config.h"
#include "core/control/foothold.h"
#include "core/control/leg_status.h"
#include "core/control/load_sharing.h"
#include "core/control/map_offset.h"
#include "core/control/standing_feet.h"
#include "core/control/whole_body.h"
#include "core/estimation/contact.h"
#include "core/estimation/estimator.h"
#include "core/mapping/map_window.h"
#include "core/planning/footsteps.h"
#include "core/planning/stance.h"
#include "core/terrain/terrain_map.h"

namespace surefoot::control {

// Since reset().
struct StaticWalkCounters {
  std::uint64_t steps = 0;
  std::uint64_t missed = 0;       // no ground where it should be: the foot went back
  std::uint64_t narrow = 0;       // the margin had to be cut to find room over the feet
  std::uint64_t slipped = 0;      // a standing foot gave way during a shift or a swing
  std::uint64_t lowered = 0;      // a stance leg could not have reached: the trunk was lowered
  std::uint64_t tipped = 0;       // the trunk went over its feet: the one in the air came down
  std::uint64_t passed_over = 0;  // a leg had no foothold, and another stepped
  std::uint64_t retreated = 0;    // a foot lost its ground during a shift: back over all feet
  std::uint64_t waited = 0;       // the trunk did not come to where the foot may lift: planned anew

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("steps", self.steps);
    visit("missed", self.missed);
    visit("narrow", self.narrow);
    visit("slipped", self.slipped);
    visit("lowered", self.lowered);
    visit("tipped", self.tipped);
    visit("passed_over", self.passed_over);
    visit("waited", self.waited);
    visit("retreated", self.retreated);
  }
};

class StaticWalk {
 public:
  void reset(const ControlConfig& config, const robot::RobotModel& model);

  // All legs in stance at the present pose: call once when stand-up is done.
  void start(const estimation::RobotState& state);

  // walking: whether new steps may begin; a step under way is finished at any rate.
  // terrain: takes the window's place where it is given and was published. It needs no GroundRule:
  // footsteps never go to ground without a height.
  const actuation::JointCommands& update(const estimation::RobotState& state,
                                         const mapping::MapWindow* window,
                                         const terrain::TerrainMap* terrain,
                                         const VelocityCommand& velocity, bool walking,
                                         GroundRule ground, double step_s);

  const LegStatuses& legs() const { return legs_; }
  // What the contact estimator needs to know of the plan.
  std::array<estimation::GaitPhase, robot::kLegs> gait_phases() const {
    return control::gait_phases(legs_);
  }
  bool at_rest() const { return stage_ == Stage::kStand; }
  // In the tick at whose end the trunk has come to rest over its feet and a foot will lift off.
  bool shifted() const { return shifted_; }
  // How long there has been no foothold for the leg whose turn it is.
  double blocked_s() const { return blocked_s_; }
  const StaticWalkCounters& counters() const { return counters_; }

 private:
  enum class Stage : std::uint8_t { kStand = 0, kShift, kSwing, kRetreat };

  struct Motion {
    planning::TrunkPose pose;
    Vector3 v_O_m_s = Vector3::Zero();
    Vector3 a_O_m_s2 = Vector3::Zero();
    double yaw_rate_rad_s = 0;
  };

  // What the feet are set on.
  struct Ground {
    const mapping::MapWindow* window = nullptr;    // the terrain's where there is one
    const terrain::TerrainMap* terrain = nullptr;  // null: none
    GroundRule rule = GroundRule::kGood;           // of the window
  };

  std::size_t leg() const;  // whose turn it is
  void stand();
  void try_step(const estimation::RobotState& state, const Ground& ground, double step_s);
  bool begin_step(const estimation::RobotState& state, const Ground& ground);
  Foothold choose_foothold(const estimation::RobotState& state, const Ground& ground);
  Foothold plan_foothold(const estimation::RobotState& state, const terrain::TerrainMap& terrain);
  void begin_shift(const estimation::RobotState& state, const terrain::TerrainMap* terrain);
  Vector2 stride_O_m() const;
  Vector3 nominal_O_m() const;
  double cycle_s() const;
  void follow(const VelocityCommand& velocity, double step_s);
  void plan_pose(const estimation::RobotState& state, const terrain::TerrainMap* terrain);
  Motion pose_now() const;
  Vector2 centre_offset_O_m(const estimation::RobotState& state) const;
  void lift(const estimation::RobotState& state, const mapping::MapWindow* window);
  void swing(const estimation::RobotState& state, const mapping::MapWindow* window, double step_s);
  Vector2 capture_point_O_m(const estimation::RobotState& state) const;
  void set_pace(const planning::FootstepPlan& plan);
  void be_cautious();
  bool may_lift(const estimation::RobotState& state) const;
  bool is_tipping(const estimation::RobotState& state) const;
  void shift(const estimation::RobotState& state, const mapping::MapWindow* window, double step_s);
  bool must_retreat(const estimation::RobotState& state, double step_s);
  bool is_beyond(std::size_t turn, const Vector2& capture_point_O_m) const;
  bool is_tipping_over_all(const estimation::RobotState& state) const;
  void retreat();
  void set_duration();
  void begin_search(const Vector3& from_O_m);
  void go_back(const estimation::RobotState& state);
  void put_down(const estimation::RobotState& state);
  void command(const estimation::RobotState& state);
  void hold_feet(const BodyTask& body);
  Vector3 push_N(const estimation::RobotState& state, const BodyTask& body) const;
  void share_load(const estimation::RobotState& state, const Vector3& force_O_N);

  ControlConfig config_;
  robot::RobotModel model_;
  planning::StanceShape shape_;
  FootholdPlanner footholds_;
  planning::FootstepPlanner footsteps_;
  MapOffset map_offset_;
  WholeBody whole_body_;
  Stage stage_ = Stage::kStand;
  std::size_t turn_ = 0;   // in the order of legs
  bool shifted_ = false;   // the shift ended in this tick
  double progress_ = 0;    // of the shift
  double duration_s_ = 1;  // of the shift
  planning::TrunkPose from_;
  planning::TrunkPose to_;
  StandingFeet feet_;
  FixedVector<Vector2, planning::kMaxAvoided> avoided_O_m_;  // where feet found no ground
  bool homeward_ = false;  // the foot in the air has missed its ground
  double pace_ = 1;        // share of stride and speed, by how rough the planned steps' ground is
  std::size_t asked_ = 0;  // legs in a row that had no foothold
  int cautious_ = 0;       // steps still to be made slowly
  double waited_s_ = 0;    // for the trunk, after its shift
  bool stalled_ = false;   // the trunk waits for a foot that lost its ground
  double stalled_s_ = 0;   // in this shift
  LoadShares load_{};      // what a foot may carry
  VelocityCommand velocity_;  // its mean over about a cycle
  double yaw_rad_ = 0;        // the heading to keep
  double blocked_s_ = 0;
  double since_try_s_ = 0;  // the footholds were searched last
  LegStatuses legs_;
  StaticWalkCounters counters_;
  actuation::JointCommands joints_;
};

}  // namespace surefoot::control
