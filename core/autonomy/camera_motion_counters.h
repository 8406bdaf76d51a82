// What became of the pairs that were looked at for the camera's motion.
#pragma once

#include <cstdint>

namespace surefoot::autonomy {

// Every pair ends in one of these.
struct CameraMotionCounters {
  std::uint64_t motions = 0;
  std::uint64_t first = 0;             // there was no keyframe
  std::uint64_t too_few_features = 0;  // dark, without texture or without depth
  std::uint64_t inconsistent = 0;      // no one motion, or not the one that legs and gyro felt
  std::uint64_t without_pose = 0;      // stamp outside the pose history, or no trigger at it
  std::uint64_t late = 0;              // stamp not after that of the pair before

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("motions", self.motions);
    visit("first", self.first);
    visit("too_few_features", self.too_few_features);
    visit("inconsistent", self.inconsistent);
    visit("without_pose", self.without_pose);
    visit("late", self.late);
  }
};

}  // namespace surefoot::autonomy
