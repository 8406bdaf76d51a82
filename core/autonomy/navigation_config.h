// Everything about finding the way between objects, for a robot with a laser scanner.
#pragma once

#include "core/base/parameters.h"
#include "core/navigation/config.h"
#include "core/objects/config.h"

namespace surefoot::autonomy {

struct NavigationTaskConfig {
  bool present = false;
  objects::ObjectsConfig objects;
  navigation::NavigationConfig planner;
  double blind_s = 0;  // without a scan for longer the robot stands

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("objects", self.objects);
    visit.group("planner", self.planner);
    visit.real("blind_s", self.blind_s, {0.02, 10.0}, "without a scan for longer it stands");
  }
};

}  // namespace surefoot::autonomy
