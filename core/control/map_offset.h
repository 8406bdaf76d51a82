// How much higher the ground is under the feet than the map has it.
//
// The map keeps heights as they were when they were seen; the estimate has drifted since then, and
// most where the camera does not look again: on a robot that turns on the spot. A foot that stands
// feels the ground where it is now. Once per stance each foot notes how far it stands above the
// map's height at that place; the offset is the mean of the middle two of the four feet's notes, so
// that one foot on an edge says nothing.
//
// Cost: at most four means of nine cells a tick. Memory: below 100 bytes.
#pragma once

#include <array>

#include "core/control/leg_status.h"
#include "core/estimation/estimator.h"
#include "core/mapping/map_window.h"
#include "core/robot/robot_model.h"

namespace surefoot::control {

class MapOffset {
 public:
  // max_offset_m: the bound of what is answered; 0: never an offset.
  void reset(double max_offset_m, double foot_radius_m);
  // Forgets what the feet noted.
  void clear();
  // window: null: no map, nothing is noted.
  void update(const estimation::RobotState& state, const std::array<LegStatus, robot::kLegs>& legs,
              const mapping::MapWindow* window);

  // By the map, offset included, there is no ground under a foot: at least 15 mm below it. Unknown
  // ground: no.
  bool hangs(const Vector3& foot_O_m, const mapping::MapWindow* window) const;

  // To be added to heights of the map. 0 until a foot has stood on ground that the map knows.
  double offset_m() const { return offset_m_; }

 private:
  double middle() const;

  double max_offset_m_ = 0;
  double foot_radius_m_ = 0;
  std::array<double, robot::kLegs> note_m_{};
  std::array<bool, robot::kLegs> noted_{};
  double offset_m_ = 0;
};

}  // namespace surefoot::control
