// Parameters of the jump controller, as in the robot's file, group `jump`.
#pragma once

#include "core/base/parameters.h"

namespace surefoot::motions {

struct JointGains {
  double kp_Nm_rad = 0;
  double kd_Nm_s_rad = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("kp_Nm_rad", self.kp_Nm_rad, {0.0, 500.0}, "of every joint");
    visit.real("kd_Nm_s_rad", self.kd_Nm_s_rad, {0.0, 5.0}, "of every joint");
  }
};

struct JumpConfig {
  double crouch_s = 0;          // from standing to the motion's first pose
  double hold_s = 0;            // there, at least
  double abort_error_rad = 0;   // of a joint while all feet push: the jump is broken off
  double landing_height_m = 0;  // of the trunk, where the legs give way about
  double landing_foot_m = 0;    // feet ahead of their hips at touchdown
  double late_landing_s = 0;    // no touchdown so long after the motion's end: lands all the same
  double landing_s = 0;         // legs as springs, from the first touchdown
  double rise_s = 0;            // to walking height
  JointGains stance;            // crouch and rise
  JointGains push;
  JointGains flight;
  JointGains landing;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.real("crouch_s", self.crouch_s, {0.1, 10.0}, "from standing to the first pose");
    visit.real("hold_s", self.hold_s, {0.0, 10.0}, "in the first pose, at least");
    visit.real("abort_error_rad", self.abort_error_rad, {0.05, 3.0},
               "of a joint while all feet push: broken off");
    visit.real("landing_height_m", self.landing_height_m, {0.1, 0.4}, "of the trunk");
    visit.real("landing_foot_m", self.landing_foot_m, {-0.2, 0.2}, "feet ahead of their hips");
    visit.real("late_landing_s", self.late_landing_s, {0.0, 1.0}, "waits so long for a touchdown");
    visit.real("landing_s", self.landing_s, {0.05, 2.0}, "legs as springs");
    visit.real("rise_s", self.rise_s, {0.1, 10.0}, "to walking height");
    visit.group("stance", self.stance);
    visit.group("push", self.push);
    visit.group("flight", self.flight);
    visit.group("landing", self.landing);
  }
};

}  // namespace surefoot::motions
