// Parameters of the jump pilot, as in the robot's file, group `jump_pilot`.
#pragma once

#include <cstdint>

#include "core/base/parameters.h"

namespace surefoot::autonomy {

struct JumpPilotConfig {
  double look_from_m = 0;   // ahead of the trunk's origin: the ground before is not looked at
  double half_width_m = 0;  // that the edge must span, left and right
  double min_rise_m = 0;    // less is walked over
  double min_drop_m = 0;    // less is no gap
  double engage_m = 0;      // to the edge: from here on the pilot steers
  double refuse_m = 0;      // to an edge that no motion takes: the robot stops
  double speed_m_s = 0;     // while it steers, at most
  double distance_gain_1_s = 0;
  double heading_gain_1_s = 0;
  double max_yaw_rate_rad_s = 0;
  double distance_tolerance_m = 0;  // to the motion's start, before it stops
  double heading_tolerance_rad = 0;
  double square_s = 0;             // steps in place, so that the feet come under the hips
  double patience_s = 0;           // for the start to come right, then the jump is refused
  double lost_s = 0;               // an edge not seen so long is forgotten
  std::uint32_t max_attempts = 0;  // at one edge
  double landing_from_m = 0;       // behind the edge: what must be seen, level and free
  double landing_length_m = 0;
  double landing_half_width_m = 0;
  double landing_error_m = 0;
  double landing_known = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("look_from_m", self.look_from_m, {0.0, 0.5}, "ahead of the trunk's origin");
    visit.real("half_width_m", self.half_width_m, {0.05, 0.5}, "that the edge must span");
    visit.real("min_rise_m", self.min_rise_m, {0.02, 1.0}, "less is walked over");
    visit.real("min_drop_m", self.min_drop_m, {0.02, 1.0}, "less is no gap");
    visit.real("engage_m", self.engage_m, {0.1, 0.75}, "to the edge: the pilot steers");
    visit.real("refuse_m", self.refuse_m, {0.1, 0.75}, "to an edge that no motion takes");
    visit.real("speed_m_s", self.speed_m_s, {0.01, 1.0}, "while it steers, at most");
    visit.real("distance_gain_1_s", self.distance_gain_1_s, {0.1, 10.0}, "towards the start");
    visit.real("heading_gain_1_s", self.heading_gain_1_s, {0.1, 10.0}, "square to the edge");
    visit.real("max_yaw_rate_rad_s", self.max_yaw_rate_rad_s, {0.01, 2.0}, "turning");
    visit.real("distance_tolerance_m", self.distance_tolerance_m, {0.001, 0.1}, "to the start");
    visit.real("heading_tolerance_rad", self.heading_tolerance_rad, {0.001, 0.5}, "to the normal");
    visit.real("square_s", self.square_s, {0.0, 10.0}, "steps in place");
    visit.real("patience_s", self.patience_s, {0.1, 60.0}, "for the start to come right");
    visit.real("lost_s", self.lost_s, {0.1, 60.0}, "an edge not seen so long is forgotten");
    visit.integer("max_attempts", self.max_attempts, {1, 20}, "at one edge");
    visit.real("landing_from_m", self.landing_from_m, {0.0, 1.0}, "behind the edge");
    visit.real("landing_length_m", self.landing_length_m, {0.05, 1.0}, "along the jump");
    visit.real("landing_half_width_m", self.landing_half_width_m, {0.05, 0.5}, "across");
    visit.real("landing_error_m", self.landing_error_m, {0.005, 0.2}, "of heights there");
    visit.real("landing_known", self.landing_known, {0.1, 1.0}, "share of cells with height");
  }
};

}  // namespace surefoot::autonomy
