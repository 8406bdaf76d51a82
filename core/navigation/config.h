// Everything that can be tuned about navigation. Recommended values: README.md.
#pragma once

#include <cstdint>

#include "core/base/parameters.h"

namespace surefoot::navigation {

// The local map and what it charges.
struct MapConfig {
  std::uint32_t side_cells = 0;
  double cell_m = 0;
  double clearance_m = 0;       // added to half the robot's width
  double edge_cost = 0;         // beyond the lethal radius, in costs of a free cell
  double fall_off_reach_m = 0;  // of the inverse cube, from a point
  double walker_horizon_s = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.integer("side_cells", self.side_cells, {20, 400}, "of the square around the robot");
    visit.real("cell_m", self.cell_m, {0.05, 0.5}, "side of a cell");
    visit.real("clearance_m", self.clearance_m, {0.0, 2.0}, "kept free beside the robot");
    visit.real("edge_cost", self.edge_cost, {0.0, 20.0},
               "just beyond the lethal radius, in costs of a free cell");
    visit.real("fall_off_reach_m", self.fall_off_reach_m, {0.1, 6.0},
               "distance from a point where the inverse cube is cut off");
    visit.real("walker_horizon_s", self.walker_horizon_s, {0.0, 10.0},
               "how far walkers are predicted");
  }
};

// What keeps one plan like the one before, and smooth.
struct ShapeConfig {
  double keep_m = 0;
  double behind_s = 0;
  double discount = 0;
  double near_discount = 0;
  double near_m = 0;
  double smoothing_m = 0;
  double over_smoothing_m = 0;
  double sample_m = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("keep_m", self.keep_m, {0.1, 10.0},
               "farther off the last path, planning starts at the robot");
    visit.real("behind_s", self.behind_s, {0.0, 5.0}, "of path kept behind the robot");
    visit.real("discount", self.discount, {0.0, 0.6}, "near earlier and over-smoothed paths");
    visit.real("near_discount", self.near_discount, {0.0, 0.6}, "the same, near the robot");
    visit.real("near_m", self.near_m, {0.0, 20.0}, "how far near the robot reaches");
    visit.real("smoothing_m", self.smoothing_m, {0.1, 50.0},
               "wavelength that smoothing halves, of the path that is walked");
    visit.real("over_smoothing_m", self.over_smoothing_m, {0.1, 200.0},
               "the same, of the path that straightens the next plan");
    visit.real("sample_m", self.sample_m, {0.02, 0.5}, "between samples of the smooth path");
  }
};

// What is remembered beyond the local map, and when to give up.
struct WayConfig {
  double sight_range_m = 0;
  double sight_half_angle_rad = 0;
  double trust_range_m = 0;
  double unknown_factor = 0;
  double live_lock_s = 0;
  double progress_m = 0;
  std::uint32_t no_path_plans = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("sight_range_m", self.sight_range_m, {1.0, 60.0}, "of the sensors");
    visit.real("sight_half_angle_rad", self.sight_half_angle_rad, {0.1, 3.15},
               "seen to either side of straight ahead");
    visit.real("trust_range_m", self.trust_range_m, {0.5, 30.0},
               "nearer than this, ground that is looked through is free again");
    visit.real("unknown_factor", self.unknown_factor, {1.0, 8.0},
               "cost of unseen ground over that of seen ground");
    visit.real("live_lock_s", self.live_lock_s, {5.0, 600.0}, "without progress");
    visit.real("progress_m", self.progress_m, {0.1, 20.0}, "along the route, that counts as such");
    visit.integer("no_path_plans", self.no_path_plans, {1, 20},
                  "plans in a row that find the goal enclosed");
  }
};

// From the path to velocities.
struct FollowConfig {
  double cruise_m_s = 0;
  double max_back_m_s = 0;
  double max_left_m_s = 0;
  double max_yaw_rate_rad_s = 0;
  double acceleration_m_s2 = 0;
  double braking_m_s2 = 0;
  double yaw_acceleration_rad_s2 = 0;
  double side_acceleration_m_s2 = 0;
  double side_gain_1_s = 0;
  double yaw_gain_1_s = 0;
  double near_m = 0;
  double far_m = 0;
  double target_m = 0;
  double turn_only_rad = 0;
  double reaction_s = 0;
  double walker_margin_m = 0;
  double walker_horizon_s = 0;
  double arrive_m = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("cruise_m_s", self.cruise_m_s, {0.05, 4.0}, "on a straight, free path");
    visit.real("max_back_m_s", self.max_back_m_s, {0.0, 4.0}, "limit of the command");
    visit.real("max_left_m_s", self.max_left_m_s, {0.0, 4.0}, "limit of the command, either side");
    visit.real("max_yaw_rate_rad_s", self.max_yaw_rate_rad_s, {0.05, 4.0},
               "limit of the command, either way");
    visit.real("acceleration_m_s2", self.acceleration_m_s2, {0.05, 10.0}, "of the command");
    visit.real("braking_m_s2", self.braking_m_s2, {0.05, 10.0},
               "of the command, and what free ground is reckoned with");
    visit.real("yaw_acceleration_rad_s2", self.yaw_acceleration_rad_s2, {0.1, 10.0},
               "of the command");
    visit.real("side_acceleration_m_s2", self.side_acceleration_m_s2, {0.05, 10.0},
               "allowed in curves");
    visit.real("side_gain_1_s", self.side_gain_1_s, {0.0, 5.0}, "near: side step per distance");
    visit.real("yaw_gain_1_s", self.yaw_gain_1_s, {0.1, 5.0}, "yaw rate per error of the heading");
    visit.real("near_m", self.near_m, {0.05, 5.0}, "from the path, where side steps suffice");
    visit.real("far_m", self.far_m, {0.1, 10.0}, "from the path, where the robot steers for it");
    visit.real("target_m", self.target_m, {0.1, 10.0}, "far: how far ahead the target point lies");
    visit.real("turn_only_rad", self.turn_only_rad, {0.2, 3.0},
               "error of the heading above which the robot turns on the spot");
    visit.real("reaction_s", self.reaction_s, {0.0, 2.0}, "from a command to its effect");
    visit.real("walker_margin_m", self.walker_margin_m, {0.0, 3.0}, "kept from walkers");
    visit.real("walker_horizon_s", self.walker_horizon_s, {0.0, 10.0},
               "how far ahead walkers are looked at; 0: as if they stood");
    visit.real("arrive_m", self.arrive_m, {0.02, 5.0}, "from the goal: arrived");
  }
};

struct NavigationConfig {
  double half_length_m = 0;
  double half_width_m = 0;
  MapConfig map;
  ShapeConfig shape;
  WayConfig way;
  FollowConfig follow;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("half_length_m", self.half_length_m, {0.05, 2.0}, "of the robot with its legs");
    visit.real("half_width_m", self.half_width_m, {0.05, 2.0}, "of the robot with its legs");
    visit.group("map", self.map);
    visit.group("shape", self.shape);
    visit.group("way", self.way);
    visit.group("follow", self.follow);
  }
};

}  // namespace surefoot::navigation
