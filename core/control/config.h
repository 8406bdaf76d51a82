// Parameters of walking.
#pragma once

#include <array>

#include "core/base/fixed_vector.h"
#include "core/base/parameters.h"
#include "core/control/whole_body_config.h"
#include "core/planning/footstep_config.h"
#include "core/robot/robot_model.h"

namespace surefoot::control {

struct GaitConfig {
  double period_s = 0;
  double stance_share = 0;                    // of the period, per leg
  std::array<double, robot::kLegs> offset{};  // share of the period, FR FL HR HL

  double stance_s() const { return period_s * stance_share; }
  double swing_s() const { return period_s * (1.0 - stance_share); }

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("period_s", self.period_s, {0.1, 3.0}, "one step of every leg");
    visit.real("stance_share", self.stance_share, {0.3, 0.95}, "of the period, per leg");
    visit.reals("offset", self.offset, {0.0, 1.0}, "share of the period, FR FL HR HL");
  }
};

// The gaits a robot's file describes. kStand: no leg is lifted.
enum class GaitKind : std::uint8_t { kStand = 0, kWalk, kTrot, kTrotRun, kPace, kBound, kPronk };
inline constexpr const char* kGaitNames[] = {"stand", "walk",  "trot", "trot_run",
                                             "pace",  "bound", "pronk"};
inline constexpr std::size_t kGaits = 7;

struct GaitLibrary {
  std::array<GaitConfig, kGaits> gaits;  // by GaitKind; the first stays unused

  const GaitConfig& of(GaitKind kind) const { return gaits[static_cast<std::size_t>(kind)]; }

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    for (std::size_t i = 1; i < kGaits; ++i) visit.group(kGaitNames[i], self.gaits[i]);
  }
};

struct FootholdConfig {
  double velocity_feedback_s = 0;  // k of the Raibert rule
  double max_offset_m = 0;         // from the hip's point, each axis
  double lateral_offset_m = 0;     // outwards of the hip's point
  double search_radius_m = 0;      // how far a foothold may be moved
  double margin_weight_m = 0;      // detour that one more cell of distance from an edge is worth
  double lock_progress = 0;        // no change of target after this share of a swing
  double balance_error_m_s = 0;    // off the commanded speed by this: a step is due at any rate
  double max_drag_m = 0;  // faster than this per period: a leg without good ground steps on bad
  double max_map_offset_m = 0;  // how far the feet may find the ground off the map (map_offset.h)

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("velocity_feedback_s", self.velocity_feedback_s, {0.0, 1.0}, "Raibert gain k");
    visit.real("max_offset_m", self.max_offset_m, {0.0, 0.6}, "from the hip's point, each axis");
    visit.real("lateral_offset_m", self.lateral_offset_m, {-0.2, 0.2},
               "outwards of the hip's point");
    visit.real("search_radius_m", self.search_radius_m, {0.0, 0.3}, "how far a foothold may move");
    visit.real("margin_weight_m", self.margin_weight_m, {0.0, 0.1},
               "detour that one more cell of distance from an edge is worth");
    visit.real("lock_progress", self.lock_progress, {0.0, 1.0}, "target fixed after this share");
    visit.real("balance_error_m_s", self.balance_error_m_s, {0.0, 10.0},
               "off the commanded speed by this: unseen ground is allowed");
    visit.real("max_drag_m", self.max_drag_m, {0.0, 2.0},
               "way per period beyond which a leg without good ground steps on bad");
    visit.real("max_map_offset_m", self.max_map_offset_m, {0.0, 0.2},
               "the feet may correct the map's height by this");
  }
};

struct SwingConfig {
  double clearance_m = 0;             // above the highest ground between lift-off and landing
  double search_speed_m_s = 0;        // downwards, when the ground is not where it was expected
  double search_depth_m = 0;          // at most this far below the expected landing
  std::array<double, 3> kp_Nm_rad{};  // abad, hip, knee
  std::array<double, 3> kd_Nm_s_rad{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("clearance_m", self.clearance_m, {0.0, 0.3}, "above the highest ground on the way");
    visit.real("search_speed_m_s", self.search_speed_m_s, {0.0, 2.0}, "downwards, no ground found");
    visit.real("search_depth_m", self.search_depth_m, {0.0, 0.5}, "below the expected landing");
    visit.reals("kp_Nm_rad", self.kp_Nm_rad, {0.0, 5000.0}, "abad, hip, knee");
    visit.reals("kd_Nm_s_rad", self.kd_Nm_s_rad, {0.0, 500.0}, "abad, hip, knee");
  }
};

struct BodyConfig {
  double height_m = 0;                    // B above the ground between the feet
  std::array<double, 3> inertia_kg_m2{};  // whole robot about B, B axes
  double ground_filter_s = 0;             // time constant of ground height and slope
  double slope_share = 0;                 // of the ground's slope that the trunk follows
  double max_acceleration_m_s2 = 0;       // of the commanded velocity
  double max_reference_error_m = 0;       // the position reference waits for the body

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("height_m", self.height_m, {0.05, 2.0}, "B above the ground between the feet");
    visit.reals("inertia_kg_m2", self.inertia_kg_m2, {1e-4, 100.0}, "whole robot, x y z");
    visit.real("ground_filter_s", self.ground_filter_s, {0.001, 5.0}, "time constant");
    visit.real("slope_share", self.slope_share, {0.0, 1.0}, "of the slope the trunk follows");
    visit.real("max_acceleration_m_s2", self.max_acceleration_m_s2, {0.01, 20.0}, "of the command");
    visit.real("max_reference_error_m", self.max_reference_error_m, {0.001, 1.0},
               "the position reference waits for the body");
  }
};

// Convex MPC: sum of weight * error^2 over the ends of the steps + effort_weight * |force|^2.
struct MpcConfig {
  double step_s = 0;  // of the horizon, which has ten
  double friction = 0;
  double min_normal_N = 0;  // of a foot that stands
  double max_normal_N = 0;
  std::array<double, 3> attitude_weight{};  // roll, pitch, yaw [1/rad^2]
  std::array<double, 3> position_weight{};  // O axes [1/m^2]
  std::array<double, 3> rate_weight{};      // O axes [s^2/rad^2]
  std::array<double, 3> velocity_weight{};  // O axes [s^2/m^2]
  double effort_weight = 0;                 // [1/N^2]
  double max_residual_N = 0;                // above this the solution is not used

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("step_s", self.step_s, {0.01, 0.1}, "of the horizon, which has ten");
    visit.real("friction", self.friction, {0.05, 2.0}, "pyramid half-width over normal force");
    visit.real("min_normal_N", self.min_normal_N, {0.0, 1000.0}, "of a foot that stands");
    visit.real("max_normal_N", self.max_normal_N, {1.0, 5000.0}, "of a foot that stands");
    visit.reals("attitude_weight", self.attitude_weight, {0.0, 1000.0}, "roll, pitch, yaw");
    visit.reals("position_weight", self.position_weight, {0.0, 1000.0}, "x, y, z");
    visit.reals("rate_weight", self.rate_weight, {0.0, 1000.0}, "of the angular velocity, x, y, z");
    visit.reals("velocity_weight", self.velocity_weight, {0.0, 1000.0}, "x, y, z");
    visit.real("effort_weight", self.effort_weight, {1e-7, 1.0}, "on the forces");
    visit.real("max_residual_N", self.max_residual_N, {0.01, 1000.0}, "to use a solution");
  }
};

// One leg in the air at a time (static_walk.h), instead of the gaits.
struct StaticWalkConfig {
  bool enabled = false;
  double shift_s = 0;                  // of the trunk, between steps: what the stride reckons with
  double shift_speed_m_s = 0;          // mean speed of the centre of mass on its way
  double shift_acceleration_m_s2 = 0;  // its greatest
  double swing_s = 0;                  // shortest
  double foot_speed_m_s = 0;           // mean speed on the way up, over and down
  double max_stride_m = 0;             // way of the trunk while each leg steps once
  double margin_m = 0;       // of the centre of mass inside the triangle of the standing feet
  double lift_margin_m = 0;  // of the capture point in that triangle, for a foot to lift off
  double patience_s = 0;     // with the trunk not there yet, before the step is planned anew
  double slack_m = 0;        // a standing foot farther off is held where it is now
  double rough_from = 0;     // mean terrain cost of the steps planned, from which on,
  double rough_to = 0;       // and up to which stride and the trunk's speed come down
  double rough_share = 0;    // to this share
  double caution = 0;        // share of its speed at which the trunk shifts after a mishap,
  int cautious_steps = 0;    // for so many steps
  double slip_m = 0;         // a standing foot moved by more: the step is broken off

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.boolean("enabled", self.enabled, "one leg at a time instead of the gaits");
    visit.real("shift_s", self.shift_s, {0.02, 10.0}, "of the trunk between steps");
    visit.real("shift_speed_m_s", self.shift_speed_m_s, {0.005, 2.0}, "mean, of the trunk");
    visit.real("shift_acceleration_m_s2", self.shift_acceleration_m_s2, {0.05, 10.0},
               "greatest, of the trunk");
    visit.real("swing_s", self.swing_s, {0.05, 10.0}, "shortest swing");
    visit.real("foot_speed_m_s", self.foot_speed_m_s, {0.01, 5.0}, "mean, of a swinging foot");
    visit.real("max_stride_m", self.max_stride_m, {0.005, 2.0}, "way of the trunk per four steps");
    visit.real("margin_m", self.margin_m, {0.0, 0.5}, "of the centre of mass in the triangle");
    visit.real("lift_margin_m", self.lift_margin_m, {0.0, 0.5},
               "of the capture point in the triangle, for a foot to lift off");
    visit.real("patience_s", self.patience_s, {0.02, 60.0}, "before a step is planned anew");
    visit.real("slack_m", self.slack_m, {0.0005, 0.5}, "a standing foot farther off is let go");
    visit.real("rough_from", self.rough_from, {0.0, 1.0}, "terrain cost of planned steps: slower");
    visit.real("rough_to", self.rough_to, {0.0, 1.0}, "the same: as slow as it gets");
    visit.real("rough_share", self.rough_share, {0.1, 1.0}, "of stride and trunk's speed then");
    visit.real("caution", self.caution, {0.1, 1.0}, "share of the trunk's speed after a mishap");
    visit.integer("cautious_steps", self.cautious_steps, {0, 100}, "for so many steps");
    visit.real("slip_m", self.slip_m, {0.001, 0.5}, "of a standing foot: put the other one down");
  }
};

struct StandUpConfig {
  double fold_s = 0;                   // to the folded pose
  double rise_s = 0;                   // to standing
  std::array<double, 3> folded_rad{};  // abad, hip, knee
  double kp_Nm_rad = 0;
  double kd_Nm_s_rad = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("fold_s", self.fold_s, {0.1, 20.0}, "to the folded pose");
    visit.real("rise_s", self.rise_s, {0.1, 20.0}, "from folded to standing");
    visit.reals("folded_rad", self.folded_rad, {-6.3, 6.3}, "abad, hip, knee");
    visit.real("kp_Nm_rad", self.kp_Nm_rad, {0.0, 5000.0}, "joint stiffness");
    visit.real("kd_Nm_s_rad", self.kd_Nm_s_rad, {0.0, 500.0}, "joint damping");
  }
};

// One pose of a roll, as for a left leg: positive abduction spreads.
struct RollKeyframe {
  double hold_s = 0;                 // after the blend to it
  std::array<double, 3> low_rad{};   // legs of the side it rolls over: abad, hip, knee
  std::array<double, 3> high_rad{};  // the others

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("hold_s", self.hold_s, {0.0, 5.0}, "after the blend to it");
    visit.reals("low_rad", self.low_rad, {-6.3, 6.3}, "legs of the side it rolls over");
    visit.reals("high_rad", self.high_rad, {-6.3, 6.3}, "legs of the other side");
  }
};

inline constexpr std::size_t kMaxRollKeyframes = 8;

struct RecoveryConfig {
  double collapsed_height_m = 0;  // trunk lower than this over its feet while it should stand: fell
  double collapsed_s = 0;         // for so long
  double upright_tilt_rad = 0;    // within: it can fold and stand up
  double quiet_rad_s = 0;         // trunk turning slower than this counts as lying still
  double quiet_s = 0;             // for so long
  double speed_rad_s = 0;         // mean speed of the joint that has the longest way
  double kp_Nm_rad = 0;
  double kd_Nm_s_rad = 0;
  double limp_damping_Nm_s_rad = 0;
  int max_rolls = 0;  // then it gives up
  FixedVector<RollKeyframe, kMaxRollKeyframes> roll;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("collapsed_height_m", self.collapsed_height_m, {0.0, 1.0}, "lower: it fell");
    visit.real("collapsed_s", self.collapsed_s, {0.01, 5.0}, "for so long");
    visit.real("upright_tilt_rad", self.upright_tilt_rad, {0.1, 1.5}, "within: it can stand up");
    visit.real("quiet_rad_s", self.quiet_rad_s, {0.01, 5.0}, "slower: lying still");
    visit.real("quiet_s", self.quiet_s, {0.02, 5.0}, "for so long");
    visit.real("speed_rad_s", self.speed_rad_s, {0.1, 30.0}, "of the joint with the longest way");
    visit.real("kp_Nm_rad", self.kp_Nm_rad, {0.0, 5000.0}, "joint stiffness");
    visit.real("kd_Nm_s_rad", self.kd_Nm_s_rad, {0.0, 500.0}, "joint damping");
    visit.real("limp_damping_Nm_s_rad", self.limp_damping_Nm_s_rad, {0.0, 500.0}, "while limp");
    visit.integer("max_rolls", self.max_rolls, {0, 100}, "then it gives up");
    visit.list("roll", self.roll);
  }
};

struct ControlConfig {
  GaitLibrary gaits;
  FootholdConfig foothold;
  SwingConfig swing;
  BodyConfig body;
  MpcConfig mpc;
  WholeBodyConfig whole_body;
  StaticWalkConfig static_walk;
  planning::FootstepConfig footsteps;  // of the static walk on filled terrain
  StandUpConfig stand_up;
  RecoveryConfig recovery;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("gaits", self.gaits);
    visit.group("foothold", self.foothold);
    visit.group("swing", self.swing);
    visit.group("body", self.body);
    visit.group("mpc", self.mpc);
    visit.group("whole_body", self.whole_body);
    visit.group("static_walk", self.static_walk);
    visit.group("footsteps", self.footsteps);
    visit.group("stand_up", self.stand_up);
    visit.group("recovery", self.recovery);
  }
};

}  // namespace surefoot::control
